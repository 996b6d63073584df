"""Colours of many reflectances beside one another: under a sky, and under D65."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.working_spaces import XYZ_to_working
from .matrices import Transfer


def under_sky(transfer: Transfer, reflectances: ArrayLike, light: ArrayLike) -> NDArray[np.float64]:
    """Return what reflectances (m, 81) show of a light (3,), the HDRI's numbers, (m, 3).

    RGB in the transfer's working space, of which the perfect diffuser has luminance 1: the light's
    colour stays, its strength does not. Zeros under a light without luminance.
    """
    light = np.asarray(light, dtype=float)
    to_Y = np.linalg.inv(XYZ_to_working(transfer.space))[1]
    luminance = float(to_Y @ (transfer.to_working @ light))
    return transfer.matrices(reflectances) @ (light / luminance if luminance > 0 else 0.0 * light)
