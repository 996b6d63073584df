"""Skies of any weather, from the irradiances of an hour.

R. Perez, R. Seals and J. Michalsky 1993, *All-weather model for sky luminance distribution*, Solar
Energy 50(3), DOI 10.1016/0038-092X(93)90017-I. Illuminances by R. Perez et al. 1990, *Modeling
daylight availability and irradiance components from direct and global irradiance*, Solar Energy
44(5), DOI 10.1016/0038-092X(90)90055-H.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .mixed_sky import PHOTOPIC, MixedSky, mixed
from .scattering import direction
from .simulation import SimulatedSky

SOLAR_CONSTANT = 1367.0
"""[W/m²], as Perez has it."""

CLEARNESS = np.array([1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2])
"""Where one of the eight bins of the sky's clearness ends and the next begins."""

# fmt: off
LUMINANCE = np.array([
    [1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233, 2.8000, 0.6004,
     1.2375, 1.0000, 1.8734, 0.6297, 0.9738, 0.2809, 0.0356, -0.1246, -0.5718, 0.9938],
    [-1.2219, -0.7730, 1.4148, 1.1016, -0.2054, 0.0367, -3.9128, 0.9156, 6.9750, 0.1774,
     6.4477, -0.1239, -1.5798, -0.5081, -1.7812, 0.1080, 0.2624, 0.0672, -0.2190, -0.4285],
    [-1.1000, -0.2515, 0.8952, 0.0156, 0.2782, -0.1812, -4.5000, 1.1766, 24.7219, -13.0812,
     -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204, -0.0156, 0.1597, 0.4199, -0.5562],
    [-0.5484, -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297, 33.3389, -18.3000,
     -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062, 0.4659, -0.3296, -0.0876, -0.0329],
    [-0.6000, -0.3566, -2.5000, 2.3250, 0.2937, 0.0496, -5.6812, 1.8415, 21.0000, -4.7656,
     -21.5906, 7.2492, -3.5000, -0.1554, 1.4062, 0.3988, 0.0032, 0.0766, -0.0656, -0.1294],
    [-1.0156, -0.3670, 1.0078, 1.4051, 0.2875, -0.5328, -3.8500, 3.3750, 14.0000, -0.9999,
     -7.1406, 7.5469, -3.4000, -0.1078, -1.0750, 1.5702, -0.0672, 0.4016, 0.3017, -0.4844],
    [-1.0000, 0.0211, 0.5025, -0.5119, -0.3000, 0.1922, 0.7023, -1.6317, 19.0000, -5.0000,
     1.2438, -1.9094, -4.0000, 0.0250, 0.3844, 0.2656, 1.0468, -0.3788, -2.4517, 1.4656],
    [-1.0500, 0.0289, 0.4260, 0.3590, -0.3250, 0.1156, 0.7781, 0.0025, 31.0625, -14.5000,
     -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234, 1.5000, -0.6426, 1.8564, 0.5636],
]).reshape(8, 5, 4)
"""Perez 1993, Table 1: of each bin, four numbers for each of a to e."""

DIFFUSE_EFFICACY = np.array([
    (97.24, -0.46, 12.00, -8.91), (107.22, 1.15, 0.59, -3.95), (104.97, 2.96, -5.53, -8.77),
    (102.39, 5.59, -13.95, -13.90), (100.71, 5.94, -22.75, -23.74), (106.42, 3.83, -36.15, -28.83),
    (141.88, 1.90, -53.24, -14.03), (152.23, 0.35, -45.27, -7.98),
])
"""Perez 1990, Table 4: a + b W + c cos Z + d ln Δ [lm/W]."""

DIRECT_EFFICACY = np.array([
    (57.20, -4.55, -2.98, 117.12), (98.99, -3.46, -1.21, 12.38), (109.83, -4.90, -1.71, -8.81),
    (110.34, -5.84, -1.99, -4.56), (106.36, -3.97, -1.75, -6.16), (107.19, -1.25, -1.51, -26.73),
    (105.75, 0.77, -1.26, -34.44), (101.18, 1.58, -1.10, -8.29),
])
"""Perez 1990, Table 4: a + b W + c exp(5.73 Z - 5) + d Δ [lm/W]."""
# fmt: on


