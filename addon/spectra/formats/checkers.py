"""The colour checkers that colour-science brings, by names like ``colour:BabelColor Average``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import InputError
from ..table import Table
from .spectra import table, together

PREFIX = "colour:"

CHECKERS = ("BabelColor Average", "ColorChecker N Ohta", "ISO 17321-1", "PMC")
"""Three measurements of the ColorChecker's 24 patches, and thirty of skin, leaves and cloth."""


def recognises(path: str) -> bool:
    """Whether a path is the name of a checker."""
    return path.startswith(PREFIX)


def read(path: str) -> Table:
    """Return a checker's patches; `InputError` for one that is not there."""
    from colour.characterisation import SDS_COLOURCHECKERS

    name = path.removeprefix(PREFIX).strip()
    if name not in CHECKERS:
        some = ", ".join(f"'{PREFIX}{checker}'" for checker in CHECKERS)
        raise InputError(path, "is no checker of colour-science", f"there are {some}")
    patches = SDS_COLOURCHECKERS[name]
    place = Path(path)
    wavelengths, values = together(
        place, [(np.array(sd.wavelengths), np.array(sd.values)) for sd in patches.values()]
    )
    return table(place, list(patches), wavelengths, values, unit="fraction")
