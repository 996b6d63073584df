"""The ColorChecker: 24 surfaces that every method is judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .datasets import CHECKERS, dataset
from .grid import resample


def colorchecker() -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return names and reflectances (24, 81) of the ColorChecker, patch 1 first.

    The BabelColor average of 30 charts, from colour-science.
    """
    wavelengths, values, patches = dataset(CHECKERS, "BabelColor Average")
    return patches, np.clip(resample(wavelengths, values), 0.0, 1.0)
