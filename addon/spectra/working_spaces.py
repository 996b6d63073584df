"""Linear RGB working spaces of Blender, as matrices."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import SPACES, default, listed
from ..errors import InputError, parameter

D65_WHITE = 0.3127, 0.3290
"""x and y of the white that is (1, 1, 1) in Blender, whatever the working space."""

WORKING_SPACES = {
    "Linear Rec.709": (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, *D65_WHITE),
    "Linear Rec.2020": (0.708, 0.292, 0.170, 0.797, 0.131, 0.046, *D65_WHITE),
    "ACEScg": (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767),
}
"""Blender's name of each working space, and x and y of its red, green, blue and white.

ITU-R BT.709-6, ITU-R BT.2020-2, and AP1 of ACES (S-2014-004).
"""

DEFAULT_SPACE = default(SPACES)

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Luminance weights of linear Rec.709 (ITU-R BT.709-6)."""

_BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
"""From XYZ to the responses that the Bradford transform scales (Lam 1985)."""


def check_space(space: str) -> str:
    """Return ``space`` where it names a working space, raise `InputError` otherwise."""
    if space not in WORKING_SPACES:
        raise InputError(
            parameter("space"), f"'{space}' is not a working space", f"choose {listed(SPACES)}"
        )
    return space


@cache
def XYZ_to_working(space: str) -> NDArray[np.float64]:
    """Return the matrix (3, 3) from CIE XYZ to linear RGB of ``space``.

    White is D65 in every space: where the space has another white (ACEScg) the Bradford transform
    leads there, as in Blender's own OpenColorIO configuration, so that Rec.709's (1, 1, 1) is
    (1, 1, 1) everywhere. Raises `InputError` for an unknown name.
    """
    xy = np.reshape(WORKING_SPACES[check_space(space)], (4, 2))
    # From the primaries: the published matrices are rounded to four digits.
    return np.linalg.inv(_to_XYZ(xy)) @ _adaptation(np.array(D65_WHITE), xy[3])


def rec709_to_working(space: str) -> NDArray[np.float64]:
    """Return the matrix ``T`` (3, 3) from Linear Rec.709 to ``space``; white stays (1, 1, 1)."""
    return XYZ_to_working(space) @ np.linalg.inv(XYZ_to_working(DEFAULT_SPACE))


def primaries_to_rec709(chromaticities: ArrayLike) -> NDArray[np.float64]:
    """Return the matrix (3, 3) to Linear Rec.709 from a space by its chromaticities.

    ``chromaticities``: x and y of red, green, blue and white, (8,), as OpenEXR files name them.
    Whites are brought to one another by the Bradford transform: (1, 1, 1) stays.
    """
    xy = np.asarray(chromaticities, dtype=float).reshape(4, 2)
    adapt = _adaptation(xy[3], np.array(D65_WHITE))
    return XYZ_to_working(DEFAULT_SPACE) @ adapt @ _to_XYZ(xy)


def _to_XYZ(xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matrix (3, 3) to XYZ, white's Y = 1, from a space by its chromaticities (4, 2)."""
    primaries = _XYZ(xy[:3]).T
    return primaries * np.linalg.solve(primaries, _XYZ(xy[3]))


def _adaptation(xy_from: NDArray[np.float64], xy_to: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Bradford's matrix (3, 3) that brings XYZ from one white (2,) to another."""
    if np.array_equal(xy_from, xy_to):
        return np.eye(3)
    scale = (_BRADFORD @ _XYZ(xy_to)) / (_BRADFORD @ _XYZ(xy_from))
    return np.linalg.solve(_BRADFORD, scale[:, None] * _BRADFORD)


def _XYZ(xy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return XYZ (..., 3), Y = 1, of chromaticities (..., 2)."""
    x, y = np.moveaxis(xy, -1, 0)
    return np.stack([x / y, np.ones_like(y), (1.0 - x - y) / y], axis=-1)


def from_srgb(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return sRGB, 0 to 1, as linear Rec.709 (IEC 61966-2-1): what `srgb` returned, undone."""
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def srgb(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return linear Rec.709 as sRGB, 0 to 1, cut off outside (IEC 61966-2-1)."""
    rgb = np.clip(rgb, 0.0, 1.0)
    return np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1.0 / 2.4) - 0.055)
