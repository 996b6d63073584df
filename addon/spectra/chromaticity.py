"""CIE 1976 u'v', in which distances between colors of light are compared."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def uv(XYZ: NDArray[np.float64], darkest: float = -np.inf) -> NDArray[np.float64]:
    """Return CIE 1976 u'v' (..., 2) of XYZ (..., 3), CIE 15:2018.

    ``darkest``: least value of X + 15 Y + 3 Z that is divided by; colors that are darker, whose
    u'v' is noise, come out towards 0.
    """
    X, Y, Z = np.moveaxis(XYZ, -1, 0)
    total = np.maximum(X + 15.0 * Y + 3.0 * Z, darkest)
    return np.stack([4.0 * X, 9.0 * Y], axis=-1) / total[..., None]
