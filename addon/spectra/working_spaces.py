"""Linear RGB working spaces of Blender, as matrices."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

WORKING_SPACES = {
    "Linear Rec.709": "ITU-R BT.709",
    "Linear Rec.2020": "ITU-R BT.2020",
    "ACEScg": "ACEScg",
}
"""Blender's name of each working space and colour-science's."""

DEFAULT_SPACE = "Linear Rec.709"


def check_space(space: str) -> str:
    """Return ``space`` where it names a working space, raise `InputError` otherwise."""
    if space not in WORKING_SPACES:
        names = ", ".join(f"'{name}'" for name in WORKING_SPACES)
        raise InputError("--space", f"'{space}' is not a working space", f"choose one of {names}")
    return space


@cache
def XYZ_to_working(space: str) -> NDArray[np.float64]:
    """Return the matrix (3, 3) from CIE XYZ to linear RGB of ``space``.

    White is D65 in every space: where the space has another white (ACEScg) the Bradford transform
    leads there, as in Blender's own OpenColorIO configuration, so that Rec.709's (1, 1, 1) is
    (1, 1, 1) everywhere. Raises `InputError` for an unknown name.
    """
    import colour

    rec709 = colour.RGB_COLOURSPACES["ITU-R BT.709"]
    target = colour.RGB_COLOURSPACES[WORKING_SPACES[check_space(space)]]
    # From the primaries: colour-science's published matrices are rounded to four digits.
    XYZ_to_rec709 = np.linalg.inv(
        colour.normalised_primary_matrix(rec709.primaries, rec709.whitepoint)
    )
    if target is rec709:
        return XYZ_to_rec709
    adapt = colour.adaptation.matrix_chromatic_adaptation_VonKries(
        colour.xy_to_XYZ(rec709.whitepoint), colour.xy_to_XYZ(target.whitepoint), "Bradford"
    )
    XYZ_to_target = np.linalg.inv(
        colour.normalised_primary_matrix(target.primaries, target.whitepoint)
    )
    return XYZ_to_target @ adapt


def rec709_to_working(space: str) -> NDArray[np.float64]:
    """Return the matrix ``T`` (3, 3) from Linear Rec.709 to ``space``; white stays (1, 1, 1)."""
    return XYZ_to_working(space) @ np.linalg.inv(XYZ_to_working(DEFAULT_SPACE))


def primaries_to_rec709(chromaticities: ArrayLike) -> NDArray[np.float64]:
    """Return the matrix (3, 3) to Linear Rec.709 from a space by its chromaticities.

    ``chromaticities``: x and y of red, green, blue and white, (8,), as OpenEXR files name them.
    Whites are brought to one another by the Bradford transform: (1, 1, 1) stays.
    """
    import colour

    xy = np.asarray(chromaticities, dtype=float).reshape(4, 2)
    white = colour.RGB_COLOURSPACES["ITU-R BT.709"].whitepoint
    adapt = colour.adaptation.matrix_chromatic_adaptation_VonKries(
        colour.xy_to_XYZ(xy[3]), colour.xy_to_XYZ(white), "Bradford"
    )
    to_XYZ = colour.normalised_primary_matrix(xy[:3], xy[3])
    return XYZ_to_working(DEFAULT_SPACE) @ adapt @ to_XYZ


def srgb(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return linear Rec.709 as sRGB, 0 to 1, cut off outside (IEC 61966-2-1)."""
    rgb = np.clip(rgb, 0.0, 1.0)
    return np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1.0 / 2.4) - 0.055)
