"""The standard illuminant that the numbers of colour pictures are about."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from .grid import resample


@cache
def D65() -> NDArray[np.float64]:
    """Return the relative spectrum of CIE standard illuminant D65, (81,), from colour-science.

    CIE 015:2018, DOI 10.25039/TR.015.2018.
    """
    from colour.colorimetry import SDS_ILLUMINANTS

    spectrum = SDS_ILLUMINANTS["D65"]
    values = np.array(resample(spectrum.wavelengths, spectrum.values))
    values.flags.writeable = False
    return values
