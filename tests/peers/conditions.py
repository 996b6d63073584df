"""What is asked of every sky: sun elevations, directions, and the air, in each one's own terms."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spectral_skylight.addon.sky.atmosphere import Atmosphere

SUN_ELEVATIONS = (5.0, 15.0, 30.0, 60.0)
"""[degrees]. Mitsuba's data begin at 0, and close to it are hardly more than extrapolated."""

GROUND = 0.2


@dataclass(frozen=True)
class Condition:
    """One peer's sky: which script makes it with which settings, and the air that is nearest.

    ``air`` holds what the peer's air holds; the same with all that ours has by default besides
    (ozone, water, oxygen, haze that absorbs) is `full`.
    """

    name: str
    script: str
    settings: dict[str, Any] = field(hash=False)
    air: Atmosphere

    @property
    def full(self) -> Atmosphere:
        """Our own air, with this condition's haze."""
        return Atmosphere(haze=self.air.haze, angstrom=self.air.angstrom, ground=GROUND)


def _mitsuba(turbidity: float) -> Condition:
    """Hosek and Wilkie's sky: air and haze alone.

    Its turbidity as haze after Preetham, Shirley and Smits 1999 (DOI 10.1145/311535.311545),
    appendix 1: Ångström's coefficient is 0.04608 T - 0.04586, his exponent 1.3.
    """
    air = Atmosphere(
        haze=(0.04608 * turbidity - 0.04586) * 0.55**-1.3,
        ozone=0.0,
        water=0.0,
        oxygen=False,
        ground=GROUND,
    )
    return Condition(f"mitsuba T={turbidity:g}", "mitsuba_sky.py", {"turbidity": turbidity}, air)


def _radiance(depth: float) -> Condition:
    """Bruneton's sky in Radiance: air, ozone, and haze that scatters all.

    Its continental haze is 0.0955 deep at 550 nm and falls with an exponent of 1.30 (sums over its
    own table, mie_ca.dat); its broadband depth of 0.115 stands for that. Its ozone is a tent from
    10 to 40 km, 280 Dobson units by its depth at 600 nm.
    """
    air = Atmosphere(
        haze=0.0955 * depth / 0.115,
        angstrom=1.30,
        asymmetry=0.7,
        haze_albedo=1.0,
        ozone=280.0,
        water=0.0,
        oxygen=False,
        ground=GROUND,
    )
    return Condition(f"radiance d={depth:g}", "radiance_sky.py", {"depth": depth}, air)


CONDITIONS = (_mitsuba(2.0), _mitsuba(4.0), _radiance(0.05), _radiance(0.115))


def directions() -> NDArray[np.float64]:
    """Return where to look: elevations and azimuths from the sun, (2, 64) [rad].

    Evenly spread over the sky by a Fibonacci spiral (Swinbank and Purser 2006, DOI
    10.1256/qj.05.227).
    """
    index = np.arange(64) + 0.5
    return np.stack([np.arcsin(index / 64), (index * np.pi * (3.0 - 5.0**0.5)) % (2 * np.pi)])


def away_from_sun(sun_elevation: float, degrees: float = 10.0) -> NDArray[np.bool_]:
    """Return which directions are compared, (64,): nearer to the sun the phase functions rule."""
    elevation, azimuth = directions()
    sun = np.radians(sun_elevation)
    cosine = np.sin(elevation) * np.sin(sun) + np.cos(elevation) * np.cos(sun) * np.cos(azimuth)
    return cosine < np.cos(np.radians(degrees))
