"""Sunlight outside the atmosphere."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from .datasets import SUNLIGHT, dataset
from .grid import band_average


@cache
def extraterrestrial_sunlight() -> NDArray[np.float64]:
    """Return the sun's irradiance outside the atmosphere, band-averaged on the grid, (81,).

    [W m^-2 nm^-1] at one astronomical unit. ASTM G173-03, column *extraterrestrial*
    (Gueymard 2004, DOI 10.1016/j.solener.2003.08.039), from colour-science.
    """
    table = dataset(SUNLIGHT, "ASTM G173 ETR")
    sunlight = band_average(table.wavelengths, table.values[:, 0])
    sunlight.flags.writeable = False
    return sunlight
