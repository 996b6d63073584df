"""A sky whose luminance is known in each direction, with spectra of clear sky and of cloud.

Models of weather say how bright a sky is and not of which spectrum. Here each direction has the
spectrum of our simulated clear sky in that direction, the spectrum of light from a cloud, or a
mixture of the two by luminance. Cloud is CIE daylight D65, the standard illuminant of average
daylight (CIE 015:2018, DOI 10.25039/TR.015.2018): cloud scatters all visible light alike, so what
comes out of it is the light of sun and sky that went in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, parameter
from ..spectra.grid import WAVELENGTHS, WEIGHTS
from ..spectra.illuminants import D65
from ..spectra.photometry import LUMINOUS_EFFICACY
from ..spectra.sensitivities import cmfs
from .simulation import SimulatedSky, nodes

PHOTOPIC: NDArray[np.float64] = LUMINOUS_EFFICACY * WEIGHTS * cmfs()[1]
"""(81,). Times radiance [W m^-2 sr^-1 nm^-1]: luminance [cd/m^2]."""

Luminance = Callable[[NDArray, NDArray], NDArray]
"""Relative luminance (...) at elevations and azimuths from the sun (...) [rad]."""


@dataclass(frozen=True)
class MixedSky:
    """A sky in the manner of `SimulatedSky`, of a given luminance.

    ``clear``: with one channel more than the sky has, luminance [cd/m²]; ``cloud`` (k,): the
    radiance of 1 cd/m² of cloud; ``cover``: its share of the luminance; ``luminance``: relative,
    times ``level`` [cd/m²]; ``direct`` (k,): the sun on a face towards it.
    """

    clear: SimulatedSky
    cloud: NDArray[np.float64]
    cover: float
    luminance: Luminance
    level: float
    direct: NDArray[np.float64]

    @property
    def sun_elevation(self) -> float:
        """Where the sun stands [degrees]."""
        return self.clear.sun_elevation

    @property
    def ground(self) -> NDArray[np.float64]:
        """The reflectance of the ground, (81,)."""
        return self.clear.ground

    def radiance(self, elevation: ArrayLike, from_sun: ArrayLike) -> NDArray[np.float64]:
        """Return the radiance from directions of the sky, (..., k) [W m^-2 sr^-1 nm^-1]."""
        elevation, from_sun = np.asarray(elevation, float), np.abs(np.asarray(from_sun, float))
        seen = self.clear.radiance(elevation, from_sun)
        elevation, from_sun = np.broadcast_arrays(elevation, from_sun)
        spectrum = (1 - self.cover) * seen[..., :-1] / seen[..., -1:] + self.cover * self.cloud
        return self.level * self.luminance(elevation, from_sun)[..., None] * spectrum

    def irradiance(self) -> NDArray[np.float64]:
        """Return the irradiance of the sky, without the sun, on level ground, (k,)."""
        elevation, azimuth, share = nodes(96, 181)
        return np.einsum("ea,eaw->w", share, self.radiance(elevation[:, None], azimuth))

    def seen_by(self, sensitivities: NDArray[np.float64]) -> MixedSky:
        """Return this sky with sensors (j, k) in place of its channels."""
        count, channels = sensitivities.shape
        both = np.zeros((count + 1, channels + 1))
        both[:-1, :-1], both[-1, -1] = sensitivities, 1.0
        direct, cloud = (sensitivities @ each for each in (self.direct, self.cloud))
        return replace(self, clear=self.clear.seen_by(both), cloud=cloud, direct=direct)


def mixed(
    clear: SimulatedSky,
    luminance: Luminance,
    cover: float,
    illuminance: float | None,
    overcast: float,
) -> MixedSky:
    """Return a sky of a relative ``luminance``, a ``cover`` of its light being cloud's.

    ``illuminance`` [lx]: of the sky on level ground. None: that of the clear sky and ``overcast``
    [lx], by the cover. Raises InputError where it is not over 0 and at most 200,000.
    """
    if illuminance is not None and not 0.0 < illuminance <= 2.0e5:
        raise InputError(parameter("illuminance"), f"{illuminance:g} lx", "give up to 200000")
    if illuminance is None:
        bright = float(clear.irradiance() @ PHOTOPIC)
        illuminance = cover * overcast + (1 - cover) * bright
    elevation, azimuth, share = nodes(96, 181)
    relative = float((share * luminance(*np.broadcast_arrays(elevation[:, None], azimuth))).sum())
    return MixedSky(
        clear.seen_by(np.vstack([np.eye(WAVELENGTHS.size), PHOTOPIC])),
        D65() / (D65() @ PHOTOPIC),
        cover,
        luminance,
        illuminance / relative,
        clear.direct * (1 - cover),
    )
