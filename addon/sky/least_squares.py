"""The least sum of squares of a few residuals that depend on a few numbers, between limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Residuals = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""From numbers (n,) to residuals (m,)."""

_STEPS, _DAMPINGS = 60, 40
_DIFFERENCE = 1e-4
"""Step of the differences that slopes are taken from; the numbers are of size 1."""
_FARTHEST = 0.5
"""Length of a step at most: of several minima the one that the start leads down to is found."""
_ENOUGH = 1e-9
"""Step at which the search ends."""


def least_squares(
    residuals: Residuals,
    start: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the numbers (n,) between ``low`` and ``high`` with the least sum of squares.

    ``residuals`` is smooth, takes numbers of size 1, also a little beyond the limits, and may leave
    much; ``start`` (n,) lies between the limits. A local minimum, by Newton's steps, damped until
    the sum falls (D. Marquardt 1963, DOI 10.1137/0111030). A number at its limit stays there while
    the slope leads out.
    """
    x, damping = start, 0.0
    for _ in range(_STEPS):
        left, slope, H = _expansion(residuals, x)
        free = np.flatnonzero(~((x <= low) & (slope > 0) | (x >= high) & (slope < 0)))
        H, unit = H[np.ix_(free, free)], np.abs(np.diag(H)).max(initial=0.0) * np.eye(len(free))
        for _ in range(_DAMPINGS):
            damped = H + damping * unit
            step = np.zeros_like(x)
            if np.linalg.eigvalsh(damped).min(initial=np.inf) > 1e-12 * unit.max(initial=1.0):
                step[free] = np.linalg.solve(damped, -slope[free])
                step /= max(1.0, np.linalg.norm(step) / _FARTHEST)
                candidate = np.clip(x + step, low, high)
                then = residuals(candidate)
                if then @ then <= left:
                    break
            damping = max(4.0 * damping, 1e-3)
        else:
            return x
        moved = np.abs(candidate - x).max()
        x, damping = candidate, damping / 16.0 if damping > 1e-3 else 0.0
        if moved < _ENOUGH:
            break
    return x


def _expansion(
    residuals: Residuals, x: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return the sum of squares, half its slope (n,) and half its curvature (n, n)."""
    away = _DIFFERENCE * np.eye(len(x))
    at = residuals(x)
    after = np.stack([residuals(x + step) for step in away])
    before = np.stack([residuals(x - step) for step in away])
    J = (after - before) / (2 * _DIFFERENCE)
    H = J @ J.T
    for i, one in enumerate(away):
        H[i, i] += (after[i] - 2 * at + before[i]) @ at / _DIFFERENCE**2
        for j in range(i):
            both = residuals(x + one + away[j])
            mixed = (both - after[i] - after[j] + at) @ at / _DIFFERENCE**2
            H[i, j] += mixed
            H[j, i] += mixed
    return float(at @ at), J @ at, H
