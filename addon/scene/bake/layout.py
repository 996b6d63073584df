"""How finely each face of an object is divided, and each patch between which light goes round."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import sky_bake
from ...grouping import grouped
from ...progress import mapped
from ...transport.cells import FINEST, Surfaces
from ...transport.hits import Space
from ...transport.radiosity import Radiosity
from . import fine_mesh, hidden_corners, storage
from .fine_mesh import Fine
from .geometry import Geometry
from .receivers import Points, Target

MOST = 10_000_000
"""Vertices beyond which an object is not baked."""

POINTS, MORE = 400_000, 100_000
"""In all objects together, beyond which none is divided further; but by so many that there are more
than faces: a mesh of many vertices leaves some for the ground that it stands on."""

START, SMALL = 1.0 / 48.0, 1.0 / 300.0
"""Patches' and cells' length, of the scene's size: at first at most so long, for what is smaller
may fall between them unseen; and triangles that are so short go together."""

LONGEST, LEAST = 1.0 / 24.0, 1.0 / 1000.0
"""No cell is longer than the first, and none is divided to less than this, of the scene's size."""

DARK = 0.05
"""Of the brightest light, under which errors are relative to that."""

MEETS = 0.5
"""Part of the light that two surfaces take from each other where they meet, in the mean."""

DOUBT = 1.25
"""A bend is told by few rays: so much more may be true."""

POWER = 0.75
"""Halving a cell divides what its middle is off by 2 where light has an edge, by 4 where it bends:
so many halvings for each factor of 2."""


@dataclass
class Plan:
    """An object on its way: its faces before they are divided, how often they will be."""

    obj: bpy.types.Object
    bake: bpy.types.Object
    coarse: Fine
    levels: NDArray[np.int64]
    split: NDArray[np.bool_]
    lengths: NDArray[np.float64]
    """(f,) [scene units], the longest edge of each face."""


def begin(
    objects: Sequence[tuple[bpy.types.Object, bpy.types.Object]], found: Sequence[Fine | None]
) -> tuple[list[str], list[Plan]]:
    """Return lines on what cannot be baked, and plans for the rest; that has no divisions yet.

    ``objects`` with their bakes; ``found``: their faces.
    """
    refused, plans = [], []
    for (obj, bake), fine in zip(objects, found, strict=True):
        problem = ""
        if fine is None or not fine.managed.any():
            problem = "no faces of a spectral material"
        elif len(fine.places) > MOST:
            problem = f"over {MOST:,} vertices: bake it in parts"
        elif abs(np.linalg.det(np.array(obj.matrix_world)[:3, :3])) < 1e-20:
            problem = "no size"
        if problem or fine is None:
            refused.append((f'"{obj.name}"', f"not baked, for it has {problem}"))
            continue
        lengths, split = _shapes(obj, fine)
        plans.append(Plan(obj, bake, fine, np.zeros(len(lengths), int), split, lengths))
    return grouped(refused, "object"), plans


def bends(radiosity: Radiosity) -> NDArray[np.float64]:
    """Return by which part light in the middle of each triangle's cells is off what the cells
    around tell, at worst of its cells, in units of a tolerance (t,); by `MEETS` at least where
    something stands on it."""
    cells = radiosity.space.cells
    light = np.zeros(cells.patches)
    np.maximum.at(light, radiosity.patch, radiosity.E.mean(axis=1))
    off = cells.curvature(np.log(light + DARK * max(float(light.max(initial=0.0)), 1e-30)))
    fronts = radiosity.counts[: cells.patches]
    meets = (fronts.any(axis=1) & ~fronts.all(axis=1))[cells.patch]
    np.maximum.at(off, cells.triangle[meets], MEETS)
    return off


def refine(
    plans: Sequence[Plan],
    around: Geometry,
    bend: NDArray[np.float64],
    levels: NDArray[np.int64],
    tolerance: float,
) -> None:
    """Say how often faces are divided, by what triangles of these levels have told."""
    wanted = levels + halvings(DOUBT * bend, tolerance)
    for plan in plans:
        own = around.of(plan.obj.name_full)
        if len(own) and around.polygon[own].max() < len(plan.levels):
            np.maximum.at(plan.levels, around.polygon[own], wanted[own])
    by_light = np.concatenate([plan.levels for plan in plans])
    lengths = np.concatenate([plan.lengths for plan in plans])
    managed = np.concatenate([plan.coarse.managed for plan in plans])
    by_size = np.ceil(np.log2(np.maximum(lengths / (LONGEST * around.size), 1.0)))
    length = LEAST * around.size
    enough = max(POINTS, len(lengths) + MORE)
    while True:
        most = np.floor(np.log2(np.maximum(lengths / length, 1.0)))
        limited = np.minimum(np.maximum(by_light, by_size), np.minimum(most, sky_bake.LEVELS))
        limited = np.where(managed, limited, 0).astype(int)
        if (4.0**limited).sum() <= enough or length > around.size:
            break
        length *= 1.25
    ends = np.cumsum([len(plan.levels) for plan in plans])
    for plan, own in zip(plans, np.split(limited, ends[:-1]), strict=True):
        plan.levels = own


