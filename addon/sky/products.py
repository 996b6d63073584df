"""Products of matrices that do not wait for other processors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_TERMS = 1 << 18
"""OpenBLAS computes products of so many terms alone, and shares larger ones among all processors
(``SMP_THRESHOLD_MIN * GEMM_MULTITHREAD_THRESHOLD`` of its sources)."""


def product(rows: NDArray, matrix: NDArray) -> NDArray[np.float64]:
    """Return ``rows @ matrix`` for rows (..., k) and a matrix (k, n), (..., n).

    In pieces too small for OpenBLAS to share among its threads: ours are at work on all processors
    already, and twice as many as there are wait for one another.
    """
    flat = rows.reshape(-1, rows.shape[-1])
    result = np.empty((len(flat), matrix.shape[1]))
    step = max(1, _TERMS // matrix.size)
    for first in range(0, len(flat), step):
        np.matmul(flat[first : first + step], matrix, out=result[first : first + step])
    return result.reshape(*rows.shape[:-1], matrix.shape[1])
