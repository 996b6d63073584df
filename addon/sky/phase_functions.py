"""Into which directions air and haze scatter: densities over the sphere, and draws from them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def rayleigh_phase(cosine: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Rayleigh's phase function [1/sr] at the cosine of the angle of scattering."""
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)


def haze_phase(cosine: NDArray[np.float64], g: float) -> NDArray[np.float64]:
    """Return Cornette and Shanks' phase function [1/sr] (1992, DOI 10.1364/AO.31.003152)."""
    return 1.5 * (1.0 + cosine**2) / (2.0 + g**2) * haze_density(cosine, g)


def haze_density(cosine: NDArray[np.float64], g: float) -> NDArray[np.float64]:
    """Return the density [1/sr] that `draw_haze` draws from: Henyey and Greenstein's, 1941."""
    return (1.0 - g**2) / (4.0 * np.pi * (1.0 + g**2 - 2.0 * g * cosine) ** 1.5)


def draw_rayleigh(chance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return cosines distributed as `rayleigh_phase`, for numbers even in 0 to 1.

    J. R. Frisvad 2011, "Importance sampling the Rayleigh phase function" (DOI
    10.1364/JOSAA.28.002436).
    """
    q = 4.0 * chance - 2.0
    root = np.cbrt(q + np.sqrt(q**2 + 1.0))
    return root - 1.0 / root


def draw_haze(chance: NDArray[np.float64], g: float) -> NDArray[np.float64]:
    """Return cosines distributed as `haze_density`, for numbers even in 0 to 1."""
    if abs(g) < 1e-3:
        return 2.0 * chance - 1.0
    inner = (1.0 - g**2) / (1.0 - g + 2.0 * g * chance)
    return np.clip((1.0 + g**2 - inner**2) / (2.0 * g), -1.0, 1.0)
