"""What the eye sees of light of one wavelength, as far as a screen can show it."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..spectra.grid import WEIGHTS
from ..spectra.sensitivities import observer


def srgb(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return linear Rec.709 as sRGB, 0 to 1, cut off outside (IEC 61966-2-1)."""
    rgb = np.clip(rgb, 0.0, 1.0)
    return np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1.0 / 2.4) - 0.055)


@cache
def spectral_colours() -> NDArray[np.float64]:
    """Return the sRGB of light of each wavelength of the grid at the same power, (81, 3).

    By the CIE 1931 2° observer, negative components cut off, the brightest component 1.
    """
    rgb = np.maximum((observer() / WEIGHTS).T, 0.0)
    return srgb(rgb / rgb.max())
