"""Spectra of the light that outdoor scenes are lit by, drawn from our own atmosphere.

The basis `atmosphere` (see `spectra.bases`) is a summary of these. No measured spectrum is among
them: atmospheres are drawn at random, from clear to hazy, thin to thick ozone, dry to humid, over
grass, soil, city and snow, and each gives light of several `KINDS`. Everything scattered more than
once is taken from an even mean sky and ground: enough for the shape of the spectrum, which is all
that is kept.

``python -m spectral_skylight.addon.sky.daylight_ensemble`` writes the table that ships, in a
minute; the same seed gives the same table.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..spectra.ensemble import TABLE, Ensemble
from ..spectra.grid import WAVELENGTHS
from ..spectra.sensitivities import cmfs
from ..spectra.sunlight import extraterrestrial_sunlight
from .atmosphere import Atmosphere, medium
from .scattering import single_scattering, sun_transmittance

ELEVATIONS: NDArray[np.float64] = np.concatenate(
    [np.arange(-8.0, 8.0), np.arange(8.0, 30.0, 2.0), np.arange(30.0, 91.0, 5.0)]
)
"""Sun elevations [degrees]: close together where ozone and air mass change fast."""

KINDS = (
    "sky",  # one direction of a clear sky
    "shade",  # all of the clear sky on a level face
    "daylight",  # sun and sky on a level face
    "tilted",  # more or less of the sun, the sky in full
    "overcast",  # daylight through a grey cloud, to and fro between cloud and ground
    "sun",
    "surroundings",  # sun and part of the sky, with light from ground or leaves
    "cloudy sky",  # one direction of the sky with a thin cloud in it
)
"""What kinds of light an atmosphere gives; members of the ensemble name them by their place."""

_DRAWS = 12
_DIRECTIONS = 6
_COMPONENTS = 9

# Rough shapes, for variety and not for their values: grass and leaves green with a steep rise
# after 700 nm, soil rising towards red.
_GRASS = np.interp(
    WAVELENGTHS, [380, 500, 550, 600, 670, 690, 740, 780], [3, 4, 9, 6, 4, 6, 40, 45]
)
_SOIL = np.interp(WAVELENGTHS, [380, 550, 780], [8.0, 18.0, 32.0])
_LEAVES = np.interp(
    WAVELENGTHS,
    [380, 500, 520, 550, 570, 600, 640, 680, 690, 700, 720, 740, 780],
    [5, 6, 12, 20, 17, 10, 8, 6, 8, 20, 50, 70, 80],
)


def draw_atmosphere(rng: np.random.Generator) -> Atmosphere:
    """Return one atmosphere at random.

    Aerosol from clean mountain air to haze (log-normal about 0.1), ozone 320 ± 60 Dobson units,
    as climatologies have them (e.g. Holben et al. 2001, DOI 10.1029/2001JD900014, for aerosol).
    """
    ground = (
        _GRASS / 100 * rng.uniform(0.6, 1.5),
        _SOIL / 100 * rng.uniform(0.6, 1.6),
        np.full(WAVELENGTHS.size, rng.uniform(0.05, 0.3)),
        np.full(WAVELENGTHS.size, rng.uniform(0.4, 0.8)),
    )[rng.choice(4, p=[0.35, 0.3, 0.25, 0.1])]
    return Atmosphere(
        haze=float(np.exp(rng.normal(np.log(0.1), 0.7))),
        angstrom=float(np.clip(rng.normal(1.2, 0.45), 0.0, 2.2)),
        asymmetry=float(rng.uniform(0.6, 0.8)),
        haze_albedo=float(rng.uniform(0.85, 1.0)),
        ozone=float(np.clip(rng.normal(320.0, 60.0), 200.0, 520.0)),
        water=float(np.exp(rng.normal(np.log(12.0), 0.6))),
        pressure=float(rng.uniform(800.0, 1020.0)),
        ground=ground,
    )


def lights(
    sun_elevation: float, atmosphere: Atmosphere, rng: np.random.Generator
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield spectra (81,) of one atmosphere and sun elevation [degrees], each with its kind.

    Their sizes do not matter; with the sun under the horizon some are those of the sky alone.
    """
    sky, shade, sun = clear_light(sun_elevation, atmosphere)
    daylight = shade + sun
    direct = sun_transmittance(sun_elevation, atmosphere) * extraterrestrial_sunlight()
    ground = np.asarray(atmosphere.ground)
    for direction in sky[rng.choice(len(sky), _DIRECTIONS, replace=False)]:
        yield "sky", direction
    yield "shade", shade
    yield "daylight", daylight
    # Faces turned to the sun get more of it, the more so the lower it stands.
    steep = max(np.sin(np.radians(sun_elevation)), 0.02)
    yield "tilted", shade + rng.uniform(0.0, 1.5) * steep * direct
    cloud = rng.uniform(0.2, 0.8)
    yield "overcast", daylight * (1.0 - cloud) / (1.0 - cloud * ground)
    if direct.any():
        yield "sun", direct
    colour = ground if rng.random() < 0.3 else _LEAVES / 100
    partial = rng.uniform(0.1, 1.0) * shade + sun
    yield "surroundings", partial * (1.0 + rng.uniform(0.0, 2.0) * colour)
    part = sky[rng.integers(len(sky))]
    veil = rng.uniform(0.0, 1.0) ** 2 / daylight.sum() * part.sum()
    yield "cloudy sky", part + veil * daylight


