"""How far one colour is from another."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.cielab import XYZ_to_Lab, delta_E_2000
from ..spectra.working_spaces import DEFAULT_SPACE, XYZ_to_working


def relative_error(estimate: ArrayLike, true: ArrayLike) -> NDArray[np.float64]:
    """Return ``|estimate - true| / |true|`` over the last axis of linear Rec.709 colours (..., 3).

    Values out of gamut count as they are. 0 where both are black, inf where only ``true`` is.
    """
    difference = np.linalg.norm(np.subtract(estimate, true), axis=-1)
    length = np.linalg.norm(true, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(difference == 0, 0.0, difference / length)


def to_Lab(RGB: ArrayLike, white: ArrayLike, space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return CIE L*a*b* (..., 3) of working-space colours RGB (..., 3).

    ``white`` (..., 3) is the RGB of the perfect diffuser under the same light, Y = 100; no other
    adaptation.
    """
    to_XYZ = np.linalg.inv(XYZ_to_working(space)).T
    return XYZ_to_Lab(np.asarray(RGB) @ to_XYZ, np.asarray(white) @ to_XYZ)


def delta_E(
    estimate: ArrayLike, true: ArrayLike, white: ArrayLike, space: str = DEFAULT_SPACE
) -> NDArray[np.float64]:
    """Return CIEDE2000 between working-space colours (..., 3), white as in `to_Lab`."""
    return delta_E_2000(to_Lab(estimate, white, space), to_Lab(true, white, space))
