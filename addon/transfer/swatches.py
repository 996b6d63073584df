"""Colours of many reflectances beside one another: under a sky, and under D65."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.working_spaces import XYZ_to_working
from .matrices import Transfer
from .prediction import rgb_albedo


def beside(
    transfer: Transfer, reflectances: ArrayLike, light: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return swatches under a light and under D65 that can be compared, (m, 3) each.

    As `under_sky` has the first; both are made darker by one number where the light's white has a
    channel over 1, so that a screen can show it. Out-of-gamut values are kept.
    """
    rho = np.vstack([reflectances, np.ones(transfer.restoration.shape[0])])
    *colours, white = under_sky(transfer, rho, light)
    dimmed = 1.0 / max(1.0, float(np.max(white)))
    D65 = rgb_albedo(rho[:-1], transfer.space)
    return dimmed * np.reshape(colours, (-1, 3)), dimmed * D65


def under_sky(transfer: Transfer, reflectances: ArrayLike, light: ArrayLike) -> NDArray[np.float64]:
    """Return what reflectances (m, 81) show of a light (3,), the HDRI's numbers, (m, 3).

    RGB in the transfer's working space, of which the perfect diffuser has luminance 1: the light's
    colour stays, its strength does not. Zeros under a light without luminance.
    """
    light = np.asarray(light, dtype=float)
    to_Y = np.linalg.inv(XYZ_to_working(transfer.space))[1]
    luminance = float(to_Y @ (transfer.to_working @ light))
    return transfer.matrices(reflectances) @ (light / luminance if luminance > 0 else 0.0 * light)
