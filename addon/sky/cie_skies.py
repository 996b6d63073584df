"""The fifteen skies of the CIE: how bright each direction is, from overcast to cloudless.

ISO 15469:2004 (CIE S 011/E:2003), *Spatial distribution of daylight: CIE standard general sky*. The
luminance at zenith angle Z and angle χ from the sun is, relative to the zenith's,

    L / L_z = f(χ) φ(Z) / (f(Z_s) φ(0))
    φ(Z) = 1 + a exp(b / cos Z)                                   (gradation)
    f(χ) = 1 + c (exp(d χ) - exp(d π / 2)) + e cos² χ             (indicatrix)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, parameter
from .mixed_sky import MixedSky, mixed
from .scattering import direction
from .simulation import SimulatedSky

GRADATIONS = {
    "I": (4.0, -0.70),
    "II": (1.1, -0.80),
    "III": (0.0, -1.00),
    "IV": (-1.0, -0.55),
    "V": (-1.0, -0.32),
    "VI": (-1.0, -0.15),
}
"""a and b of each group."""

INDICATRICES = {
    1: (0.0, -1.0, 0.00),
    2: (2.0, -1.5, 0.15),
    3: (5.0, -2.5, 0.30),
    4: (10.0, -3.0, 0.45),
    5: (16.0, -3.0, 0.30),
    6: (24.0, -2.8, 0.15),
}
"""c, d and e of each group."""


@dataclass(frozen=True)
class Standard:
    """A standard sky: its groups of gradation and indicatrix; `STANDARD_SKIES` says how it looks.

    ``cover``: the share of its light that is a cloud's. The standard speaks of luminance alone;
    this is ours: 1 where it says overcast, 0 where it says cloudless or clear, else a half.
    """

    gradation: str
    indicatrix: int
    cover: float


STANDARDS = {
    1: Standard("I", 1, 1.0),
    2: Standard("I", 2, 1.0),
    3: Standard("II", 1, 1.0),
    4: Standard("II", 2, 1.0),
    5: Standard("III", 1, 1.0),
    6: Standard("III", 2, 0.5),
    7: Standard("III", 3, 0.5),
    8: Standard("III", 4, 0.5),
    9: Standard("IV", 2, 0.5),
    10: Standard("IV", 3, 0.5),
    11: Standard("IV", 4, 0.0),
    12: Standard("V", 4, 0.0),
    13: Standard("V", 5, 0.0),
    14: Standard("VI", 5, 0.0),
    15: Standard("VI", 6, 0.0),
}
"""By the number of the standard's Table 1."""


def cie_luminance(
    number: int, sun_elevation: float, elevation: ArrayLike, from_sun: ArrayLike
) -> NDArray[np.float64]:
    """Return the luminance of a standard sky relative to its zenith's, (...).

    ``number``: 1 to 15; ``sun_elevation`` [degrees]; ``elevation`` and azimuth ``from_sun`` [rad],
    (...); under the horizon the value on it. Raises InputError for another number.
    """
    if number not in STANDARDS:
        raise InputError(parameter("cie"), f"there is no standard sky {number}", "give 1 to 15")
    standard = STANDARDS[number]
    a, b = GRADATIONS[standard.gradation]
    c, d, e = INDICATRICES[standard.indicatrix]
    sun = direction(np.radians(sun_elevation), 0.0)
    chi = np.arccos(np.clip(direction(np.asarray(elevation), from_sun) @ sun, -1.0, 1.0))

    def gradation(up: ArrayLike) -> NDArray:
        # On the horizon φ is 1; b is negative.
        return 1.0 + a * np.exp(b / np.maximum(up, 1e-3))

    def indicatrix(angle: ArrayLike) -> NDArray:
        fall = np.exp(d * np.asarray(angle)) - np.exp(d * np.pi / 2)
        return 1.0 + c * fall + e * np.cos(angle) ** 2

    zenith = indicatrix(np.pi / 2 - np.radians(sun_elevation)) * gradation(1.0)
    return indicatrix(chi) * gradation(np.sin(elevation)) / zenith


def cie_overcast(elevation: ArrayLike) -> NDArray[np.float64]:
    """Return the luminance (...) of the CIE's overcast sky relative to its zenith's.

    No. 16 of ISO 15469:2004, by which daylight factors are told: (1 + 2 sin γ) / 3, after P. Moon
    and D. Spencer 1942. ``elevation`` [rad], (...).
    """
    return (1.0 + 2.0 * np.sin(np.asarray(elevation, dtype=float))) / 3.0


def overcast_illuminance(sun_elevation: float) -> float:
    """Return the illuminance [lx] of an overcast sky on level ground, the sun at an elevation [°].

    300 + 21000 sin γ: Krochmann and Seidl 1974, *Quantitative data on daylight for illuminating
    engineering*, Lighting Research and Technology 6(3), 165-171.
    """
    return 300.0 + 21000.0 * float(np.sin(np.radians(max(sun_elevation, 0.0))))


def cie_sky(number: int, clear: SimulatedSky, illuminance: float | None = None) -> MixedSky:
    """Return a standard sky with spectra of a simulated ``clear`` one and of cloud.

    ``illuminance`` [lx]: of the sky, without the sun, on level ground. None: that of the clear sky
    and of `overcast_illuminance`, by the share of cloud. The sun shines through by the share
    without cloud. Raises InputError for another number than 1 to 15, for a sun under the horizon,
    where the standard has no sky, and an illuminance that is none.
    """
    height = clear.sun_elevation
    if not 0.0 <= height <= 90.0:
        cure = "standard skies need one of 0 to 90"
        raise InputError(parameter("sun_elevation"), f"{height:g}°", cure)

    def luminance(elevation: NDArray, from_sun: NDArray) -> NDArray:
        return cie_luminance(number, height, elevation, from_sun)

    luminance(np.zeros(1), np.zeros(1))  # what is wrong with the number is said first
    cover = STANDARDS[number].cover
    return mixed(clear, luminance, cover, illuminance, overcast_illuminance(height))
