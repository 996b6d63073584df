"""Correlated color temperature, and how far a white is from a black body's.

Y. Ohno 2014, *Practical Use and Calculation of CCT and Duv*, LEUKOS 10(1), 47-55
(DOI 10.1080/15502724.2014.839020): the nearest points of a table of the Planckian locus, between
them a triangle near the locus and a parabola far from it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .grid import WAVELENGTHS, WEIGHTS
from .sensitivities import cmfs

SECOND_RADIATION = 1.4388e7
"""[nm K], as CIE 015:2018 has it."""

KELVIN = 1000.0, 100_000.0
"""Beyond these no temperature is told."""

WHITE = 0.05
"""|Duv| over which a color is no white and has no correlated temperature (CIE 015:2018, 9.5)."""

_STEP = 1.0025
"""From one temperature of the table to the next."""


def cct_and_duv(XYZ: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return correlated color temperatures [K] and Duv of colors (..., 3), each (...).

    ``XYZ``: CIE 1931 2°. Duv is the distance in CIE 1960 u, v from the Planckian locus, positive
    above it (greenish). NaN, both, for black; the temperature alone is NaN out of `KELVIN` and for
    what is no `WHITE`. Within 2e-5 of the temperature of the nearest black body on our grid.
    """
    XYZ = np.asarray(XYZ, dtype=float)
    flat = XYZ.reshape(-1, 3)
    T, Duv = np.full(len(flat), np.nan), np.full(len(flat), np.nan)
    place = (flat @ [1.0, 15.0, 3.0] > 0) & np.isfinite(flat).all(axis=1)
    kelvin, locus = _locus()
    for k in range(0, len(flat), 1024):
        some = np.flatnonzero(place[k : k + 1024]) + k
        T[some], Duv[some] = _nearest(_uv(flat[some]), kelvin, locus)
    T[(np.clip(T, *KELVIN) != T) | (np.abs(Duv) > WHITE)] = np.nan
    return T.reshape(XYZ.shape[:-1]), Duv.reshape(XYZ.shape[:-1])


def planckian(kelvin: ArrayLike) -> NDArray[np.float64]:
    """Return the relative spectra (..., 81) of black bodies of temperatures (...) [K]."""
    T = np.asarray(kelvin, dtype=float)[..., None]
    return (560.0 / WAVELENGTHS) ** 5 / np.expm1(SECOND_RADIATION / (WAVELENGTHS * T))


def _uv(XYZ: NDArray[np.float64]) -> NDArray[np.float64]:
    """CIE 1960 u, v (..., 2) of XYZ (..., 3)."""
    X, Y, Z = np.moveaxis(XYZ, -1, 0)
    return np.stack([4.0 * X, 6.0 * Y], axis=-1) / (X + 15.0 * Y + 3.0 * Z)[..., None]


@cache
def _locus() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Temperatures (k,) [K] beyond `KELVIN` by two steps, and their u, v (k, 2)."""
    count = int(np.ceil(np.log(KELVIN[1] / KELVIN[0]) / np.log(_STEP)))
    kelvin = KELVIN[0] * _STEP ** np.arange(-2, count + 3)
    return kelvin, _uv(planckian(kelvin) @ (cmfs() * WEIGHTS).T)


def _nearest(uv: NDArray, kelvin: NDArray, locus: NDArray) -> tuple[NDArray, NDArray]:
    """Temperature and Duv (n,) of u, v (n, 2), by Ohno's section 4."""
    away = np.linalg.norm(uv[:, None] - locus, axis=2)
    at = np.clip(away.argmin(axis=1), 1, len(kelvin) - 2)
    row = np.arange(len(uv))
    d1, d2, d3 = (away[row, at + k] for k in (-1, 0, 1))
    T1, T2, T3 = (kelvin[at + k] for k in (-1, 0, 1))
    before, after = locus[at - 1], locus[at + 1]
    side = np.linalg.norm(after - before, axis=1)
    along = (d1**2 - d3**2 + side**2) / (2.0 * side)
    share = along / side
    foot = before + (after - before) * share[:, None]
    sign = np.where(uv[:, 1] >= foot[:, 1], 1.0, -1.0)
    T = T1 + (T3 - T1) * share
    Duv = np.sqrt(np.maximum(d1**2 - along**2, 0.0)) * sign
    # A parabola through the three distances, where its bottom is clear.
    X = (T3 - T2) * (T1 - T3) * (T2 - T1)
    a = (T1 * (d3 - d2) + T2 * (d1 - d3) + T3 * (d2 - d1)) / X
    b = -(T1**2 * (d3 - d2) + T2**2 * (d1 - d3) + T3**2 * (d2 - d1)) / X
    c = -(d1 * (T3 - T2) * T2 * T3 + d2 * (T1 - T3) * T1 * T3 + d3 * (T2 - T1) * T1 * T2) / X
    far = (np.abs(Duv) >= 0.002) & (a > 0.0)
    bottom = np.where(far, -b / (2.0 * np.where(far, a, 1.0)), T)
    return bottom, np.where(far, sign * (a * bottom**2 + b * bottom + c), Duv)
