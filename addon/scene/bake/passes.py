"""How many rays points cast: in passes, and from pass to pass only where light is still uncertain.

What two passes find differs by more than what the later one is off: where that is little, a point
is done. So rays go where light changes fast, and a town has a first light after few of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, mapped
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
"""A point is done when a pass has changed it by less, as a part of its light, where no tolerance
allows more, …"""

PER_DELTA_E = 0.045
"""By which part light changes for a CIEDE2000 of 1, on white and on middle grey alike."""

DIM = 0.02
"""… or of this part of the mean light."""


def collect(
    collected: Collected,
    shading: Shading,
    ends: Sequence[int],
    before: Sequence[NDArray] | None = None,
    slow: bool | None = False,
    sure: float = SURE,
) -> Iterator[tuple[float, NDArray[np.float32] | None]]:
    """Cast passes of ``ends`` rays from a point each, yielding how far that is, 0 to 1, and after
    each pass the colours (n, 3) that light has made, else None.

    ``before``: what makes points sure of their light, colours (n, 3) and what of the sky is seen,
    as an earlier pass has found it, with which the first is compared. ``slow``:
    without `embreex` also where it is installed; None: all points cast all passes. ``sure``: a
    point is done when a pass has changed it by less, as a part of its light.
    """
    points = np.arange(len(collected.receivers), dtype=np.int32)
    left = BUDGET[_speed(bool(slow))]
    weights = np.array(ends) * 0.5 ** np.arange(len(ends))
    shares = np.cumsum([0.0, *weights / weights.sum()]).tolist()
    for k, end in enumerate(ends):
        for done in collected.cast(directions.pattern(end), points, shading):
            yield shares[k] + (shares[k + 1] - shares[k]) * done, None
        left -= end * len(points)
        step = Progress(shares[k + 1], "")
        colours = yield from mapped(
            aside(step, collected.colours, shading), lambda each: (each.done, None)
        )
        now = [colours, collected.seen]
        yield shares[k + 1], colours
        if before is not None and slow is not None and k + 1 < len(ends):
            points = _unsure(points, now, before, int(left) // ends[k + 1], sure)
            if not len(points):
                return
        before = now


def rays_of(points: int, slow: bool = False) -> list[int]:
    """Return how many rays so many points cast in each pass."""
    most = MOST[_speed(slow)]
    first = BUDGET[_speed(slow)] / (FACTOR * max(points, 1))
    ends = [int(2 ** np.clip(np.floor(np.log2(first)), *np.log2(FIRST)))]
    while ends[-1] < most:
        ends.append(FACTOR * ends[-1])
    return ends


def left(points: int, slow: bool = False) -> float:
    """Return how many rays so many points may cast after the first two passes."""
    return max(0.0, BUDGET[_speed(slow)] - points * rays_of(points, slow)[1])


def _speed(slow: bool) -> int:
    return 0 if rays.fast() and not slow else 1


def _unsure(points, now, before, most, sure) -> NDArray[np.int32]:
    """Those of some points whose light a pass has changed; if too many, those changed ``most``."""
    change = np.max([_change(*pair, points) for pair in zip(now, before, strict=True)], axis=0)
    unsure = np.flatnonzero(change > sure)
    if len(unsure) > max(most, 0):
        unsure = np.sort(np.argsort(-change)[: max(most, 0)])
    return points[unsure]


def _change(now: NDArray, before: NDArray, points: NDArray) -> NDArray:
    """By which part a pass has changed the light (n, k) of some points at most, (p,)."""
    level = np.maximum(np.abs(now[points]).mean(axis=1), DIM * float(np.abs(now).mean() or 1.0))
    return np.abs(now[points] - before[points]).max(axis=1) / level
