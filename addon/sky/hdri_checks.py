"""Signs that a sky's numbers are not the light that they should be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..spectra.sorting import median
from .lat_long import solid_angles
from .panorama import Panorama

_FLAT = 0.005
"""Part of the sphere that may be flat white: the largest spot that can be the sun (radius 5°) is
0.002. Real scene-linear skies have none; tone-mapped ones that show a sun 0.02 to 0.2."""

_COLOURED = 0.03
"""Median of |log(blue / red)| under which a sky is grey itself, and its brightest part may be."""


def signs(panorama: Panorama) -> list[str]:
    """Return the sky's own notes and a sentence for each sign that its numbers are no light."""
    found = []
    share = flat_white(panorama.rgb)
    if share > _FLAT:
        found.append(
            f"{100 * share:.0f} % of the panorama is flat white: it is tone-mapped or clipped, so "
            "that its light and colors are wrong; use the scene-linear HDRI"
        )
    return [*panorama.notes, *found]


def flat_white(rgb: NDArray[np.float32]) -> float:
    """Return the part of the sphere, 0 to 1, that is as white as numbers of this sky get.

    White is where all channels end at one value though the rest of the sky is coloured; 0 where
    the channels end apart, as in light, and in a grey sky.
    """
    top = rgb.max(axis=(0, 1))
    if top.min() < 0.99 * top.max():
        return 0.0
    height, width = rgb.shape[:2]
    flat = (rgb >= 0.99 * top).all(axis=2)
    upper = rgb[: height // 2][~flat[: height // 2]]
    upper = upper[(upper > 0.0).all(axis=1)]
    if not len(upper) or median(np.abs(np.log(upper[:, 2] / upper[:, 0]))) < _COLOURED:
        return 0.0
    return float(flat.sum(axis=1) @ solid_angles(height, width)) / (4.0 * np.pi)
