"""Rooms, balls and what they are made of, for light between surfaces: no Blender."""

import numpy as np

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.transport import directions
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.cells import ANGLES, Cells, Matter, Surfaces, levels_for
from spectral_skylight.addon.transport.hits import Space
from spectral_skylight.addon.transport.radiosity import Radiosity

DARK = np.zeros((directions.SKY, COUNT), np.float32)
WHITE = DARK + 1.0
SKY = DARK + (np.arange(directions.SKY) < directions.SKY // 2)[:, None].astype(np.float32)


def box(size=2.0, inwards=False):
    """Twelve triangles (12, 3, 3) of a cube about the origin."""
    places = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size / 2
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cut = [part for a, b, c, d in sides for part in ((a, b, c), (a, c, d))]
    corners = places[np.array(cut)]
    return corners[:, ::-1] if inwards else corners


def ball(rings=40):
    """Triangles (n, 3, 3) of a ball of radius 1, fronts outwards."""
    theta = np.linspace(0.0, np.pi, rings + 1)
    phi = np.linspace(0.0, 2.0 * np.pi, 2 * rings + 1)

    def at(i, j):
        t, p = theta[i], phi[j]
        return np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])

    found = []
    for i in range(rings):
        for j in range(2 * rings):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            found += [(a, b, c)] if i + 1 < rings else []
            found += [(a, c, d)] if i else [(a, b, c)]
    corners = np.array(found)
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return corners[area > 1e-9]


def matter(reflectances, emission=0.0, clear=False, transmittance=1.0, opacity=1.0, mirrored=0.0):
    """Kinds of surfaces that are grey."""
    count = len(reflectances)
    return Matter(
        np.repeat(np.array(reflectances, np.float32)[:, None], COUNT, axis=1),
        np.full((count, COUNT), emission, np.float32),
        np.full(count, opacity, np.float32),
        np.full(count, clear, bool),
        np.full((count, ANGLES, COUNT), transmittance, np.float32),
        np.full((count, ANGLES), mirrored, np.float32),
    )


def radiosity(corners, of, kinds=0, solid=True, cells=2000, rays=256, slow=False, small=0.0):
    kinds = np.broadcast_to(np.asarray(kinds, np.int32), len(corners))
    solid = np.broadcast_to(solid, len(corners))
    surfaces = Surfaces(corners, kinds, solid, np.zeros(len(corners), np.int32))
    made = Cells.of(surfaces, levels_for(surfaces, 0.01, cells), small)
    found = Radiosity(Space(made, of, slow))
    for _ in found.cast(rays):
        pass
    return found


def solved(found, sky=DARK, lamps=()):
    table, _, _ = found.solve(sky, run(found.lit_by(list(lamps))))
    return table


def fronts(found):
    """Of each patch: its first triangle's kind, the middle of a cell, its normal and its area."""
    cells = found.space.cells
    areas = np.bincount(cells.patch, cells.areas)
    first = cells.first
    return cells.kind[first], cells.corners[first].mean(axis=1), cells.normals[first], areas


def light(found):
    """The irradiance / pi of fronts."""
    return found.E[: found.space.cells.patches, 0]
