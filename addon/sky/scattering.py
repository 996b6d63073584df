"""A clear sky by single scattering over the whole spectrum.

Sunlight that air and haze scatter once towards the observer, on a spherical earth, after
T. Nishita et al. 1993, "Display of the Earth Taking into Account Atmospheric Scattering"
(DOI 10.1145/166117.166140), at every wavelength of the grid instead of three. Molecules scatter by
Rayleigh's law with the dispersion of air, haze by Cornette and Shanks' phase function. The lower
half of the sphere is level ground, lit by sun and sky.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..spectra.grid import WAVELENGTHS
from ..spectra.sensitivities import observer
from ..spectra.sunlight import extraterrestrial_sunlight

EARTH_RADIUS = 6.371e6
ATMOSPHERE_HEIGHT = 1.0e5
AIR_SCALE_HEIGHT = 7994.0
HAZE_SCALE_HEIGHT = 1200.0
"""[m]. The scale heights are Nishita's."""

SUN_ANGULAR_RADIUS = 0.2665
"""[degrees] at one astronomical unit."""

WHITE_LUMINANCE = 1.0e4
"""[cd/m^2] that RGB (1, 1, 1) of `sky_rgb` stands for: by day a white wall is then near 1."""

LUMINOUS_EFFICACY = 683.002
"""[lm/W] at 555 nm, CIE 018:2019."""

_STEPS = 40
_SUN_STEPS = 24
_ELEVATIONS = 96
_AZIMUTHS = 25


@dataclass(frozen=True)
class Atmosphere:
    """A clear atmosphere over level ground.

    ``haze``: vertical optical depth of aerosol at 550 nm (0.02 very clear, 0.1 clear, 0.3 hazy);
    ``angstrom``: its Ångström exponent; ``asymmetry``: g of Cornette and Shanks;
    ``ground``: reflectance, one number or a spectrum (81,).
    """

    haze: float = 0.05
    angstrom: float = 1.3
    asymmetry: float = 0.76
    ground: ArrayLike = 0.2


def rayleigh_optical_depth() -> NDArray[np.float64]:
    """Return the vertical optical depth of air at sea level, (81,).

    Bodhaine et al. 1999, equation 30 (DOI 10.1175/1520-0426(1999)016<1854:ORODC>2.0.CO;2), within
    0.01 % over the grid.
    """
    square = (WAVELENGTHS / 1000.0) ** 2
    return (
        0.0021520
        * (1.0455996 - 341.29061 / square - 0.90230850 * square)
        / (1 + 0.0027059889 / square - 85.968563 * square)
    )


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
    direct = _sun_transmittance(sun_elevation, atmosphere) * sunlight
    scattered = _scattered_columns(sun_elevation, atmosphere) * sunlight
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


def _extinction(atmosphere: Atmosphere) -> tuple[NDArray, NDArray]:
    """Return extinction by air and by haze at sea level, (81,) each [1/m]."""
    haze = atmosphere.haze * (550.0 / WAVELENGTHS) ** atmosphere.angstrom
    return rayleigh_optical_depth() / AIR_SCALE_HEIGHT, haze / HAZE_SCALE_HEIGHT


def _density(altitude: NDArray) -> NDArray:
    """Return the densities of air and haze relative to sea level, (..., 2)."""
    altitude = np.maximum(altitude, 0.0)[..., None]
    return np.exp(-altitude / np.array([AIR_SCALE_HEIGHT, HAZE_SCALE_HEIGHT]))


def _exit_distance(radius: NDArray, cosine: NDArray) -> NDArray:
    """Return the way [m] from a radius out of the atmosphere, by the cosine of the zenith angle."""
    along = radius * cosine
    top = EARTH_RADIUS + ATMOSPHERE_HEIGHT
    return -along + np.sqrt(np.maximum(along**2 + top**2 - radius**2, 0.0))


def _sun_columns(radius: NDArray, cosine: NDArray) -> NDArray:
    """Return the columns of air and haze [m at sea level] towards the sun, (..., 2).

    Infinite where the earth stands in between.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_SUN_STEPS)
    # Squared spacing: most of the air is near the start of the way.
    fraction, measure = (0.5 * (nodes + 1)) ** 2, 0.5 * (nodes + 1) * weights
    reach = _exit_distance(radius, cosine)[..., None]
    way = fraction * reach
    square = radius[..., None] ** 2 + way**2 + 2 * radius[..., None] * cosine[..., None] * way
    columns = np.einsum(
        "...sk,s,...->...k", _density(np.sqrt(square) - EARTH_RADIUS), measure, reach[..., 0]
    )
    shadow = (cosine < 0) & (radius * np.sqrt(np.maximum(1 - cosine**2, 0)) < EARTH_RADIUS)
    return np.where(shadow[..., None], np.inf, columns)


def _sun_transmittance(sun_elevation: float, atmosphere: Atmosphere) -> NDArray:
    """Return what reaches the ground of the direct sun, (81,); 0 under the horizon."""
    cosine = np.sin(np.radians(sun_elevation))
    columns = _sun_columns(np.array(EARTH_RADIUS + 1.0), np.array(cosine))
    if not np.isfinite(columns).all():
        return np.zeros(WAVELENGTHS.size)
    return np.exp(-np.stack(_extinction(atmosphere), axis=-1) @ columns)


def _scattered_columns(sun_elevation: float, atmosphere: Atmosphere) -> NDArray:
    """Return light scattered towards the observer per unit of sunlight and of phase function.

    By air and by haze, (2, elevations, azimuths from the sun, 81), on the nodes that `_at`
    interpolates between: Nishita's equation 9 without its phase function, which alone changes
    fast around the sun.
    """
    elevation = np.pi / 2 * ((np.arange(_ELEVATIONS) + 0.5) / _ELEVATIONS) ** 2
    azimuth = np.linspace(0.0, np.pi, _AZIMUTHS)
    sun = _direction(np.radians(sun_elevation), 0.0)
    view = _direction(elevation[:, None], azimuth)
    start = EARTH_RADIUS + 1.0
    reach = _exit_distance(np.array(start), view[..., 2])
    nodes, weights = np.polynomial.legendre.leggauss(_STEPS)
    fraction, measure = (0.5 * (nodes + 1)) ** 2, 0.5 * (nodes + 1) * weights
    way = fraction * reach[..., None]
    position = way[..., None] * view[:, :, None, :] + np.array([0.0, 0.0, start])
    radius = np.linalg.norm(position, axis=-1)
    density = _density(radius - EARTH_RADIUS)
    step = measure * reach[..., None]
    # Column from the observer to each node: the whole steps before it and half its own.
    passed = np.cumsum(density * step[..., None], axis=2) - 0.5 * density * step[..., None]
    columns = passed + _sun_columns(radius, position @ sun / radius)
    air, haze = _extinction(atmosphere)
    reached = np.zeros((*view.shape[:2], 2, WAVELENGTHS.size))
    for k in range(_STEPS):  # one node at a time bounds the memory
        with np.errstate(invalid="ignore"):
            depth = columns[:, :, k, :1] * air + columns[:, :, k, 1:] * haze
        light = np.exp(-depth)[:, :, None, :]
        reached += (density[:, :, k] * step[:, :, k, None])[..., None] * light
    return np.stack([reached[:, :, 0] * air, reached[:, :, 1] * haze])


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
