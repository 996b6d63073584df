"""Smooth curves through numbers of single moments, by the sun's elevation: what drivers play.

They are cubics whose slopes are those of parabolas through three samples, and break where the sun
rises: its disc is seen over the horizon alone.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...sky.sun_course import hermite

SEAM = 0.02
"""[degrees] over the horizon, of the lowest sun that shines: all is known there and at 0, where it
does not. Blender takes keys of a curve that are not 0.01 apart for one."""


def slopes(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slopes (n, ...) at samples (n,), ascending, of what is ``y`` (n, ...) there."""
    found = np.zeros_like(y, dtype=float)
    for side in np.split(np.arange(len(x)), np.flatnonzero(np.diff(x) <= 1.01 * SEAM) + 1):
        if len(side) > 1:
            order: Literal[1, 2] = 2 if len(side) > 2 else 1
            found[side] = np.gradient(y[side], x[side], axis=0, edge_order=order)
    return found


def neighbours(x: NDArray[np.float64], at: float) -> NDArray[np.intp]:
    """Return which samples (n,), ascending, decide a curve between two of them: up to four."""
    sides = np.split(np.arange(len(x)), np.flatnonzero(np.diff(x) <= 1.01 * SEAM) + 1)
    side = next(each for each in sides if x[each[0]] <= at <= x[each[-1]])
    k = int(np.searchsorted(x[side], at))
    return side[max(k - 2, 0) : k + 2]


def between(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    at: float,
    slope: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Return what a curve through samples (n,) is at a place between them, (...).

    ``slope`` (n, ...): its slopes, `slopes` where None.
    """
    slope = slopes(x, y) if slope is None else slope
    k = min(max(int(np.searchsorted(x, at)) - 1, 0), len(x) - 2)
    width = x[k + 1] - x[k]
    s = np.array((at - x[k]) / width)
    return hermite(s, y[k], y[k + 1], slope[k] * width, slope[k + 1] * width)
