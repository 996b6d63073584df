"""What a sky's header says of its numbers: their primaries, and what they were multiplied by.

OpenEXR: ``colorInteropID`` (https://github.com/AcademySoftwareFoundation/ColorInterop, names of
colour spaces), which wins over ``chromaticities``. Radiance: ``PRIMARIES``, ``COLORCORR``,
``EXPOSURE`` (https://radsite.lbl.gov/radiance/refer/filefmts.pdf); of several lines the product.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..spectra.working_spaces import DEFAULT_SPACE, XYZ_to_working, primaries_to_rec709
from .exr_layers import shown

D65, ACES = (0.3127, 0.329), (0.32168, 0.33767)
SPACES = {
    "Linear Rec.709": (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, *D65),
    "Linear Rec.2020": (0.708, 0.292, 0.17, 0.797, 0.131, 0.046, *D65),
    "ACEScg": (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, *ACES),
    "ACES2065-1": (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, *ACES),
    "Linear DCI-P3 D65": (0.68, 0.32, 0.265, 0.69, 0.15, 0.06, *D65),
    "Linear Adobe RGB": (0.64, 0.33, 0.21, 0.71, 0.15, 0.06, *D65),
    "Linear FilmLight E-Gamut": (0.8, 0.3177, 0.18, 0.9, 0.065, -0.0805, *D65),
}
"""Chromaticities of red, green, blue and white of what Blender calls these colour spaces."""

XYZ_D65 = "Linear CIE-XYZ D65"

INTEROP = {
    "rec709": "Linear Rec.709",
    "rec2020": "Linear Rec.2020",
    "ap1": "ACEScg",
    "ap0": "ACES2065-1",
    "p3d65": "Linear DCI-P3 D65",
    "adobergb": "Linear Adobe RGB",
    "egamut": "Linear FilmLight E-Gamut",
    "ciexyzd65": XYZ_D65,
}
"""Blender's name of a colour space by the middle word of its ``colorInteropID``."""

_SAME = 0.02
"""Largest difference of two spaces' matrices that rounded chromaticities make."""


@dataclass(frozen=True)
class Declared:
    """What a header says.

    ``to_rec709`` (3, 3): from the file's numbers to Linear Rec.709, None where they are that;
    ``space``: Blender's name of their colour space, empty where it has none; ``factors`` (3,):
    what red, green and blue were multiplied by, None for nothing; ``told``: a sentence for each
    thing that is said and cannot be undone.
    """

    to_rec709: NDArray[np.float64] | None = None
    space: str = DEFAULT_SPACE
    factors: NDArray[np.float64] | None = None
    told: tuple[str, ...] = ()

    @property
    def called(self) -> str:
        """What a sentence calls the file's colours."""
        return self.space or "ones without a name in Blender"


def declared(header: Mapping[str, Any], place: object) -> Declared:
    """Return what a header says of the numbers' colours.

    Raises `InputError` where it says that they are no light: encoded for a display.
    """
    told: list[str] = []
    factors, exposure = _factors(header, told)
    if exposure != 1.0:
        told.append(
            f"its header says that all values were multiplied by {exposure:.4g} (EXPOSURE): they "
            "are read as they stand, as Blender reads them; colors are not affected"
        )
    gamma = _floats(header.get("GAMMA"))
    if gamma and gamma[0] not in (0.0, 1.0):
        told.append(f"its header says GAMMA {gamma[0]:g}: its numbers may not be linear light")
    if header.get("channels") == "XYZ":
        return Declared(np.array(XYZ_to_working(DEFAULT_SPACE)), XYZ_D65, factors, tuple(told))
    space = _named(header.get("colorInteropID"), place, told)
    if space == XYZ_D65:
        return Declared(np.array(XYZ_to_working(DEFAULT_SPACE)), XYZ_D65, factors, tuple(told))
    given = SPACES.get(space) or header.get("chromaticities") or header.get("PRIMARIES")
    matrix = _matrix(given, told)
    if matrix is None or np.abs(matrix - np.eye(3)).max() <= _SAME:
        return Declared(None, DEFAULT_SPACE, factors, tuple(told))
    return Declared(matrix, space or _space_of(matrix), factors, tuple(told))


def _named(identifier: Any, place: object, told: list[str]) -> str:
    """Return Blender's name of the colour space of an interop ID, empty where it has none."""
    if not isinstance(identifier, str) or identifier in ("", "data", "unknown"):
        return ""
    curve, _, rest = identifier.rpartition(":")[2].lower().partition("_")
    middle = rest.partition("_")[0]
    if curve == "lin" and middle in INTEROP:
        return INTEROP[middle]
    called = shown([identifier])
    if middle in INTEROP:
        raise InputError(
            place,
            f"its header says that its numbers are {called}, which is not linear light",
            "save it scene-linear",
        )
    told.append(f"its header names the colour space {called}, which is unknown: not converted")
    return ""


def _matrix(chromaticities: Any, told: list[str]) -> NDArray[np.float64] | None:
    """Return the matrix to Linear Rec.709 of chromaticities, None where there are none."""
    xy = _floats(chromaticities)
    if not any(xy):  # Photoshop writes eight zeros
        return None
    if len(xy) == 8 and min(xy[1::2]) > -0.1 and max(map(abs, xy)) <= 2.0 and xy[7] > 0.0:
        (xr, yr, xg, yg, xb, yb) = xy[:6]
        area = abs((xg - xr) * (yb - yr) - (xb - xr) * (yg - yr))
        if area > 1e-3 and all(abs(y) > 1e-6 for y in xy[1::2]):
            with np.errstate(all="ignore"):  # whites that no eye adapts to
                matrix = primaries_to_rec709(xy)
            if np.isfinite(matrix).all():
                return matrix
    told.append("its header names impossible primaries: not converted")
    return None


def _space_of(matrix: NDArray[np.float64]) -> str:
    """Return the space whose matrix to Linear Rec.709 this is, empty for none of `SPACES`."""
    apart = {name: np.abs(primaries_to_rec709(xy) - matrix).max() for name, xy in SPACES.items()}
    nearest = min(apart, key=lambda name: apart[name])
    return nearest if apart[nearest] <= _SAME else ""


def _factors(
    header: Mapping[str, Any], told: list[str]
) -> tuple[NDArray[np.float64] | None, float]:
    """Return what the channels, and then all of them, were multiplied by."""
    product, exposure = np.ones(3), 1.0
    for line in _lines(header.get("COLORCORR")):
        found = _floats(line)
        if len(found) == 3 and all(0.0 < part < math.inf for part in found):
            product *= found
        else:
            told.append("its header has an impossible COLORCORR: not undone")
    for line in _lines(header.get("EXPOSURE")):
        found = _floats(line)
        if len(found) == 1 and 0.0 < found[0] < math.inf:
            exposure *= found[0]
    return (None if np.array_equal(product, np.ones(3)) else product), exposure


def _lines(value: Any) -> tuple[Any, ...]:
    return () if value is None else value if isinstance(value, tuple) else (value,)


def _floats(value: Any) -> list[float]:
    """Return the finite numbers of a text or tuple; none where anything else is in it."""
    try:
        parts = value.split() if isinstance(value, str) else list(value or ())
        found = [float(part) for part in parts[:16]]
    except (TypeError, ValueError):
        return []
    return found if all(map(math.isfinite, found)) else []
