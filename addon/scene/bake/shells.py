"""Which triangles are the outside of something solid: parts that are closed, and open shells that
something closes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...transport.rays import Caster
from ...transport.row_keys import row_keys

STEP = 1e-5
"""Of an object's size: corners nearer than this to one another are one."""


@dataclass
class Shell:
    """An open part of a mesh: its triangles (n,), the ``middle`` of its rim, the way ``out`` of it
    there (3,), and how far it reaches the other way."""

    triangles: NDArray[np.bool_]
    middle: NDArray[np.float64]
    out: NDArray[np.float64]
    depth: float


def closed_parts(triangles: NDArray[np.float64]) -> tuple[NDArray[np.bool_], list[Shell]]:
    """Which triangles (n,) are of a closed part whose fronts look outwards, and open shells.

    A part is what hangs together by corners; it is closed where each of its edges is two faces'.
    A shell lacks one flat face to be closed, as a house that is modelled without its floor.
    """
    if not len(triangles):
        return np.empty(0, bool), []
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max()) or 1.0
    where = np.round(triangles.reshape(-1, 3) / (STEP * size)).astype(np.int64)
    corner = np.unique(row_keys(where), return_inverse=True)[1].reshape(-1, 3)
    part = parts_of(corner)
    count = int(part.max()) + 1
    edges = np.sort(np.stack([corner, np.roll(corner, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    wide = edges[:, 0] * (int(corner.max()) + 1) + edges[:, 1]
    _, index, times = np.unique(wide, return_inverse=True, return_counts=True)
    single = (times[index.reshape(-1)] % 2 == 1) & (edges[:, 0] != edges[:, 1])
    of_edge, start = np.repeat(part, 3), triangles.reshape(-1, 3)
    border = np.bincount(of_edge, single, count)
    middle = [np.bincount(of_edge, single * column, count) for column in start.T]
    middle = np.stack(middle, axis=1) / np.maximum(border, 1.0)[:, None]
    volume = np.bincount(part, np.linalg.det(triangles - middle[part][:, None]), count) / 6.0
    shells = []
    for each in np.flatnonzero((border > 2) & (volume > 1e-9 * size**3)):
        rim = start[single & (of_edge == each)] - middle[each]
        _, spread, axes = np.linalg.svd(rim, full_matrices=False)
        if spread[2] < 1e-3 * spread[0]:
            own = triangles[part == each].reshape(-1, 3) - middle[each]
            along = own @ axes[2]
            out = -axes[2] if along.mean() > 0.0 else axes[2]
            if (own @ out).max() < 1e-3 * size:
                shells.append(Shell(part == each, middle[each], out, float(np.abs(along).max())))
    return ((border == 0) & (volume > 0.0))[part], shells


def close(solid, shells, corners, origin) -> None:
    """Count shells (their triangles, themselves, matrices) whose rim stands on something as solid:
    nothing looks into them."""
    if not shells:
        return
    starts, ways, depths = [], [], []
    for _, shell, to_world in shells:
        out = to_world[:3, :3] @ shell.out
        depth = shell.depth * np.linalg.norm(out)
        ways.append(out / np.linalg.norm(out))
        middle = to_world[:3, :3] @ shell.middle + to_world[:3, 3] - origin
        starts.append(middle - 0.5 * depth * ways[-1])
        depths.append(depth)
    starts, ways = np.array(starts, np.float32), np.array(ways, np.float32)
    met = Caster(corners).first_hits(starts, ways)
    for k, (triangles, _, _) in enumerate(shells):
        if met[k] < 0:
            continue
        a, b, c = corners[met[k]]
        normal = np.cross(b - a, c - a)
        far = ((a - starts[k]) @ normal) / ((ways[k] @ normal) or 1.0)
        solid[triangles] |= far < 0.55 * depths[k]


def parts_of(corner: NDArray) -> NDArray[np.int64]:
    """The number of the part that each triangle (n, 3) of corners belongs to, (n,): what hangs
    together by corners."""
    label = np.arange(int(corner.max()) + 1)
    while True:
        least = label[corner].min(axis=1)
        new = label.copy()
        np.minimum.at(new, corner.reshape(-1), np.repeat(least, 3))
        new = new[new]  # by leaps, for long parts
        if np.array_equal(new, label):
            return np.unique(least, return_inverse=True)[1].reshape(-1)
        label = new
