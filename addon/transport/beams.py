"""Thin beams of the sun: columns of its light in which rays go from it, and none to it.

Of a beam that falls on little of a patch, places on the patch tell little, but each ray in it tells
as much as any other of the sun's. So its light is parted by columns: that of those that hold thin
beams is counted by where rays in them end, and all other by rays from the patches.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from . import directions
from .cells import Cells

THIN = 1.0 / 16.0
"""Of a side, under which what is lit of it is thin."""

LEAST, FINE = 2, 8
"""Rays along either side of a column that holds a part of a beam or lies beside one, and …"""

RAYS = 2**17
"""… so many from the sun in all, at most, but for the fewest."""


@dataclass(frozen=True)
class Columns:
    """Square columns along the way to the sun, side by side."""

    across: NDArray[np.float32]
    """(3, 3), their sides and that way."""
    low: NDArray[np.float64]
    """(2,), from where on they stand, along their sides, each so …"""
    wide: float
    top: float
    """How far over the origin they end."""
    within: NDArray[np.bool_]
    """(n, n), those that are meant."""

    @classmethod
    def over(cls, way: NDArray, cells: Cells, count: int) -> Columns:
        """Return count² that hold what stands there, along a way (3,) to the sun."""
        ends = cells.corners.reshape(-1, 3)
        middle, radius = (ends.min(axis=0) + ends.max(axis=0)) / 2.0, 0.87 * cells.size
        across = directions.frames(np.asarray(way)[None])[0]
        middle = across.astype(float) @ middle
        every = np.ones((count, count), bool)
        top = float((ends @ across[2]).max()) + radius  # beyond all that may hide them
        return cls(across, middle[:2] - radius, 2.0 * radius / count, top, every)

    def rays(
        self, each: int, rng: np.random.Generator
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
        """Return starts and directions (n, 3) of ``each``² rays in every column, one anywhere in
        each of as many squares, and how much of the sun's light that is [area]."""
        fine = np.argwhere(self.within)[:, None] * each + np.indices((each, each)).reshape(2, -1).T
        fine = fine.reshape(-1, 2)
        step = self.wide / each
        at = self.low + (fine + rng.random(fine.shape)) * step
        starts = at @ self.across[:2] + self.top * self.across[2]
        ways = np.repeat(-self.across[2:], len(starts), axis=0)
        return starts.astype(np.float32), np.ascontiguousarray(ways, np.float32), step**2

    def holds(self, places: NDArray) -> NDArray[np.bool_]:
        """Return whether places (n, 3) lie in those that are meant."""
        at = np.floor((places @ self.across[:2].T - self.low) / self.wide).astype(np.int64)
        inside = ((at >= 0) & (at < len(self.within))).all(axis=1)
        at = np.where(inside[:, None], at, 0)
        return inside & self.within[at[:, 0], at[:, 1]]

    def thin(
        self,
        met: NDArray[np.int64],
        whole: NDArray[np.float64],
        meet: Callable[[NDArray[np.float32], NDArray[np.float32]], NDArray[np.int64]],
        rng: np.random.Generator,
    ) -> Columns:
        """Return those that hold thin beams, as far as these go on beside a column whose ray has
        found one, and those beside them.

        ``met``: the side that the ray of each has ended in, -1 for none; ``whole``: how many would
        in each side if all of it were lit; ``meet``: what tells the sides of more rays.
        """
        lit = np.bincount(met[met >= 0], minlength=len(whole))
        few = np.append(lit < THIN * whole, False)
        count = len(self.within)
        beams, some = np.zeros((count, count), bool), few[met].reshape(count, count)
        while some.any():
            around = np.zeros((count + 2, count + 2), bool)
            for i, j in np.ndindex(3, 3):
                around[i : i + count, j : j + count] |= some
            new = around[1:-1, 1:-1] & ~beams
            beams |= new
            if beams.sum() * LEAST**2 > RAYS:
                break
            starts, ways, _ = replace(self, within=new).rays(LEAST, rng)
            some = np.zeros_like(beams)
            some[new] = few[meet(starts, ways)].reshape(-1, LEAST**2).any(axis=1)
        return replace(self, within=beams)

    @property
    def each(self) -> int:
        """Rays along either side of a column."""
        return int(np.clip(np.sqrt(RAYS / max(int(self.within.sum()), 1)), LEAST, FINE))
