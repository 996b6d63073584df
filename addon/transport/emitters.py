"""Small faces that shine of their own: which are sought by rays to them, and where on them.

Rays all about a place find a luminous ceiling well and a strip of LEDs by luck. So what shines and
is far for its size sends light along rays to it alone, and what is near along rays that happen to
meet it alone: each direction from each place counts once (the maximum heuristic of E. Veach and L.
Guibas 1995, DOI 10.1145/218380.218498, between regions that do not depend on how many rays there
are).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .cells import Cells, Matter
from .emitter_tree import along_a_curve, tree
from .row_keys import row_keys

SHARE = 1.0 / 8.0
"""Of all that is seen: what shines all about a place on a face and fills more is found by chance,
for eight rays of the fewest that are cast meet it."""

LEAVES = 256
"""Faces are cut into at least so many parts in all …"""

SLENDER, MOST = 4.0, 2**16
"""… and where they are so many times as long as a square of their area, into as many more."""


class Emitters:
    """The cells that are sought, in parts from which one is chosen for each ray.

    Light that comes from them counts as that of their kind of matter, by its number in ``kinds``.
    """

    def __init__(self, cells: Cells, matter: Matter) -> None:
        radiance = matter.emission.mean(axis=1) * ~matter.clear
        found = np.flatnonzero((radiance[cells.kind] > 0.0) & (cells.areas > 0.0))
        corners, of = _parts(cells.corners[found].astype(float))
        order = along_a_curve(corners.mean(axis=1))
        corners, cell = corners[order], found[of[order]]
        self.reach: NDArray[np.float32] = np.full(len(cells) if len(found) else 0, np.inf, "f")
        """(cells,), how near a place is that does not seek a cell; infinite of what is not sought.
        Empty where nothing shines."""
        if len(found):
            whole = float(np.linalg.norm(np.ptp(cells.corners.reshape(-1, 3), axis=0)))
            most = np.zeros(len(cells))
            np.maximum.at(most, cell, _reach(corners, radiance[cells.kind[cell]], whole))
            found = found[most[found] < whole]
            self.reach[found] = most[found]
        sought = np.isin(cell, found)
        self.corners, self.cell = corners[sought], cell[sought]
        self.patches = np.unique(cells.patch[found])
        """(k,), those that are sought, each with two rows in the table for what else comes from its
        sides."""
        self.slot = np.full(cells.patches if len(found) else 0, -1, np.int32)
        self.slot[self.patches] = np.arange(len(self.patches))
        self.kinds, one, of = np.unique(
            cells.kind[self.cell], return_index=True, return_inverse=True
        )
        self.kind = of.reshape(-1)
        """(parts,), the number of each one's."""
        self.examples = cells.patch[self.cell[one]]
        """(kinds,), a patch of each."""
        self.opacity = matter.opacity[self.kinds]
        self.two_sided = ~cells.solid[self.cell]
        across = _across(self.corners)
        double = np.linalg.norm(across, axis=1)
        self.normals = (across / np.maximum(double, 1e-30)[:, None]).astype(np.float32)
        self.areas = double / 2.0
        power = radiance[self.kinds][self.kind] * self.areas
        near = self.reach[self.cell] if len(found) else np.empty(0)
        self.tree = tree(self.corners, self.normals, self.two_sided, near, power)

    def __len__(self) -> int:
        return len(self.corners)


def _across(corners: NDArray) -> NDArray:
    """Normals (n, 3) of twice the area of triangles (n, 3, 3)."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _reach(corners: NDArray, radiance: NDArray, whole: float) -> NDArray[np.float64]:
    """How near to parts (p, 3, 3) what shines about them fills `SHARE` of all that is seen, up to
    ``whole``: by cubes, each half as large as the one before. What is brighter than a part counts
    for as much more area of its radiance (p,)."""
    middle = corners.mean(axis=1)
    middle -= middle.min(axis=0)
    areas = np.linalg.norm(_across(corners), axis=1) / 2.0
    power = radiance * areas
    result = np.zeros(len(corners))
    side = whole
    least = float(np.sqrt(max(areas.min(), 1e-12)))
    while True:
        # At distances from a quarter of a cube's side to a half, as of all that lies in the cube.
        _, cube = np.unique(row_keys(np.floor(middle / side)), return_inverse=True)
        cube = cube.reshape(-1)
        about = np.bincount(cube, power)[cube] / radiance
        filled = np.sqrt(about / (np.pi * SHARE))
        last = whole if side == whole else side / 2.0
        within = (filled >= side / 4.0) & (result == 0.0)
        result[within] = np.minimum(filled[within], last)
        if side < least:
            return result
        side /= 2.0


def _parts(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles (k, 3, 3) cut across their longest sides, and of which each is a part."""
    of = np.arange(len(corners))
    while 0 < len(corners) < MOST:
        sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        longest = sides.max(axis=1)
        square = np.sqrt(np.linalg.norm(_across(corners), axis=1))
        cut = longest > SLENDER * square
        if len(corners) < LEAVES:
            cut |= longest > 0.7 * longest.max()
        if not cut.any() or len(corners) + cut.sum() > MOST:
            break
        # The longest side between the first two corners.
        turn = (np.arange(3) + sides[cut].argmax(axis=1)[:, None]) % 3
        a, b, c = np.take_along_axis(corners[cut], turn[..., None], axis=1).swapaxes(0, 1)
        middle = (a + b) / 2.0
        halves = np.stack([a, middle, c, middle, b, c], axis=1).reshape(-1, 3, 3)
        corners = np.concatenate([corners[~cut], halves])
        of = np.concatenate([of[~cut], np.repeat(of[cut], 2)])
    return corners, of
