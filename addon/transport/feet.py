"""Patches cut where walls stand on them, so that none lies on both sides of one: light leaks there.

Where surfaces meet, light has a step (P. Heckbert 1992, Discontinuity Meshing for Radiosity).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cells import Surfaces
from .hits import ALONG, Space

OVER = 0.02
"""Of a cell's side: so far over it, and inwards of its corners, rays along its sides go."""

COVER = 0.2
"""Of a cell's side: what lies so near over a corner hides it."""

MOST, FEW = 4, 500
"""Walls that a triangle is cut by; and cuts of all, the largest first, that are made at least."""

SAME = 0.05
"""Of a cell's side: walls that are nearer to each other cut it once."""


def cut(space: Space, surfaces: Surfaces, levels: NDArray[np.int64]) -> tuple[Surfaces, NDArray]:
    """Return triangles cut by the planes of what stands on their cells, and how often to cut each
    further for cells as large as before.

    ``space``: of cells of the same ``surfaces``; ``levels`` (n,): how often those are to be cut.
    """
    triangle, planes = _standing(space)
    corners, number = surfaces.corners, np.arange(len(surfaces.corners))
    lengths, grain = surfaces.lengths, 1e-4 * surfaces.lengths
    enough = max(FEW, int((4**levels).sum()) // 16)  # of leaves that cross leaves not all
    chosen = np.argsort(-lengths[triangle], kind="stable")[:enough]
    triangle, planes = triangle[chosen], planes[chosen]
    order = np.argsort(triangle, kind="stable")
    triangle, planes = triangle[order], planes[order]
    rank = np.arange(len(triangle)) - np.searchsorted(triangle, triangle)
    for turn in range(MOST):
        plane = np.zeros((len(lengths), 4))
        plane[triangle[rank == turn]] = planes[rank == turn]
        corners, number = _halved(corners, number, plane, grain)
    whole = np.bincount(number, minlength=len(lengths))[number] == 1
    thing = surfaces.thing[number]
    # Small ones must not go together again.
    thing[~whole] = thing.max(initial=0) + 1 + np.arange((~whole).sum(), dtype=thing.dtype)
    kind, solid = surfaces.kind[number], surfaces.solid[number]
    found = Surfaces(corners, kind, solid, thing, surfaces.size)
    shares = found.lengths / np.maximum(lengths[number], 1e-30)
    fewer = np.floor(-np.log2(np.clip(shares, 1e-9, 1.0)) + 0.25).astype(int)
    return found, np.where(whole, levels[number], np.maximum(levels[number] - fewer, 0))


def _standing(space: Space) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Triangles (k,), and planes (k, 4) of what stands across cells of theirs, each once: what is
    met along a cell's sides, for what parts its corners crosses two of them."""
    cells = space.cells
    alone = np.flatnonzero(np.bincount(cells.patch, minlength=cells.patches)[cells.patch] == 1)
    at, normals = cells.corners[alone], cells.normals[alone]
    lengths = np.sqrt(2.0 * cells.areas[alone]).astype(np.float32)
    inner = at + OVER * (at.mean(axis=1, keepdims=True) - at)
    inner += (OVER * lengths)[:, None, None] * normals[:, None]
    starts, ways = inner.reshape(-1, 3), (np.roll(inner, -1, axis=1) - inner).reshape(-1, 3)
    far = np.linalg.norm(ways, axis=1)
    ways = ways / np.maximum(far, 1e-30)[:, None]
    met = np.full(len(starts), -1, np.int32)
    for first in range(0, len(starts), space.chunk):
        part = slice(first, first + space.chunk)
        met[part] = space.nearest(starts[part], ways[part], far[part])
    found = np.flatnonzero(met >= 0)
    # What is within something solid, or under it, leaks nothing.
    ends = np.column_stack([found, found // 3 * 3 + (found + 1) % 3])
    across = np.repeat(normals, 3, axis=0)[ends]
    reach = COVER * np.repeat(lengths, 3)[ends]
    hidden = np.logical_or(*space.hidden(starts[ends], across, reach))
    found = found[~hidden.any(axis=1)]
    hit, own = met[found], found // 3
    normal = cells.normals[hit].astype(float)
    steep = (np.abs((normal * normals[own]).sum(axis=1)) < ALONG) & (lengths[own] > 0.0)
    found, hit, own, normal = found[steep], hit[steep], own[steep], normal[steep]
    sign = np.where(normal[np.arange(len(hit)), np.abs(normal).argmax(axis=1)] < 0.0, -1.0, 1.0)
    normal *= sign[:, None]
    away = (cells.corners[hit, 0] * normal).sum(axis=1)
    middle = (at.mean(axis=1)[own] * normal).sum(axis=1)
    triangle = cells.triangle[alone[own]]
    step = np.round((away - middle) / (SAME * lengths[own])) * SAME * lengths[own] + middle
    rows = np.column_stack([triangle, np.round(normal * 20.0), np.round(step / lengths[own] * 5.0)])
    _, first = np.unique(rows, axis=0, return_index=True)
    return triangle[first], np.column_stack([normal, away])[first]


def _halved(corners, number, plane, grain) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles cut by the plane of their number where it passes through, at more than ``grain``
    from their corners."""
    own = plane[number]
    above = np.einsum("nck,nk->nc", corners, own[:, :3]) - own[:, 3:]
    least = grain[number]
    above[np.abs(above) < least[:, None]] = 0.0
    passes = (above.max(axis=1) > 0.0) & (above.min(axis=1) < 0.0)
    if not passes.any():
        return corners, number
    at, over = corners[passes], above[passes]
    # The corner that is alone on its side, or lies on the plane, comes first.
    sides = np.sign(over)
    lone = np.argmax(np.where(sides == 0.0, 2.0, sides * -np.sign(sides.sum(axis=1))[:, None]), 1)
    turn = (lone[:, None] + np.arange(3)) % 3
    rows = np.arange(len(at))[:, None]
    (a, b, c), (u, v, w) = at[rows, turn].swapaxes(0, 1), over[rows, turn].T

    def between(p, q, s, t):
        share = np.clip(s / np.where(s == t, 1.0, s - t), 0.0, 1.0)[:, None]
        return p + share * (q - p)

    on = u == 0.0  # the plane passes through a corner: two parts
    bc, ab, ca = between(b, c, v, w), between(a, b, u, v), between(a, c, u, w)
    two = [np.stack(each, axis=1)[on] for each in ((a, b, bc), (a, bc, c))]
    three = [np.stack(each, axis=1)[~on] for each in ((a, ab, ca), (ab, b, c), (ab, c, ca))]
    own = number[passes]
    numbers = [number[~passes], own[on], own[on], *[own[~on]] * 3]
    return np.concatenate([corners[~passes], *two, *three]), np.concatenate(numbers)
