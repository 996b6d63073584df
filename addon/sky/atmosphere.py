"""The air as an optical medium: what is in it, how high, and what it does to each wavelength.

Five kinds of matter. *Air* scatters by Rayleigh's law, *haze* (aerosol) scatters and absorbs,
*ozone* absorbs: these three follow Beer's law. *Water* vapour and *oxygen* absorb by a band model
of the whole way that light went (see `gases`).

The medium is made of spherical shells, each uniform: a ray's way through every shell is then
known exactly, and every method that walks through it (single scattering, photons) sees the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..spectra.grid import WAVELENGTHS
from .gases import DOBSON, ozone_cross_section

EARTH_RADIUS = 6.371e6
"""[m]"""

ATMOSPHERE_HEIGHT = 1.0e5
"""[m]. A millionth of the air is above."""

HAZE_SCALE_HEIGHT = 1200.0
"""[m]. Nishita et al. 1993."""

WATER_SCALE_HEIGHT = 2000.0
"""[m]. Water vapour, as a rule of thumb."""

SHELLS = 100
"""Radiances scattered once are then within 0.1 % by day and 0.3 % at dusk of those of 500."""

MATTER = ("air", "haze", "ozone", "water", "oxygen")
"""The order of the last axis of densities and columns."""


@dataclass(frozen=True)
class Atmosphere:
    """A clear atmosphere over level ground at sea level.

    ``haze``: vertical optical depth of aerosol at 550 nm (0.02 very clear, 0.1 clear, 0.3 hazy);
    ``angstrom``: its Ångström exponent; ``asymmetry``: g of Cornette and Shanks;
    ``haze_albedo``: the share of its extinction that is scattering;
    ``ozone`` [Dobson units]; ``water``: precipitable [mm]; ``oxygen``: whether it absorbs;
    ``pressure`` at the ground [hPa], to which air and oxygen are proportional;
    ``dispersion``: whether air follows its measured refraction or exactly λ^-4;
    ``ground``: reflectance, one number or a spectrum (81,).
    """

    haze: float = 0.05
    angstrom: float = 1.3
    asymmetry: float = 0.76
    haze_albedo: float = 0.95
    ozone: float = 300.0
    water: float = 14.0
    oxygen: bool = True
    pressure: float = 1013.25
    dispersion: bool = True
    ground: ArrayLike = 0.2

    def __post_init__(self) -> None:
        limits = {
            "haze": (0.0, 5.0),
            "angstrom": (-1.0, 4.0),
            "asymmetry": (-0.99, 0.99),
            "haze_albedo": (0.0, 1.0),
            "ozone": (0.0, 1000.0),
            "water": (0.0, 100.0),
            "pressure": (0.0, 1100.0),
        }
        for name, (low, high) in limits.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(name, f"{value:g}", f"give {low:g} to {high:g}")
        ground = np.asarray(self.ground, dtype=float)
        if ground.shape not in ((), (1,), WAVELENGTHS.shape) or not np.all(
            (ground >= 0) & (ground <= 1)
        ):
            raise InputError("ground", "is not a reflectance", "give one number or 81, 0 to 1")


@dataclass(frozen=True)
class Medium:
    """An `Atmosphere` as numbers: what the walks through it read.

    Columns count in verticals: 1 is what lies straight above the ground. ``edges`` (k + 1):
    altitudes of the shells' borders [m]; ``density`` (k, 5): of each `MATTER` within them, columns
    per metre; ``extinction`` and ``scattering`` (3, 81): vertical optical depths of air, haze and
    ozone; ``bands`` (2,): the verticals of water [cm] and oxygen [atmospheres]; ``ground`` (81,).
    """

    edges: NDArray[np.float64]
    density: NDArray[np.float64]
    extinction: NDArray[np.float64]
    scattering: NDArray[np.float64]
    bands: NDArray[np.float64]
    ground: NDArray[np.float64]
    asymmetry: float


def medium(atmosphere: Atmosphere, shells: int = SHELLS) -> Medium:
    """Return the numbers of an atmosphere that is made of so many shells."""
    edges, density = _shells(shells)
    air = rayleigh_optical_depth(atmosphere.dispersion) * (atmosphere.pressure / 1013.25)
    haze = atmosphere.haze * (550.0 / WAVELENGTHS) ** atmosphere.angstrom
    ozone = ozone_cross_section() * DOBSON * atmosphere.ozone
    return Medium(
        edges=edges,
        density=density,
        extinction=np.stack([air, haze, ozone]),
        scattering=np.stack([air, haze * atmosphere.haze_albedo, np.zeros_like(ozone)]),
        bands=np.array(
            [atmosphere.water / 10.0, atmosphere.oxygen * atmosphere.pressure / 1013.25]
        ),
        ground=np.broadcast_to(np.asarray(atmosphere.ground, float), WAVELENGTHS.shape),
        asymmetry=atmosphere.asymmetry,
    )


def rayleigh_optical_depth(dispersion: bool = True) -> NDArray[np.float64]:
    """Return the vertical optical depth of air at 1013.25 hPa, (81,).

    Bodhaine et al. 1999, equation 30 (DOI 10.1175/1520-0426(1999)016<1854:ORODC>2.0.CO;2), within
    0.01 % over the grid. Without ``dispersion``: λ^-4 through its value at 550 nm.
    """
    if not dispersion:
        return 0.097065 * (550.0 / WAVELENGTHS) ** 4
    square = (WAVELENGTHS / 1000.0) ** 2
    return (
        0.0021520
        * (1.0455996 - 341.29061 / square - 0.90230850 * square)
        / (1 + 0.0027059889 / square - 85.968563 * square)
    )


@cache
def _shells(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the borders of the shells (k + 1) [m] and the mean densities within (k, 5) [1/m].

    Thin shells below, where haze and water change fast; each density integrates to 1.
    """
    edges = ATMOSPHERE_HEIGHT * (np.arange(count + 1) / count) ** 2
    nodes, weights = np.polynomial.legendre.leggauss(8)
    altitude = edges[:-1, None] + np.diff(edges)[:, None] * (nodes + 1) / 2
    air = _air_density(altitude)
    profiles = np.stack(
        [
            air,
            np.exp(-altitude / HAZE_SCALE_HEIGHT),
            np.interp(altitude, _OZONE_ALTITUDES, _OZONE_DENSITIES, right=0.0),
            np.exp(-altitude / WATER_SCALE_HEIGHT),
            air,
        ],
        axis=-1,
    )
    density = np.einsum("kgm,g->km", profiles, weights / 2)
    density /= np.diff(edges) @ density
    return edges, density


