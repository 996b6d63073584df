"""The colour checkers that colour-science brings, by names like ``colour:BabelColor Average``."""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError
from .. import datasets
from ..datasets import dataset
from ..table import Table
from .spectra import table

PREFIX = "colour:"

CHECKERS = ("BabelColor Average", "ColorChecker N Ohta", "ISO 17321-1", "PMC")
"""Three measurements of the ColorChecker's 24 patches, and thirty of skin, leaves and cloth."""


def read(path: str) -> Table:
    """Return a checker's patches; `InputError` for one that is not there."""
    name = path.removeprefix(PREFIX).strip()
    if name not in CHECKERS:
        some = ", ".join(f"'{PREFIX}{checker}'" for checker in CHECKERS)
        raise InputError(path, "is not a checker of colour-science", f"there are {some}")
    wavelengths, values, patches = dataset(datasets.CHECKERS, name)
    return table(Path(path), list(patches), wavelengths, values, unit="fraction")
