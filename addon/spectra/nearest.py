"""How near places in a plane are to a cloud of points: to its second nearest one.

One alone may be there by chance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .sorting import distinct

_AT_ONCE = 16
"""Places: their distances to thousands of points stay in the processor's cache."""

_CELLS = 1.0, 0.25, 0.06
"""Sides of the squares that places are taken together in, in parts of the limit."""

_FAR = 1 << 28
"""Squares from the origin: what lies beyond is as far from all points as its square is."""


def second_nearest(places: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distance from each place (n, 2) to the second nearest of points (m, 2), (n,).

    All distances are computed: n m of them. Infinite with fewer than two points.
    """
    nearest = np.full(len(places), np.inf)
    if len(points) < 2:
        return nearest
    x, y = np.ascontiguousarray(points.T)
    for start in range(0, len(places), _AT_ONCE):
        some = places[start : start + _AT_ONCE]
        squares = (x - some[:, :1]) ** 2
        squares += (y - some[:, 1:]) ** 2
        row = np.arange(len(some))
        squares[row, squares.argmin(axis=1)] = np.inf
        nearest[start : start + _AT_ONCE] = np.sqrt(squares[row, squares.argmin(axis=1)])
    return nearest


def are_farther(
    places: NDArray[np.float64], points: NDArray[np.float64], limit: float
) -> NDArray[np.bool_]:
    """Return whether `second_nearest` of each place (n, 2) is over a limit, (n,).

    The middle of a square answers for all places in it, unless it is too near to the limit.
    """
    farther = np.empty(len(places), bool)
    open_ = np.arange(len(places))
    for part in _CELLS:
        side = part * limit
        cells = np.clip(np.floor(places[open_] / side), -_FAR, _FAR).astype(np.int64)
        keys = cells[:, 0] * (4 * _FAR) + cells[:, 1]
        _, first, cell = distinct(keys)
        distance = second_nearest((cells[first] + 0.5) * side, points)
        # A place is half a diagonal from the middle at most, and a bit for rounding.
        sure = np.abs(distance - limit) > 0.708 * side
        farther[open_] = (distance > limit)[cell]
        open_ = open_[~sure[cell]]
    farther[open_] = second_nearest(places[open_], points) > limit
    return farther
