"""Spectra of the light that outdoor scenes are lit by, drawn from our own atmosphere.

The basis `atmosphere` (see `spectra.bases`) is a summary of these. No measured spectrum is among
them: atmospheres are drawn at random, from clear to hazy, thin to thick ozone, dry to humid, over
grass, soil, city and snow, and each gives light of several `KINDS`, with all orders of scattering.

``python -m spectral_skylight.addon.sky.daylight_ensemble`` writes the table that ships, in a
quarter of an hour; the same seed gives the same table.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..bar import Bar
from ..spectra.ensemble import TABLE, Ensemble
from ..spectra.grid import WAVELENGTHS
from ..spectra.sensitivities import cmfs
from .atmosphere import Atmosphere
from .simulation import LOWEST_SUN, Quality, simulate

ELEVATIONS: NDArray[np.float64] = np.concatenate(
    [np.arange(LOWEST_SUN, 8.0), np.arange(8.0, 30.0, 2.0), np.arange(30.0, 91.0, 5.0)]
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
"""What kinds of light an atmosphere gives."""

_QUALITY = Quality(once=(24, 13), more=(12, 9), ways=256, shells=30)
_DRAWS = {True: 12, False: 4}
"""Atmospheres at each elevation with ozone and without, as many a model of the sky has it."""
_DIRECTIONS = 6
_COMPONENTS = 16

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
    seed = int(rng.integers(1 << 30))
    sky = simulate(sun_elevation, atmosphere, quality=_QUALITY, seed=seed, cached=False)
    shade, direct = sky.irradiance(), sky.direct
    sun = direct * max(np.sin(np.radians(sun_elevation)), 0.0)
    daylight = shade + sun
    # Evenly over the sky's solid angle.
    heights, azimuths = np.arcsin(rng.random(_DIRECTIONS + 1)), np.pi * rng.random(_DIRECTIONS + 1)
    *directions, part = sky.radiance(heights, azimuths)
    ground = np.asarray(atmosphere.ground)
    for direction in directions:
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
    veil = rng.uniform(0.0, 1.0) ** 2 / daylight.sum() * part.sum()
    yield "cloudy sky", part + veil * daylight


def draw_ensemble(seed: int = 1964, progress: bool = False) -> Ensemble:
    """Draw atmospheres at each of `ELEVATIONS` and return their light, compressed."""
    spectra, elevations, kinds, with_ozone = [], [], [], []
    bar = Bar()
    for ozone, draws in _DRAWS.items():
        rng = np.random.default_rng([seed, ozone])
        for number, elevation in enumerate(ELEVATIONS):
            if progress:
                bar.show(f"elevation {elevation:.0f}°", number / len(ELEVATIONS))
            for _ in range(draws):
                air = draw_atmosphere(rng)
                air = air if ozone else replace(air, ozone=0.0)
                for kind, spectrum in lights(elevation, air, rng):
                    spectra.append(spectrum / (cmfs()[1] @ spectrum))
                    elevations.append(elevation)
                    kinds.append(kind)
                    with_ozone.append(ozone)
    bar.close()
    return Ensemble.compressed(
        np.array(spectra), np.array(elevations), np.array(kinds), np.array(with_ozone), _COMPONENTS
    )


def main(path: Path = TABLE) -> None:
    """Write the table that ships."""
    draw_ensemble(progress=True).save(path)


if __name__ == "__main__":
    main()
