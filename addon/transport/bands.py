"""Sixteen bands that carry light from surface to surface, and back to colours.

Light is a reference spectrum, daylight, times a factor that is smooth where light is daylight that
surfaces have reflected. That factor is known at one wavelength in each band, where a surface
multiplies it by its reflectance, and in between by the natural cubic spline through them. So the
sun's lines stay in the numbers. Sixteen of them fill a cache line.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.grid import WAVELENGTHS
from ..spectra.sensitivities import cmfs

COUNT = 16

KNOTS: NDArray[np.float64] = np.linspace(400.0, 700.0, COUNT)
"""[nm], the middles of the bands; beyond them the factor keeps its end value."""


@dataclass(frozen=True)
class Bands:
    """The bands of one reference ``shape`` (81,), above 0."""

    shape: NDArray[np.float64]

    @cached_property
    def _nearest(self) -> NDArray[np.float64]:
        """From a spectrum to the factors (16, 81) that come nearest to it as the eye sees it."""
        weight = cmfs().sum(axis=0) + 1e-3
        terms = (weight * self.shape)[:, None] * spline()
        return np.linalg.lstsq(terms, np.diag(weight), rcond=None)[0]

    def light(self, spectra: ArrayLike) -> NDArray[np.float64]:
        """Return light (..., 81) as multiples of the shape, (..., 16); its unit stays.

        Of light with lines, as lamps have, that which looks nearest.
        """
        return np.asarray(spectra, dtype=float) @ self._nearest.T

    def share(self, reflectances: ArrayLike) -> NDArray[np.float64]:
        """Return reflectances or transmittances (..., 81) by bands, (..., 16)."""
        at = np.eye(WAVELENGTHS.size)[np.searchsorted(WAVELENGTHS, KNOTS)]
        return np.asarray(reflectances, dtype=float) @ at.T

    def colours(self, reflectance: ArrayLike, S: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the matrices (..., 3, 16) from light to what reflectances (..., 81) make of it.

        ``S`` (3, 81): sensitivities with their quadrature. This last reflectance counts at every
        wavelength.
        """
        rho = np.asarray(reflectance, dtype=float)
        return np.einsum("cl,...l,lb->...cb", S * self.shape, rho, spline(), optimize=True)


@cache
def spline() -> NDArray[np.float64]:
    """What each band counts for at each wavelength, (81, 16): sum 1, and 1 at its own middle."""
    step, n = KNOTS[1] - KNOTS[0], COUNT
    # Second derivatives m of the natural spline: m0 = 0, m_i-1 + 4 m_i + m_i+1 = 6 d2y / h².
    left, right = np.eye(n), np.zeros((n, n))
    for k in range(1, n - 1):
        left[k, k - 1 : k + 2] = 1.0, 4.0, 1.0
        right[k, k - 1 : k + 2] = np.array([6.0, -12.0, 6.0]) / step**2
    bend = np.linalg.solve(left, right)
    x = np.clip(WAVELENGTHS, KNOTS[0], KNOTS[-1])
    k = np.minimum(((x - KNOTS[0]) / step).astype(int), n - 2)
    t = ((x - KNOTS[k]) / step)[:, None]
    value = np.eye(n)
    straight = (1.0 - t) * value[k] + t * value[k + 1]
    curved = ((1.0 - t) ** 3 - (1.0 - t)) * bend[k] + (t**3 - t) * bend[k + 1]
    return straight + curved * step**2 / 6.0
