"""What the eye sees of light of one wavelength, as far as a screen can show it."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..spectra.grid import WEIGHTS
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import srgb


@cache
def spectral_colours() -> NDArray[np.float64]:
    """Return the sRGB of light of each wavelength of the grid at the same power, (81, 3).

    By the CIE 1931 2° observer, negative components cut off, the brightest component 1.
    """
    rgb = np.maximum((observer() / WEIGHTS).T, 0.0)
    return srgb(rgb / rgb.max())
