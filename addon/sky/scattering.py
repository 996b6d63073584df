"""A clear sky by single scattering over the whole spectrum.

Sunlight that air and haze scatter once towards the observer, on a spherical earth, after
T. Nishita et al. 1993, "Display of the Earth Taking into Account Atmospheric Scattering"
(DOI 10.1145/166117.166140), at every wavelength of the grid instead of three. Molecules scatter by
Rayleigh's law with the dispersion of air, haze by Cornette and Shanks' phase function. The lower
half of the sphere is level ground, lit by sun and sky.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..spectra.grid import WAVELENGTHS
from ..spectra.sensitivities import observer
from ..spectra.sunlight import extraterrestrial_sunlight
from .atmosphere import EARTH_RADIUS, Atmosphere, Medium, medium
from .gases import band_absorption, band_depth
from .rays import columns_to_space, distances

SUN_ANGULAR_RADIUS = 0.2665
"""[degrees] at one astronomical unit."""

WHITE_LUMINANCE = 1.0e4
"""[cd/m^2] that RGB (1, 1, 1) of `sky_rgb` stands for: by day a white wall is then near 1."""

LUMINOUS_EFFICACY = 683.002
"""[lm/W] at 555 nm, CIE 018:2019."""

_ELEVATIONS = 96
_AZIMUTHS = 25


def clear_sky(
    sun_elevation: float,
    height: int = 256,
    *,
    sun_azimuth: float = 180.0,
    sun_disc: bool = False,
    atmosphere: Atmosphere | None = None,
    sensitivities: NDArray[np.float64] | None = None,
) -> NDArray[np.float32]:
    """Return a clear sky as spectral radiance, lat-long, (height, 2 height, 81).

    [W m^-2 sr^-1 nm^-1], or seen by ``sensitivities``. Row 0 is at the zenith; directions are
    Blender's, z up and y north.

    Parameters
    ----------
    sun_elevation
        [degrees], -6 to 90. Under the horizon the sky is lit by what clears the earth's shadow.
    height
        Rows, 4 to 4096.
    sun_azimuth
        [degrees], clockwise from north (+y).
    sun_disc
        Whether the sun itself is in the picture, its disc spread over the pixels it touches so
        that its irradiance is exact.
    atmosphere
        `Atmosphere` with its defaults where None.
    sensitivities
        (k, 81) with quadrature weights, such as `observer`: the result is (height, 2 height, k).

    Raises
    ------
    InputError
        An elevation or a height out of range.
    """
    if not -6.0 <= sun_elevation <= 90.0:
        raise InputError("--sun-elevation", f"{sun_elevation:g}°", "give -6 to 90 degrees")
    if not 4 <= height <= 4096:
        raise InputError("--width", f"{2 * height} pixels", "give 8 to 8192")
    atmosphere = atmosphere or Atmosphere()
    sun = _direction(np.radians(sun_elevation), np.radians(90.0 - sun_azimuth))
    elevations = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    longitudes = 2 * np.pi * (0.5 - (np.arange(2 * height) + 0.5) / (2 * height))
    sunlight = extraterrestrial_sunlight()
    direct = sun_transmittance(sun_elevation, atmosphere) * sunlight
    scattered = _table(sun_elevation, atmosphere) * sunlight
    downward = _sky_irradiance(scattered, sun, atmosphere) + direct * max(sun[2], 0.0)
    ground = np.broadcast_to(atmosphere.ground, WAVELENGTHS.shape) * downward / np.pi
    if sensitivities is not None:
        scattered, direct, ground = (
            spectrum @ sensitivities.T for spectrum in (scattered, direct, ground)
        )
    from_sun = np.abs((longitudes - np.arctan2(sun[1], sun[0]) + np.pi) % (2 * np.pi) - np.pi)
    radiance = np.empty((height, 2 * height, ground.size), dtype=np.float32)
    for row, elevation in enumerate(elevations):
        cosine = _direction(elevation, longitudes) @ sun
        radiance[row] = (
            _radiance(scattered, elevation, from_sun, cosine, atmosphere)
            if elevation > 0
            else ground
        )
    if sun_disc:
        _add_disc(radiance, sun, direct, elevations, longitudes)
    return radiance


def sky_rgb(sun_elevation: float, height: int = 256, **settings: Any) -> NDArray[np.float32]:
    """Return `clear_sky` in linear Rec.709, (height, 2 height, 3), 1 for `WHITE_LUMINANCE`."""
    scale = LUMINOUS_EFFICACY / WHITE_LUMINANCE
    return clear_sky(sun_elevation, height, sensitivities=observer() * scale, **settings)


def _direction(elevation: ArrayLike, longitude: ArrayLike) -> NDArray[np.float64]:
    """Return unit vectors (..., 3); longitude [rad] counter-clockwise from +x."""
    elevation, longitude = np.broadcast_arrays(elevation, longitude)
    return np.stack(
        [
            np.cos(elevation) * np.cos(longitude),
            np.cos(elevation) * np.sin(longitude),
            np.sin(elevation),
        ],
        axis=-1,
    )


def _rayleigh_phase(cosine: NDArray) -> NDArray:
    """Rayleigh's phase function, 1/sr."""
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine**2)


