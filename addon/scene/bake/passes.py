"""How many rays points cast: in passes, and from pass to pass only where light is still uncertain.

What two passes find differs by more than what the later one is off: where that is little, a point
is done. So rays go where light changes fast, and a town has a first light after few of them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ...transport import directions, rays
from .collected import Collected, Shading

FIRST = 16, 64
"""Rays from each point in the first pass, at least and at most."""

FACTOR = 4
"""Each pass casts so many times as many rays from a point as the one before."""

MOST = 4096, 256
"""Rays from a point, with and without `embreex`."""

BUDGET = 60e6, 4e6
"""Rays from all points, with and without `embreex`: some seconds. All points cast two passes."""

SURE = 0.005
"""A point is done when a pass has changed it by less, as a part of its light …"""

DIM = 0.02
"""… or of this part of the mean light."""


def collect(
    collected: Collected, shading: Shading, count: int | None = None, slow: bool = False
) -> Iterator[tuple[float, NDArray[np.float32] | None]]:
    """Cast rays in passes, yielding how far that is, 0 to 1, and after each pass the colours (n, 3)
    that light has made, else None.

    ``count``: rays from each point, from all alike; None: as light asks for. ``slow``: without
    `embreex` also where it is installed.
    """
    points = np.arange(len(collected.receivers), dtype=np.int32)
    ends = _ends(len(points), count, slow)
    budget = BUDGET[0 if rays.fast() and not slow else 1]
    weights = np.array(ends, float)
    if count is None:
        weights *= 0.5 ** np.maximum(np.arange(len(ends)) - 1, 0)
    shares = np.cumsum([0.0, *weights / weights.sum()]).tolist()
    before: list[NDArray] = []
    for k, end in enumerate(ends):
        for done in collected.cast(directions.pattern(end), points, shading):
            yield shares[k] + (shares[k + 1] - shares[k]) * done, None
        budget -= end * len(points)
        now = [collected.colours(shading), collected.seen]
        yield shares[k + 1], now[0]
        if count is None and k > 0 and k + 1 < len(ends):
            pairs = zip(now, before, strict=True)
            change = np.max([_change(*pair, points) for pair in pairs], axis=0)
            unsure = np.flatnonzero(change > SURE)
            if len(unsure) > (most := max(0, int(budget) // ends[k + 1])):
                unsure = np.sort(np.argsort(-change)[:most])
            points = points[unsure]
            if not len(points):
                return
        before = now


def first_rays(points: int, slow: bool = False) -> int:
    """Return how many rays each of so many points casts in the first pass, a power of 2."""
    budget = BUDGET[0 if rays.fast() and not slow else 1]
    return int(2 ** np.clip(np.floor(np.log2(budget / (FACTOR * max(points, 1)))), *np.log2(FIRST)))


def _ends(points: int, count: int | None, slow: bool) -> list[int]:
    """The rays of a point in each pass."""
    if count is not None:
        return [FIRST[1], count] if count >= FACTOR * FIRST[1] else [count]
    most = MOST[0 if rays.fast() and not slow else 1]
    ends = [first_rays(points, slow)]
    while ends[-1] < most:
        ends.append(FACTOR * ends[-1])
    return ends


def _change(now: NDArray, before: NDArray, points: NDArray) -> NDArray:
    """By which part a pass has changed the light (n, k) of some points at most, (p,)."""
    level = np.maximum(np.abs(now[points]).mean(axis=1), DIM * float(np.abs(now).mean() or 1.0))
    return np.abs(now[points] - before[points]).max(axis=1) / level
