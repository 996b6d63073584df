"""Pictures of a simulated clear sky, lat-long, over the whole spectrum or in RGB.

The upper half is `simulation.simulate`'s; the lower half is level ground, lit by sun and sky.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, parameter
from ..spectra.grid import WEIGHTS
from ..spectra.photometry import LUMINOUS_EFFICACY
from ..spectra.sensitivities import cmfs, observer
from .known_spectrum import ATTRIBUTE, ROWS, KnownSpectrum, cell_means
from .scattering import direction
from .simulation import simulate

SUN_ANGULAR_RADIUS = 0.2665
"""[degrees] at one astronomical unit."""

WHITE_LUMINANCE = 1.0e4
"""[cd/m^2] that RGB (1, 1, 1) of `sky_rgb` stands for: by day a white wall is then near 1."""

SCALE = LUMINOUS_EFFICACY / WHITE_LUMINANCE
"""What `observer` times radiance is multiplied by to be such RGB."""

_ROWS_AT_ONCE = 8
"""What is worked on stays in the processor's cache."""


class Sky(Protocol):
    """What `picture` draws: `SimulatedSky`, and `mixed_sky.MixedSky`."""

    @property
    def sun_elevation(self) -> float:
        """Where the sun stands [degrees]."""

    @property
    def direct(self) -> NDArray[np.float64]:
        """The sun on a face towards it, (k,) [W m^-2 nm^-1]."""

    @property
    def ground(self) -> NDArray[np.float64]:
        """The reflectance of the ground, (81,)."""

    def radiance(self, elevation: ArrayLike, from_sun: ArrayLike) -> NDArray[np.float64]:
        """Return the radiance from directions [rad], (..., k) [W m^-2 sr^-1 nm^-1]."""

    def irradiance(self) -> NDArray[np.float64]:
        """Return the irradiance without the sun on level ground, (k,) [W m^-2 nm^-1]."""

    def seen_by(self, sensitivities: NDArray[np.float64]) -> Sky:
        """Return it with sensors (j, k) in place of its channels."""


def clear_sky(
    sun_elevation: float,
    height: int = 256,
    *,
    sun_azimuth: float = 180.0,
    sun_disc: bool = False,
    sensitivities: NDArray[np.float64] | None = None,
    **settings: Any,
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
    sensitivities
        (k, 81) with quadrature weights, such as `observer`: the result is (height, 2 height, k).
    settings
        Of `simulate`: atmosphere, orders, quality, seed, progress, cached.

    Raises
    ------
    InputError
        A height out of range, and as `simulate`.
    """
    if not 4 <= height <= 4096:
        raise InputError(parameter("width"), f"{2 * height} pixels", "give 8 to 8192")
    sky = simulate(sun_elevation, **settings)
    return picture(sky, height, sun_azimuth, sun_disc, sensitivities)


def picture(
    sky: Sky,
    height: int,
    sun_azimuth: float = 180.0,
    sun_disc: bool = False,
    sensitivities: NDArray[np.float64] | None = None,
) -> NDArray[np.float32]:
    """Return a simulated sky as a picture: see `clear_sky`."""
    sun = direction(np.radians(sky.sun_elevation), np.radians(90.0 - sun_azimuth))
    elevations = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    longitudes = 2 * np.pi * (0.5 - (np.arange(2 * height) + 0.5) / (2 * height))
    downward = sky.irradiance() + sky.direct * max(sun[2], 0.0)
    direct, ground = sky.direct, sky.ground * downward / np.pi
    if sensitivities is not None:
        sky = sky.seen_by(sensitivities)
        direct, ground = direct @ sensitivities.T, ground @ sensitivities.T
    from_sun = np.abs((longitudes - np.arctan2(sun[1], sun[0]) + np.pi) % (2 * np.pi) - np.pi)
    radiance = np.empty((height, 2 * height, ground.size), dtype=np.float32)
    above = int((elevations > 0.0).sum())
    for first in range(0, above, _ROWS_AT_ONCE):
        rows = slice(first, min(first + _ROWS_AT_ONCE, above))
        radiance[rows] = sky.radiance(elevations[rows, None], from_sun)
    radiance[above:] = ground
    if sun_disc:
        _add_disc(radiance, sun, direct, elevations, longitudes)
    return radiance


def sky_rgb(sun_elevation: float, height: int = 256, **settings: Any) -> NDArray[np.float32]:
    """Return `clear_sky` in linear Rec.709, (height, 2 height, 3), 1 for `WHITE_LUMINANCE`."""
    return clear_sky(sun_elevation, height, sensitivities=observer() * SCALE, **settings)


def spectrum_of(sky: Sky, sun_azimuth: float = 180.0, sun_disc: bool = False) -> KnownSpectrum:
    """Return the spectra of a simulated sky, in the units of `sky_rgb`."""
    cells = cell_means(picture(sky, 2 * ROWS, sun_azimuth)) * SCALE
    if not sun_disc:
        return KnownSpectrum(cells)
    sun = direction(np.radians(sky.sun_elevation), np.radians(90.0 - sun_azimuth))
    return KnownSpectrum(cells, sky.direct * SCALE / np.pi, sun)


def header_of(sky: Sky, sun_azimuth: float = 180.0, sun_disc: bool = False) -> dict[str, Any]:
    """Return what the file of a sky in the manner of `sky_rgb` says of it: units and spectra."""
    spectrum = spectrum_of(sky, sun_azimuth, sun_disc).to_text()
    return {"whiteLuminance": WHITE_LUMINANCE, ATTRIBUTE: spectrum}


def white_of(sky: Sky) -> float:
    """Return the luminance of a white surface that looks at the sun, about the brightest there is.

    In the units of `sky_rgb`; of one that looks up where the sun is under the horizon.
    """
    shines = sky.sun_elevation > 0.0
    share = (1.0 + np.sin(np.radians(sky.sun_elevation))) / 2.0 if shines else 1.0
    light = share * sky.irradiance() + shines * sky.direct
    return float(light @ (WEIGHTS * cmfs()[1])) * SCALE / np.pi


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
            points = direction((elevations[rows] + i * half)[:, None], longitudes + j * half)
            covered += points @ sun >= limit
    # A disc smaller than the sampling falls on the nearest pixel.
    if not covered.any():
        centres = direction(elevations[rows][:, None], longitudes)
        covered.flat[np.argmax(centres @ sun)] = 1.0
    solid = (np.sin(elevations[rows] + half) - np.sin(elevations[rows] - half)) * 2 * half
    radiance[rows] += (covered[:, :, None] / (covered * solid[:, None]).sum() * direct).astype(
        np.float32
    )
