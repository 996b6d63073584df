"""How much light changes the colors of things: the CIE's color rendering index.

CIE 13.3-1995, *Method of measuring and specifying colour rendering properties of light sources*.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .colour_temperature import cct_and_duv, planckian
from .datasets import TEST_COLOURS, dataset
from .grid import WEIGHTS, resample
from .illuminants import daylight
from .sensitivities import cmfs

GENERAL = 8
"""Of the test colors so many, the first, make the general index Ra."""

_DAYLIGHT = 5000.0
"""[K] from which on the reference is daylight and no black body."""


@cache
def sample_colours() -> NDArray[np.float64]:
    """Return the reflectances of the CIE's fourteen test colors, (14, 81), from colour-science."""
    table = dataset(TEST_COLOURS, "CIE 1995")
    colours = resample(table.wavelengths, table.values)
    colours.flags.writeable = False
    return colours


def rendering_indices(light: ArrayLike, reference: ArrayLike | None = None) -> NDArray[np.float64]:
    """Return the special indices R1 to R14 of a light's spectrum (81,), (14,).

    ``reference`` (81,): the light that renders as it should; None: the black body or daylight of
    the same correlated color temperature. 100 where nothing changes; negative is possible. NaN of
    light without a color temperature where the reference depends on it.
    """
    light = np.asarray(light, dtype=float)
    XYZ = cmfs() * WEIGHTS
    if reference is None:
        T, _ = cct_and_duv(XYZ @ light)
        if not np.isfinite(T):
            return np.full(len(sample_colours()), np.nan)
        reference = planckian(T) if T < _DAYLIGHT else daylight(T)
    seen, right = (_seen(np.asarray(each, dtype=float), XYZ) for each in (light, reference))
    white, uv, Y = seen
    right_white, right_uv, right_Y = right
    # Adaptation to the light (von Kries, equation 7 there).
    c, d = _adaptation(uv)
    (c_light, d_light), (c_right, d_right) = _adaptation(white), _adaptation(right_white)
    c, d = c * (c_right / c_light), d * (d_right / d_light)
    below = 16.518 + 1.481 * c - d
    adapted = np.stack([(10.872 + 0.404 * c - 4.0 * d) / below, 5.520 / below], axis=-1)
    apart = _UVW(adapted, Y, right_white) - _UVW(right_uv, right_Y, right_white)
    return 100.0 - 4.6 * np.linalg.norm(apart, axis=-1)


def rendering_index(light: ArrayLike, reference: ArrayLike | None = None) -> float:
    """Return the general index Ra, the mean of R1 to R8; arguments as of `rendering_indices`."""
    return float(rendering_indices(light, reference)[:GENERAL].mean())


def _seen(light: NDArray, XYZ: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """CIE 1960 u, v of a light (2,) and of the test colors in it (14, 2), and their Y of 100."""
    white = XYZ @ light
    colours = (sample_colours() * light) @ XYZ.T
    return _uv(white), _uv(colours), 100.0 * colours[:, 1] / white[1]


def _uv(XYZ: NDArray) -> NDArray[np.float64]:
    X, Y, Z = np.moveaxis(XYZ, -1, 0)
    return np.stack([4.0 * X, 6.0 * Y], axis=-1) / (X + 15.0 * Y + 3.0 * Z)[..., None]


def _adaptation(uv: NDArray) -> tuple[NDArray, NDArray]:
    u, v = np.moveaxis(uv, -1, 0)
    return (4.0 - u - 10.0 * v) / v, (1.708 * v + 0.404 - 1.481 * u) / v


def _UVW(uv: NDArray, Y: NDArray, white: NDArray) -> NDArray[np.float64]:
    """CIE 1964 U*, V*, W* (14, 3)."""
    W = 25.0 * np.cbrt(Y) - 17.0
    return np.concatenate([13.0 * W[:, None] * (uv - white), W[:, None]], axis=1)
