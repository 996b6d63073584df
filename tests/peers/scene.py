"""The small scene that every renderer gets: a ColorChecker on three faces under one sky.

On each face, alone in the world, lie the 24 patches as squares of 1 x 1 in rows of six, patch 1 at
the top left. They are flat and even, so nothing shades or lights anything else: what a renderer
makes of light and reflectance is all that can differ. The sky is Mitsuba's `sunsky`, which of all
here is the one that only Mitsuba can take as a spectrum without a file; under the horizon is black.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.tests.peers.peer import ask

SUN_ELEVATION = 20.0
"""[degrees]. The sun stands over +y; its disc is no part of the sky."""

SUNSKY = {"turbidity": 2.5, "ground": 0.2}
HEIGHT = 256
"""Rows of the sky as a picture."""

COLUMNS, ROWS = 6, 4
PIXELS = 8
"""A patch is that many pixels wide and high."""

SAMPLES = 256
"""For each pixel, where a renderer samples the sky at random."""

EXPOSURE = 0.2
"""What the observer's numbers are multiplied by in RGB files: white is then near 1."""


@dataclass(frozen=True)
class Face:
    """Where a face looks and what is to its right and up, as its camera sees it."""

    name: str
    normal: tuple[float, float, float]
    right: tuple[float, float, float]
    up: tuple[float, float, float]


_HALF = float(np.sqrt(0.5))
FACES = (
    Face("up", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    Face("tilted from the sun", (0.0, -_HALF, _HALF), (1.0, 0.0, 0.0), (0.0, _HALF, _HALF)),
    Face("vertical to the sun", (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
)


@cache
def sky() -> NDArray[np.float64]:
    """Return the sky's spectral radiance, lat-long, (h, 2 h, 81); needs the peers' environment."""
    look = directions(HEIGHT, 2 * HEIGHT)[: HEIGHT // 2]
    elevation = np.arcsin(look[..., 2])
    from_sun = np.arctan2(look[..., 0], look[..., 1])
    wavelengths = WAVELENGTHS[WAVELENGTHS <= 720.0]
    request = {
        "sun_elevations": [SUN_ELEVATION],
        "directions": [elevation.ravel().tolist(), from_sun.ravel().tolist()],
        "wavelengths": wavelengths.tolist(),
        **SUNSKY,
    }
    result = np.zeros((HEIGHT, 2 * HEIGHT, WAVELENGTHS.size))
    seen = ask("mitsuba_sky.py", request)["radiance"][0]
    result[: HEIGHT // 2, :, : wavelengths.size] = seen.reshape(*look.shape[:2], -1)
    return result


@cache
def irradiance() -> NDArray[np.float64]:
    """Return the light on the faces, per pi, (3, 81)."""
    normals = np.array([face.normal for face in FACES])
    spectra = sky()
    parts = [exact_irradiance(spectra[..., k : k + 3], normals) for k in range(0, 81, 3)]
    return np.concatenate(parts, axis=1)


def true_colours() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the patches' colours (3, 24, 3) and white's (3, 3): all 81 bands, linear Rec.709."""
    S, (_, rho) = observer() * EXPOSURE, colorchecker()
    light = irradiance()
    return np.einsum("il,pl,fl->fpi", S, rho, light, optimize=True), light @ S.T
