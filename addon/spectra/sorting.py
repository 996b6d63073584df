"""Medians and distinct values, without what numpy imports when it is first asked for them.

``numpy.median`` and ``numpy.unique`` import ``numpy.ma``, which takes a third of numpy's own time.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def median(values: ArrayLike) -> NDArray:
    """Return the medians over the first axis of values (n, ...), none of them NaN, n >= 1.

    The same as ``numpy.median`` with ``axis=0``.
    """
    ordered = np.sort(values, axis=0)
    return ordered[[(len(ordered) - 1) // 2, len(ordered) // 2]].mean(axis=0)


def distinct(values: NDArray) -> tuple[NDArray, NDArray[np.intp], NDArray[np.intp]]:
    """Return the k values (n,) that differ, sorted; where each is first; which each value is, (n,).

    The same as ``numpy.unique`` with ``return_index`` and ``return_inverse``.
    """
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    is_new = np.ones(len(values), bool)
    is_new[1:] = ordered[1:] != ordered[:-1]
    which = np.empty(len(values), np.intp)
    which[order] = np.cumsum(is_new) - 1
    return ordered[is_new], order[is_new], which
