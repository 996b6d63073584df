"""Bases: three functions of wavelength whose mixtures are the skylight that is expected."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .grid import WAVELENGTHS, resample
from .sunlight import extraterrestrial_sunlight

REFERENCE_WAVELENGTH = 550.0
"""lambda0 [nm]. It scales the basis functions to one size; the matrices do not depend on it."""


def rayleigh() -> NDArray[np.float64]:
    """Return sunlight scattered by air never, once and twice, (3, 81).

    ``s_i = s (lambda0 / lambda)^(4 i)``, i = 0, 1, 2 [W m^-2 nm^-1]: T. Tachi, "Full-Spectral
    Image-Based Lighting with Skylight".
    """
    scattering = (REFERENCE_WAVELENGTH / WAVELENGTHS) ** 4
    return extraterrestrial_sunlight() * scattering ** np.arange(3)[:, None]


def daylight() -> NDArray[np.float64]:
    """Return the CIE daylight functions S0, S1, S2, (3, 81), relative.

    Judd, MacAdam and Wyszecki 1964 (DOI 10.1364/JOSA.54.001031), from colour-science.
    """
    from colour.colorimetry import SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES

    functions = [SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES[name] for name in ("S0", "S1", "S2")]
    return np.stack([resample(function.wavelengths, function.values) for function in functions])


BASES: dict[str, Callable[[], NDArray[np.float64]]] = {"rayleigh": rayleigh, "daylight": daylight}
"""The bases by the name that users choose them with."""