def _air_density(altitude: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the density of air relative to sea level.

    U.S. Standard Atmosphere 1976 (NASA-TM-X-74335) up to 86 km, and on with the same gradient.
    """
    altitude = altitude / 1000.0
    height = 6356.766 * altitude / (6356.766 + altitude)  # geopotential [km]
    bases = np.array([0.0, 11.0, 20.0, 32.0, 47.0, 51.0, 71.0])
    lapses = np.array([-6.5, 0.0, 1.0, 2.8, 0.0, -2.8, -2.0])  # [K/km]
    temperatures = 288.15 + np.concatenate([[0.0], np.cumsum(lapses[:-1] * np.diff(bases))])
    gravity = 34.1632  # g0 M / R [K/km]
    density = np.ones_like(height)
    for k, (base, lapse, start) in enumerate(zip(bases, lapses, temperatures, strict=True)):
        top = bases[k + 1] if k + 1 < bases.size else np.inf
        rise = np.clip(height, base, top) - base
        if lapse:
            density *= (1 + lapse * rise / start) ** (-gravity / lapse - 1)
        else:
            density *= np.exp(-gravity * rise / start)
    return density


_OZONE_ALTITUDES = 1000.0 * np.arange(0, 76, 2)
# fmt: off
_OZONE_DENSITIES = np.array([
    # U.S. Standard Atmosphere 1976, table 18 (Krueger and Minzner 1976, DOI
    # 10.1029/JC081i024p04477) [1e11 molecules/cm^3], 0 to 74 km; the first is held from 2 km.
    6.8, 6.8, 5.8, 5.7, 6.5, 11.3, 20.2, 23.5, 29.5, 40.4, 47.7, 48.6, 45.4, 40.3, 32.4, 25.2,
    20.3, 15.8, 12.2, 8.73, 6.07, 3.98, 2.74, 1.69, 1.03, 0.664, 0.384, 0.255, 0.161, 0.112,
    0.0733, 0.0481, 0.0317, 0.0172, 0.0075, 0.0054, 0.0022, 0.0017,
])
# fmt: on