def clear_light(
    sun_elevation: float, atmosphere: Atmosphere
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return radiance over the sky (m, 81), and irradiance by sky and by sun on level ground (81,).

    Single scattering, and what is scattered again taken from an even sky: with the mean radiance
    J of sky and ground, a direction sends 1 - exp(-t) J more, t its optical depth of scattering.
    """
    directions, weights = _sky_directions()
    matter = medium(atmosphere)
    once = single_scattering(sun_elevation, directions, atmosphere)
    height = max(np.sin(np.radians(sun_elevation)), 0.0)
    sun = sun_transmittance(sun_elevation, atmosphere) * extraterrestrial_sunlight() * height
    # Haze throws most light forward: what it turns round is less than half of what it scatters.
    vertical = matter.scattering[0] + 0.4 * matter.scattering[1]
    air_mass = 1.0 / (
        directions[:, 2] + 0.15 * (np.degrees(np.arcsin(directions[:, 2])) + 3.885) ** -1.253
    )
    returned = 0.5 * (1.0 - np.exp(-1.4 * vertical))
    ground = np.asarray(atmosphere.ground)
    mean = 0.5 * (weights @ once + ground * (weights @ once + sun / np.pi))
    mean = mean / (1.0 - returned) / (1.0 - ground * returned)
    sky = once + (1.0 - np.exp(-air_mass[:, None] * vertical)) * mean
    return sky, np.pi * (weights @ sky), sun


def _sky_directions() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return unit vectors (m, 3) over half the sky, sun in the south, and weights (m,).

    The weights make irradiance / pi of radiances. Two low rings are there for their spectra alone.
    """
    rings = 6
    sine = np.concatenate(
        [np.sin(np.radians([1.5, 5.0])), np.sqrt((np.arange(rings) + 0.5) / rings)]
    )
    azimuth = np.linspace(0.0, np.pi, 7) - np.pi / 2
    across = np.array([0.5, 1, 1, 1, 1, 1, 0.5]) / 6
    cosine = np.sqrt(1 - sine**2)
    vectors = np.stack(
        [
            cosine[:, None] * np.cos(azimuth),
            cosine[:, None] * np.sin(azimuth),
            np.broadcast_to(sine[:, None], (sine.size, azimuth.size)),
        ],
        axis=-1,
    )
    weights = np.concatenate([np.zeros(2), np.full(rings, 1 / rings)])[:, None] * across
    return vectors.reshape(-1, 3), weights.ravel()


def simulate(draws: int = _DRAWS, seed: int = 1964) -> Ensemble:
    """Draw ``draws`` atmospheres at each of `ELEVATIONS` and return their light, compressed."""
    rng = np.random.default_rng(seed)
    spectra, elevations, kinds = [], [], []
    for elevation in ELEVATIONS:
        for _ in range(draws):
            for kind, spectrum in lights(elevation, draw_atmosphere(rng), rng):
                spectra.append(spectrum / (cmfs()[1] @ spectrum))
                elevations.append(elevation)
                kinds.append(KINDS.index(kind))
    return Ensemble.compressed(
        np.array(spectra), np.array(elevations), np.array(kinds), _COMPONENTS
    )


def main(path: Path = TABLE) -> None:
    """Write the table that ships."""
    simulate().save(path)


if __name__ == "__main__":
    main()
