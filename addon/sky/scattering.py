"""Sunlight scattered once, on a spherical earth, over the whole spectrum.

After T. Nishita et al. 1993, "Display of the Earth Taking into Account Atmospheric Scattering"
(DOI 10.1145/166117.166140), at every wavelength of the grid instead of three. No chance is in it:
the shells of `atmosphere` are added up along each ray.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.grid import WAVELENGTHS
from .atmosphere import EARTH_RADIUS, Atmosphere, Medium, medium
from .gases import band_absorption, band_depth
from .path_lengths import columns_to_space, distances
from .products import product


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
    result = np.exp(-product(columns[..., :3], matter.extinction))
    if matter.bands.any():
        where, _ = band_absorption()
        result[..., where] *= np.exp(-band_depth(columns[..., 3:] * matter.bands))
    return np.where(blocked, 0.0, result)


def scattered_once(matter: Medium, sun: NDArray, directions: NDArray) -> NDArray[np.float64]:
    """Return light scattered once, by air and by haze, per sunlight and phase function, (2, m, 81).

    Nishita's equation 9 with its phase functions left out. Within a shell, what it scatters is
    attenuated exactly; sunlight is taken from the middle of the way through it.
    """
    parts = [
        _scattered_once(matter, sun, directions[first : first + _TOGETHER])
        for first in range(0, len(directions), _TOGETHER)
    ]
    return np.concatenate(parts, axis=1)


_TOGETHER = 64  # directions: the arrays then stay in the processor's cache


def _scattered_once(matter: Medium, sun: NDArray, directions: NDArray) -> NDArray[np.float64]:
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
    for k in range(way.shape[1]):
        lit = np.flatnonzero(np.isfinite(to_sun[:, k, 0]) & (way[:, k] > 0))
        depth = within[lit, k, :3] @ matter.extinction
        # The mean of exp(-t) over 0 to depth; of a small depth, whose exp is rounded, its series.
        thin = depth < 1e-6
        mean = np.where(
            thin, 1.0 - 0.5 * depth, (1.0 - np.exp(-depth)) / np.where(thin, 1.0, depth)
        )
        halved = before[lit, k] + 0.5 * within[lit, k] * _BANDS_ONLY
        light = mean * transmittance(matter, halved + to_sun[lit, k])
        for kind in range(2):
            result[kind, lit] += within[lit, k, kind, None] * light
    return result * matter.scattering[:2, None, :]


_BANDS_ONLY = np.array([0.0, 0.0, 0.0, 1.0, 1.0])
"""Matter whose attenuation within a shell is taken at its middle."""


def direction(elevation: ArrayLike, longitude: ArrayLike) -> NDArray[np.float64]:
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