@dataclass(frozen=True)
class Weather:
    """What Perez calls a sky: clearness ε and brightness Δ, and where its sun stands [degrees]."""

    clearness: float
    brightness: float
    sun_elevation: float

    @property
    def zenith_angle(self) -> float:
        """Of the sun [rad]."""
        return float(np.radians(90.0 - self.sun_elevation))

    @property
    def bin(self) -> int:
        """Which of the eight."""
        return int(np.searchsorted(CLEARNESS, self.clearness, side="right"))

    @property
    def cover(self) -> float:
        """The share of the sky's light that is a cloud's: 1 - ln ε / ln 6.2, not under 0.

        Perez speaks of luminance alone; this is ours: all at ε = 1, none from the clear bin on.
        """
        return float(np.clip(1.0 - np.log(self.clearness) / np.log(CLEARNESS[-1]), 0.0, 1.0))

    def coefficients(self) -> NDArray[np.float64]:
        """Return a to e, (5,): Perez 1993, eq. 6 to 8."""
        Z, delta = self.zenith_angle, self.brightness
        if 1.065 < self.clearness < 2.8:
            delta = max(delta, 0.2)  # below, the model's luminances are no sky's (Radiance)
        x = LUMINANCE[self.bin]
        found = x[:, 0] + x[:, 1] * Z + delta * (x[:, 2] + x[:, 3] * Z)
        if self.bin == 0:
            c, d = x[2], x[3]
            found[2] = np.exp((delta * (c[0] + c[1] * Z)) ** c[2]) - c[3]
            found[3] = -np.exp(delta * (d[0] + d[1] * Z)) + d[2] + delta * d[3]
        return found

    def luminance(self, elevation: ArrayLike, from_sun: ArrayLike) -> NDArray[np.float64]:
        """Return the relative luminance (...) of directions (...) [rad], not under 0."""
        a, b, c, d, e = self.coefficients()
        sun = direction(np.radians(self.sun_elevation), 0.0)
        gamma = np.arccos(np.clip(direction(np.asarray(elevation), from_sun) @ sun, -1.0, 1.0))
        up = np.maximum(np.sin(elevation), 0.01)  # b can be positive: half a degree, as Radiance
        found = (1 + a * np.exp(b / up)) * (1 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2)
        return np.maximum(found, 0.0)

    def efficacies(self, water: float = 2.0) -> tuple[float, float]:
        """Return the luminous efficacy [lm/W] of the sky's light and of the sun's.

        ``water``: precipitable [cm].
        """
        Z, delta = self.zenith_angle, self.brightness
        diffuse = np.array([1.0, water, np.cos(Z), np.log(delta)])
        direct = np.array([1.0, water, np.exp(5.73 * Z - 5.0), delta])
        sky = float(DIFFUSE_EFFICACY[self.bin] @ diffuse)
        return sky, max(0.0, float(DIRECT_EFFICACY[self.bin] @ direct))


def weather(
    direct: float, diffuse: float, sun_elevation: float, extraterrestrial: float = SOLAR_CONSTANT
) -> Weather:
    """Return what the irradiances of an hour [W/m²] say of the weather.

    ``direct``: of the sun, on a face towards it; ``diffuse``: of the sky, on level ground;
    ``extraterrestrial``: of the sun outside the air. Clearness and brightness are kept to where the
    model was fitted, 1 to 12.1 and 0.01 to 0.6. Raises InputError for a sun not over the horizon
    and for irradiances that are none.
    """
    if not 0.0 < sun_elevation <= 90.0:
        cure = "the model needs one over 0°: give another time"
        raise InputError("sun", f"its elevation is {sun_elevation:.1f}°", cure)
    for name, value, least in (("direct", direct, 0.0), ("diffuse", diffuse, 0.1)):
        if not least <= value <= 1500.0:
            raise InputError(f"{name} irradiance", f"{value:g} W/m²", f"{least:g} to 1500 is light")
    Z = np.radians(90.0 - sun_elevation)
    clearness = ((diffuse + direct) / diffuse + 1.041 * Z**3) / (1 + 1.041 * Z**3)
    # Kasten 1966, as Perez uses it.
    mass = 1 / (np.cos(Z) + 0.15 * (93.885 - np.degrees(Z)) ** -1.253)
    brightness = mass * diffuse / extraterrestrial
    return Weather(
        float(np.clip(clearness, 1.0, 12.1)), float(np.clip(brightness, 0.01, 0.6)), sun_elevation
    )


def all_weather_sky(
    clear: SimulatedSky,
    direct: float,
    diffuse: float,
    *,
    extraterrestrial: float = SOLAR_CONSTANT,
    water: float = 2.0,
) -> MixedSky:
    """Return the sky of an hour's irradiances, with spectra of a simulated ``clear`` sky and cloud.

    Its sun has the spectrum of the clear sky's. Arguments and errors as `weather` and `efficacies`.
    """
    found = weather(direct, diffuse, clear.sun_elevation, extraterrestrial)
    sky, sun = found.efficacies(water)
    mix = mixed(clear, found.luminance, found.cover, sky * diffuse, 0.0)
    return replace(mix, direct=clear.direct * (sun * direct / (clear.direct @ PHOTOPIC)))
