"""Illuminants: light by its name or, for daylight, by its temperature."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .datasets import DAYLIGHT, ILLUMINANTS, LIGHT_SOURCES, dataset, names
from .grid import resample

KELVIN = 4000.0, 25000.0
"""Correlated color temperatures for which CIE defines daylight [K]."""


@cache
def D65() -> NDArray[np.float64]:
    """Return the relative spectrum of CIE standard illuminant D65, (81,), from colour-science.

    CIE 015:2018, DOI 10.25039/TR.015.2018.
    """
    values = _on_grid(ILLUMINANTS, "D65")
    values.flags.writeable = False
    return values


def named(name: str) -> NDArray[np.float64] | None:
    """Return the relative spectrum (81,) of an illuminant or light source, None for others.

    ``name`` as colour-science has it (``A``, ``FL11``, ``LED-B3``, ``HPS``); neither case nor
    spaces matter. Outside its range a spectrum holds its end value.
    """
    for kind in (ILLUMINANTS, LIGHT_SOURCES):
        known = {"".join(each.split()).casefold(): each for each in names(kind)}
        if match := known.get("".join(name.split()).casefold()):
            return np.maximum(_on_grid(kind, match), 0.0)
    return None


@cache
def daylight_components() -> NDArray[np.float64]:
    """Return CIE's mean daylight S0 and how daylight differs from it, S1 and S2, (3, 81), relative.

    Judd, MacAdam and Wyszecki 1964 (DOI 10.1364/JOSA.54.001031), from colour-science.
    """
    components = np.stack([_on_grid(DAYLIGHT, name) for name in ("S0", "S1", "S2")])
    components.flags.writeable = False
    return components


def daylight(kelvin: ArrayLike) -> NDArray[np.float64]:
    """Return the relative spectra (..., 81) of CIE daylight of correlated color temperatures (...).

    ``kelvin`` is clipped to `KELVIN`. CIE 015:2018 (DOI 10.25039/TR.015.2018), section 4.1.2; the
    weights of S1 and S2 are rounded to three digits, as there.
    """
    T = np.clip(np.asarray(kelvin, dtype=float), *KELVIN)
    x = np.where(
        T <= 7000.0,
        -4.607e9 / T**3 + 2.9678e6 / T**2 + 0.09911e3 / T + 0.244063,
        -2.0064e9 / T**3 + 1.9018e6 / T**2 + 0.24748e3 / T + 0.23704,
    )
    y = -3.0 * x**2 + 2.87 * x - 0.275
    M = 0.0241 + 0.2562 * x - 0.7341 * y
    M1 = np.round((-1.3515 - 1.7703 * x + 5.9114 * y) / M, 3)
    M2 = np.round((0.0300 - 31.4424 * x + 30.0717 * y) / M, 3)
    return np.stack([np.ones_like(x), M1, M2], axis=-1) @ daylight_components()


def _on_grid(kind: str, name: str) -> NDArray[np.float64]:
    table = dataset(kind, name)
    return resample(table.wavelengths, table.values[:, 0])
