"""A sky as a few soft suns, and its colours as two numbers: what live shadows can be had of.

Each lamp stands for an equal share of the hemisphere. The probe that tells which lamps a point sees
has two channels left beside the sun's, and skylight needs no more: sunlight scattered once and more
often lies close to a plane in RGB, and in it between two extreme colours.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.working_spaces import LUMINANCE
from .irradiance import spread
from .lat_long import directions, solid_angles


@dataclass(frozen=True)
class Dome:
    """``towards`` (n, 3) of the lamps, the solid angle [sr] of each, their ``numbers`` (n, 2), not
    negative, and the ``colours`` (2, 3) that these weigh: radiance is ``numbers @ colours``.
    ``left``: what of the light on level ground two numbers leave, as a fraction."""

    towards: NDArray[np.float64]
    solid_angle: float
    numbers: NDArray[np.float64]
    colours: NDArray[np.float64]
    left: float


def dome(rgb: ArrayLike, count: int = 24) -> Dome:
    """Hold a sky (h, 2 h, 3), its sun's disc taken out, by ``count`` lamps over the horizon.

    A lamp has the mean radiance of the sky that lies nearest to it. 16 to 32 are of use: fewer
    cast edges of shadow, more do not fit Eevee's shadow maps.
    """
    rgb = np.asarray(rgb, dtype=float)
    step = max(1, rgb.shape[0] // 128)
    rgb = rgb[::step, ::step]
    height, width = rgb.shape[:2]
    above = directions(height, width)[: height // 2].reshape(-1, 3)
    weight = np.repeat(solid_angles(height, width)[: height // 2], width)
    towards = spread(2 * count)[:count]
    nearest = np.argmax(above @ towards.T, axis=1)
    light = weight[:, None] * rgb[: height // 2].reshape(-1, 3)
    total = np.stack([np.bincount(nearest, light[:, c], count) for c in range(3)], axis=1)
    radiance = total / np.bincount(nearest, weight, count)[:, None]
    colours = _extremes(radiance)
    numbers = np.maximum(radiance @ np.linalg.pinv(colours), 0.0)
    level = towards[:, 2:] * np.stack([radiance, numbers @ colours])
    true, held = level.sum(axis=1)
    left = float(np.abs(held - true).max() / max(true @ LUMINANCE, 1e-30))
    return Dome(towards, 2.0 * np.pi / count, numbers, colours, left)


def _extremes(radiance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the two outermost colours (2, 3) of the plane nearest to some, of luminance 1."""
    _, _, axes = np.linalg.svd(radiance, full_matrices=False)
    first, second = axes[:2]
    first = first * np.sign(first.sum())
    along, across = radiance @ first, radiance @ second
    slope = across / np.maximum(along, 1e-9 * max(along.max(), 1e-30))
    low, high = slope.min(), slope.max()
    if high - low < 1e-6:  # one colour everywhere
        low, high = low - 1e-3, high + 1e-3
    colours = first + np.array([[low], [high]]) * second
    return colours / (colours @ LUMINANCE)[:, None]
