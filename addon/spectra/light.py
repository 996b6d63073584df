"""Spectra of light, read from CSV files and brought to the grid."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .curves import LIGHT, check_range
from .grid import WEIGHTS, resample
from .sensitivities import cmfs
from .table import read_table


@dataclass(frozen=True)
class Light:
    """Spectra of light on the grid: ``values`` (k, 81), each over its own luminance; ``names``."""

    path: Path
    names: tuple[str, ...]
    values: NDArray[np.float64]


def read_light(path: str | Path) -> Light:
    """Read all spectra of a CSV file, in any unit per wavelength: their sizes are not kept.

    Outside its range a spectrum holds its end value. Raises `InputError` as `read_table` does, for
    a range that does not cover 400-700 nm, gaps of more than 20 nm within it, numbers that are
    missing, and spectra without luminance.
    """
    table = read_table(path)
    check_range(table, LIGHT)
    missing = np.argwhere(~np.isfinite(table.values))
    if missing.size:
        row, column = missing[0]
        raise InputError(
            table.place(row, column),
            "a number is missing",
            "fill it in or remove the row",
        )
    values = resample(table.wavelengths, table.values)
    luminance = values @ (cmfs()[1] * WEIGHTS)
    dark = np.flatnonzero(luminance <= 0)
    if dark.size:
        raise InputError(
            f"{path}, column '{table.names[dark[0]]}'", "holds no light", "remove the column"
        )
    return Light(table.path, table.names, values / luminance[:, None])
