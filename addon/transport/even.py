"""Points that fill a cube evenly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def even(count: int) -> NDArray[np.float64]:
    """Return points (count, 3) that fill the unit cube evenly: Kronecker's sequence by the roots of
    x^4 = x + 1 (M. Roberts 2018)."""
    steps = 1.2207440846057596 ** -np.arange(1.0, 4.0)
    return (0.5 + (np.arange(count)[:, None] + 1.0) * steps) % 1.0
