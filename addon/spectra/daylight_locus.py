"""How far a colour lies from every light that is to be expected outdoors.

Three numbers cannot tell a spectrum that no sky has, but a colour that no sky has they do tell. The
reverse does not hold: a fluorescent lamp of 6500 K has the colour of an overcast sky.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .bases import rayleigh, restoration
from .chromaticity import uv
from .ensemble import shipped
from .grid import WEIGHTS
from .nearest import are_farther, second_nearest
from .sensitivities import cmfs, observer

LIMIT = 0.006
"""Distance in CIE 1976 u'v' over which a colour is outside: for 19 of 20 lights of atmospheres that
are not in the ensemble `locus_distance` finds less than half of it, for photographed skies about
this in 99 % of their light; leaves, grass and, by day, warm lamps lie at 0.02 to 0.1 (see the
tests)."""

_DIRECT_SUN = "sun"
"""The kind "sun" of `sky.daylight_ensemble.KINDS`: a lone red sun has the colours of lamps."""

_NEAR = 4.0, 0.3
"""Elevations count that are nearer than this [degrees], and than this part of the elevation: an
HDRI's sun is found to a degree, and its place and refraction are worth another."""


def locus_distance(
    rgb: ArrayLike,
    S_in: NDArray[np.float64] | None = None,
    sun_elevation: float | None = None,
    *,
    direct_sun: bool = False,
) -> NDArray[np.float64]:
    """Return how far colours lie in u'v' from the lights of the shipped ensemble.

    To the second nearest: one alone may be a photon's chance.

    Parameters
    ----------
    rgb
        Colours, (..., 3), as ``S_in`` makes them, not white-balanced; their size does not count.
    S_in
        (3, 81) with quadrature weights; the standard observer in Linear Rec.709 where None. A
        camera's numbers are compared as the paper's basis develops them.
    sun_elevation
        [degrees]: only lights of about this elevation are expected; beyond the ensemble's own its
        nearest. None: all.
    direct_sun
        Whether the light may be the sun's alone. Low, it has any colour from white to deep red.

    Returns
    -------
    (...): 0 for black, inf for colours that have no place in u'v' (X + 15 Y + 3 Z not positive).
    """
    return _measured(second_nearest, rgb, S_in, sun_elevation, direct_sun)


def is_off_daylight_locus(
    rgb: ArrayLike,
    S_in: NDArray[np.float64] | None = None,
    sun_elevation: float | None = None,
    *,
    direct_sun: bool = False,
    limit: float = LIMIT,
) -> NDArray[np.bool_]:
    """Return whether `locus_distance` is over a limit, (...): the same arguments, much faster."""
    farther = partial(are_farther, limit=limit)
    return _measured(farther, rgb, S_in, sun_elevation, direct_sun).astype(bool)


def _measured(
    measure: Callable[[NDArray, NDArray], NDArray],
    rgb: ArrayLike,
    S_in: NDArray[np.float64] | None,
    sun_elevation: float | None,
    direct_sun: bool,
) -> NDArray[np.float64]:
    """Return what ``measure`` says of colours' u'v' and those expected; 0 or inf for others."""
    S_in = observer() if S_in is None else np.asarray(S_in, dtype=float)
    to_XYZ = (cmfs() * WEIGHTS) @ restoration(rayleigh(), S_in)
    rgb = np.asarray(rgb, dtype=float)
    flat = rgb.reshape(-1, 3)
    XYZ = flat @ to_XYZ.T
    place = XYZ @ [1.0, 15.0, 3.0] > 0
    result = np.where(flat.any(axis=1), np.inf, 0.0)
    lights = _lights(S_in.tobytes(), to_XYZ.tobytes(), sun_elevation, direct_sun)
    result[place] = measure(uv(XYZ[place]), lights)
    return result.reshape(rgb.shape[:-1])


@lru_cache(maxsize=8)
def _lights(
    S_in: bytes, to_XYZ: bytes, sun_elevation: float | None, direct_sun: bool
) -> NDArray[np.float64]:
    """Return the expected lights' u'v', (m, 2)."""
    ensemble = shipped()
    expected = np.ones(len(ensemble.kinds), bool) if direct_sun else ensemble.kinds != _DIRECT_SUN
    if sun_elevation is not None:
        elevations = ensemble.elevations
        middle = float(np.clip(sun_elevation, elevations.min(), elevations.max()))
        width = np.hypot(_NEAR[0], _NEAR[1] * max(middle, 0.0))
        expected = expected & (np.abs(elevations - middle) <= width)
    sensor = np.frombuffer(to_XYZ).reshape(3, 3) @ np.frombuffer(S_in).reshape(3, -1)
    return uv(ensemble.spectra[expected] @ sensor.T)