def _haze_phase(cosine: NDArray, g: float) -> NDArray:
    """Cornette and Shanks 1992 (DOI 10.1364/AO.31.003152), 1/sr."""
    return (
        3.0
        / (8.0 * np.pi)
        * ((1.0 - g**2) * (1.0 + cosine**2))
        / ((2.0 + g**2) * (1.0 + g**2 - 2.0 * g * cosine) ** 1.5)
    )


def sun_transmittance(sun_elevation: float, atmosphere: Atmosphere) -> NDArray[np.float64]:
    """Return what of the direct sun reaches the ground, (81,); 0 under the horizon."""
    matter = medium(atmosphere)
    columns = columns_to_space(matter, EARTH_RADIUS, np.sin(np.radians(sun_elevation)))
    return transmittance(matter, columns)


def transmittance(matter: Medium, columns: NDArray) -> NDArray[np.float64]:
    """Return what passes through columns (..., 5) of air, haze, ozone, water, oxygen, (..., 81).

    0 where they are infinite.
    """
    blocked = np.isinf(columns).any(axis=-1, keepdims=True)
    columns = np.where(blocked, 0.0, columns)
    result = np.exp(-(columns[..., :3] @ matter.extinction))
    if matter.bands.any():
        where, _ = band_absorption()
        result[..., where] *= np.exp(-band_depth(columns[..., 3:] * matter.bands))
    return np.where(blocked, 0.0, result)


def single_scattering(
    sun_elevation: float,
    directions: NDArray[np.float64],
    atmosphere: Atmosphere | None = None,
    sun_azimuth: float = 180.0,
) -> NDArray[np.float64]:
    """Return the radiance that sunlight scattered once brings from directions of the sky, (m, 81).

    [W m^-2 sr^-1 nm^-1]. ``directions`` (m, 3): unit vectors above the horizon, z up and y north;
    elevations and azimuth [degrees], the azimuth clockwise from north.
    """
    matter = medium(atmosphere or Atmosphere())
    sun = _direction(np.radians(sun_elevation), np.radians(90.0 - sun_azimuth))
    air, haze = scattered_once(matter, sun, directions)
    cosine = directions @ sun
    scattered = _rayleigh_phase(cosine)[:, None] * air
    scattered += _haze_phase(cosine, matter.asymmetry)[:, None] * haze
    return scattered * extraterrestrial_sunlight()


def scattered_once(matter: Medium, sun: NDArray, directions: NDArray) -> NDArray[np.float64]:
    """Return light scattered once, by air and by haze, per sunlight and phase function, (2, m, 81).

    Nishita's equation 9 with its phase functions left out. Within a shell, what it scatters is
    attenuated exactly; sunlight is taken from the middle of the way through it.
    """
    lowest = EARTH_RADIUS * np.sqrt(np.maximum(1.0 - directions[:, 2] ** 2, 0.0))
    start = EARTH_RADIUS * directions[:, 2:]
    reach = np.maximum(distances(matter, lowest), start)
    way = np.diff(reach)
    middle = 0.5 * (reach[:, 1:] + reach[:, :-1]) - start
    position = middle[..., None] * directions[:, None, :] + np.array([0.0, 0.0, EARTH_RADIUS])
    radius = np.linalg.norm(position, axis=-1)
    to_sun = columns_to_space(matter, radius, position @ sun / radius)
    within = way[..., None] * matter.density
    before = np.cumsum(within, axis=1) - within
    result = np.zeros((2, len(directions), WAVELENGTHS.size))
    for k in range(way.shape[1]):  # one shell at a time bounds the memory
        lit = np.flatnonzero(np.isfinite(to_sun[:, k, 0]) & (way[:, k] > 0))
        depth = within[lit, k, :3] @ matter.extinction
        # The mean of exp(-t) over 0 to depth; expm1 is exact where the depth is small.
        mean = np.where(depth > 1e-9, -np.expm1(-depth) / np.maximum(depth, 1e-9), 1.0)
        halved = before[lit, k] + 0.5 * within[lit, k] * _BANDS_ONLY
        light = mean * transmittance(matter, halved + to_sun[lit, k])
        for kind in range(2):
            result[kind, lit] += within[lit, k, kind, None] * light
    return result * matter.scattering[:2, None, :]


