"""The ColorChecker: 24 surfaces that every method is judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .grid import resample


def colorchecker() -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return names and reflectances (24, 81) of the ColorChecker, patch 1 first.

    The BabelColor average of 30 charts, from colour-science.
    """
    from colour.characterisation import SDS_COLOURCHECKERS

    patches = SDS_COLOURCHECKERS["BabelColor Average"]
    values = np.stack([resample(sd.wavelengths, sd.values) for sd in patches.values()])
    return tuple(patches), np.clip(values, 0.0, 1.0)
