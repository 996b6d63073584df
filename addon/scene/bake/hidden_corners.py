"""Corners of cells that something hides from the rest of the cell: a wall's foot under the floor.

Light is stored at the corners of cells and shown all over them, so the foot's darkness would be
seen on the wall. Such a corner is given a twin, a point at the same place that takes its light from
the cell's other corners, where a point of its own goes on to have that of what lies behind.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, mapped
from ...transport.hits import Space
from .fine_mesh import Fine
from .receivers import Points
from .shells import parts_of

AT = Progress(1.0, "geometry")

INWARDS = 0.02
"""Of the way from a corner to its cell's middle: what ends so near a corner does not hide it."""


def with_twins(fine: Fine, points: Points, space: Space) -> Generator[float, None, Fine]:
    """Return the same faces with twins of points that are hidden from the rest of a cell, yielding
    between rays."""
    at, face = points.starts(1.0)[fine.point], fine.face
    middle = fine.mean(at)
    cut = np.zeros(len(at), bool)
    wanted = np.flatnonzero(fine.managed[face])
    ends = at[wanted] + INWARDS * (middle[face[wanted]] - at[wanted])
    cut[wanted] = ~(yield from space.open_between(middle[face[wanted]], ends))
    if not cut.any():
        return fine
    normals = fine.mean(points.normals[fine.point])
    starts, ways = (each.astype(np.float32) for each in (middle, normals))
    _, buried = yield from space.hiding(starts, ways, np.zeros(len(middle)))
    lost = yield from mapped(aside(AT, _lost, fine, cut, ~buried), lambda at: at.done)
    if not lost.any():
        return fine
    twins, number = np.unique(fine.point[lost], return_inverse=True)
    point = fine.point.copy()
    point[lost] = len(fine.places) + number.reshape(-1)
    return fine.with_twins(point, twins)


def _lost(fine: Fine, cut: NDArray[np.bool_], seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which corners (c,) lie on the lesser side of what passes between them and their cell's
    middle: of fewer cells (f,) that may be ``seen``, among all that hang together on a side."""
    face, count = fine.face, len(fine.places)
    whole = np.flatnonzero(~cut & ~cut[fine.following])
    if not len(whole):  # nothing tells which side is the lesser
        return np.zeros_like(cut)
    pieces = np.column_stack(
        [count + face[whole], fine.point[whole], fine.point[fine.following[whole]]]
    )
    label = parts_of(pieces)
    size = np.bincount(label, seen[face[whole]])
    own = np.zeros(len(fine.coarse))
    np.maximum.at(own, face[whole], size[label])
    cells = np.zeros(count)
    np.maximum.at(cells, fine.point[whole], size[label])
    np.maximum.at(cells, fine.point[fine.following[whole]], size[label])
    other = np.zeros(len(fine.coarse))
    np.maximum.at(other, face[cut], cells[fine.point[cut]])
    mixed = (np.maximum.reduceat(cut, fine.starts[:-1]) > 0)[face]
    lesser = other[face] > own[face]
    return mixed & (cut != lesser)