def divide(plans: Sequence[Plan]) -> list[fine_mesh.Raw | None]:
    """Divide objects as planned, and return what their faces are then; None as they were before."""
    divided = [plan for plan in plans if plan.levels.any()]
    for plan in divided:
        storage.write_levels(plan.bake, plan.levels, plan.split & (plan.levels > 0))
    found = dict(zip(map(id, divided), fine_mesh.evaluated([p.obj for p in divided]), strict=True))
    return [found.get(id(plan)) for plan in plans]


def lay_out(
    plans: Sequence[Plan], fines: Sequence[Fine | None], around: Geometry, space: Space
) -> Generator[float, None, list[Target]]:
    """Return divided objects with their points, by what hides them, yielding 0 to 1.

    ``fines``: what `divide` has made of each.
    """
    targets = []
    for plan, divided in zip(plans, fines, strict=True):
        fine = divided or plan.coarse
        own = around.of(plan.obj.name_full)
        loose = np.zeros(len(plan.levels), bool)
        polygon = around.polygon[own]
        inside = polygon < len(loose)
        loose[polygon[inside]] = ~around.solid[own][inside]
        points = Points(plan.obj, fine, around.origin, around.size)
        twins = hidden_corners.with_twins(fine, points, space)
        fine = yield from mapped(twins, lambda _: len(targets) / len(plans))
        points = Points(plan.obj, fine, around.origin, around.size)
        backs = np.zeros(len(fine.places), bool)
        backs[fine.point] = loose[fine.coarse[fine.face]]
        split = plan.split & (plan.levels > 0)
        storage.write(plan.bake, fine, plan.levels, split)
        targets.append(Target(plan.obj.name, fine, points, backs))
        yield len(targets) / len(plans)
    return targets


def show(plans: Sequence[Plan], targets: Sequence[Target]) -> None:
    """Let objects show what was laid out."""
    for plan, target in zip(plans, targets, strict=False):
        storage.show(plan.obj, target.fine, bool(target.backs.any()))


def finer(
    surfaces: Surfaces,
    levels: NDArray[np.int64],
    bend: NDArray[np.float64],
    tolerance: float,
    most: int,
) -> NDArray[np.int64]:
    """Return how often triangles are cut for light to go round, at most so many cells in all."""
    length = LEAST * surfaces.size
    while True:
        smallest = np.floor(np.log2(np.maximum(surfaces.lengths / length, 1.0))).astype(int)
        wanted = np.minimum(levels + np.minimum(halvings(bend, 2.0 * tolerance), 2), smallest)
        wanted = np.minimum(np.maximum(wanted, 0), FINEST)
        if (4.0**wanted).sum() <= max(most, len(levels)) or length > surfaces.size:
            return wanted
        length *= 1.25


def halvings(bend: NDArray[np.float64], tolerance: float) -> NDArray[np.int64]:
    """Return how often cells must be halved until a bend is within a tolerance."""
    return np.ceil(POWER * np.log2(np.maximum(bend / tolerance, 1.0))).astype(int)


def _shapes(obj, fine):
    """The longest edge of each face in the world, and which faces to triangulate.

    Halving goes by the mean of a face's corners, which may lie outside a concave face, and bends
    one that is not plane.
    """
    at = (fine.places @ np.array(obj.matrix_world)[:3, :3].T)[fine.point]
    following = fine.following
    edge = at[following] - at
    length = np.maximum.reduceat(np.linalg.norm(edge, axis=1), fine.starts[:-1])
    vector = np.add.reduceat(np.cross(at, at[following]), fine.starts[:-1])
    normal = vector / np.maximum(np.linalg.norm(vector, axis=1), 1e-30)[:, None]
    turn = np.empty(len(edge))
    turn[following] = (np.cross(edge, edge[following]) * normal[fine.face]).sum(axis=1)
    off = np.abs(((at - fine.mean(at)[fine.face]) * normal[fine.face]).sum(axis=1))
    concave = np.minimum.reduceat(turn, fine.starts[:-1]) < -1e-6 * length**2
    bent = np.maximum.reduceat(off, fine.starts[:-1]) > 1e-4 * length
    sides = np.diff(fine.starts)
    return length, (sides > 4) | ((sides == 4) & (concave | bent))