def _table(sun_elevation: float, atmosphere: Atmosphere) -> NDArray[np.float64]:
    """Return `scattered_once` on the nodes that `_radiance` interpolates between.

    (2, elevations, azimuths from the sun, 81). The phase functions, which alone change fast
    around the sun, come afterwards.
    """
    elevation = np.pi / 2 * ((np.arange(_ELEVATIONS) + 0.5) / _ELEVATIONS) ** 2
    view = _direction(elevation[:, None], np.linspace(0.0, np.pi, _AZIMUTHS))
    sun = _direction(np.radians(sun_elevation), 0.0)
    table = scattered_once(medium(atmosphere), sun, view.reshape(-1, 3))
    return table.reshape(2, _ELEVATIONS, _AZIMUTHS, WAVELENGTHS.size)


_BANDS_ONLY = np.array([0.0, 0.0, 0.0, 1.0, 1.0])
"""Matter whose attenuation within a shell is taken at its middle."""


def _radiance(
    scattered: NDArray, elevation: float, from_sun: NDArray, cosine: NDArray, atmosphere: Atmosphere
) -> NDArray:
    """Interpolate the table ``scattered`` along one elevation and apply the phase functions."""
    row = np.clip(np.sqrt(elevation / (np.pi / 2)) * _ELEVATIONS - 0.5, 0.0, _ELEVATIONS - 1.000001)
    k = int(row)
    ring = scattered[:, k] + (row - k) * (scattered[:, k + 1] - scattered[:, k])
    column = np.clip(from_sun / np.pi * (_AZIMUTHS - 1), 0.0, _AZIMUTHS - 1.000001)
    j = column.astype(int)
    air, haze = ring[:, j] + (column - j)[:, None] * (ring[:, j + 1] - ring[:, j])
    phases = _rayleigh_phase(cosine), _haze_phase(cosine, atmosphere.asymmetry)
    return phases[0][:, None] * air + phases[1][:, None] * haze


def _sky_irradiance(scattered: NDArray, sun: NDArray, atmosphere: Atmosphere) -> NDArray:
    """Return the irradiance of the sky on level ground, (81,)."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    # Over the squared sine of the elevation, the projected solid angle is uniform.
    azimuth = np.pi * (np.arange(90) + 0.5) / 90
    longitudes = np.arctan2(sun[1], sun[0]) + azimuth
    total = np.zeros(scattered.shape[-1])
    for node, weight in zip(nodes, weights, strict=True):
        elevation = np.arcsin(np.sqrt(0.5 * (node + 1)))
        cosine = _direction(elevation, longitudes) @ sun
        ring = _radiance(scattered, elevation, azimuth, cosine, atmosphere)
        total += 0.5 * weight * np.pi * ring.mean(axis=0)
    return total


def _add_disc(
    radiance: NDArray,
    sun: NDArray,
    direct: NDArray,
    elevations: NDArray,
    longitudes: NDArray,
) -> None:
    """Add the sun's disc to the pixels that it touches, with its irradiance kept exactly."""
    height = elevations.size
    half = np.pi / (2 * height)
    sub = (np.arange(8) + 0.5) / 4 - 1  # 8 x 8 points a pixel decide how much of it is disc
    rows = np.flatnonzero(
        np.abs(elevations - np.arcsin(sun[2])) < np.radians(SUN_ANGULAR_RADIUS) + 2 * half
    )
    covered = np.zeros((rows.size, longitudes.size))
    limit = np.cos(np.radians(SUN_ANGULAR_RADIUS))
    for i in sub:
        for j in sub:
            points = _direction((elevations[rows] + i * half)[:, None], longitudes + j * half)
            covered += points @ sun >= limit
    # A disc smaller than the sampling falls on the nearest pixel.
    if not covered.any():
        centres = _direction(elevations[rows][:, None], longitudes)
        covered.flat[np.argmax(centres @ sun)] = 1.0
    solid = (np.sin(elevations[rows] + half) - np.sin(elevations[rows] - half)) * 2 * half
    radiance[rows] += (covered[:, :, None] / (covered * solid[:, None]).sum() * direct).astype(
        np.float32
    )
