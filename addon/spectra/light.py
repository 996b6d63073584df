"""Spectra of light, read from CSV files and brought to the grid."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from . import quantities
from .curves import LIGHT, Table, check_range
from .grid import WAVELENGTHS, WEIGHTS, resample
from .sensitivities import cmfs
from .table import read_table

NOISE = 0.01
"""Share of a spectrum that may lie under 0: a dark sky's noise does, differences lie lower."""

_MAY_BE_LIGHT = (
    quantities.NOT_SAID,
    "light",
    "counts",
    "arbitrary units",
    "fluorescence",
)
_PHOTONS = re.compile(r"photons?\b|\bquanta\b|\b[mµμu]?mol\b", re.IGNORECASE)


@dataclass(frozen=True)
class Light:
    """Spectra of light on the grid: ``values`` (k, 81), each over its own luminance; ``names``."""

    path: Path
    names: tuple[str, ...]
    values: NDArray[np.float64]


def read_light(path: str | Path) -> Light:
    """Read all spectra of a CSV file, in any unit per wavelength: their sizes are not kept.

    What a heading says to be photons is divided by the wavelength. Outside its range a spectrum
    holds its end value. Raises `InputError` as `read_table` does, for a range that does not cover
    400-700 nm, gaps of more than 20 nm within it, numbers that are missing, columns without a
    heading among others or said to be no light, such as reflectances, and spectra without
    luminance or under 0 by more than `NOISE`.
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
    _check_quantities(table)
    photons = np.array([bool(_PHOTONS.search(name)) for name in table.names])
    values = resample(table.wavelengths, table.values)
    values = np.where(photons[:, None], values / WAVELENGTHS, values)
    luminance = values @ (cmfs()[1] * WEIGHTS)
    below = np.maximum(-values, 0.0).sum(axis=1) > NOISE * np.abs(values).sum(axis=1)
    dark = np.flatnonzero((luminance <= 0) | below)
    if dark.size:
        problem = "holds no light" if luminance[dark[0]] <= 0 else "is negative"
        raise InputError(table.place(column=int(dark[0])), problem, "remove the column")
    return Light(table.path, table.names, values / luminance[:, None])


def _check_quantities(table: Table) -> None:
    """Raise `InputError` for a column that is no light, by its heading or for want of one."""
    for column, said in enumerate(table.said):
        if len(table.names) > 1 and table.names[column] == "unnamed":
            cure = "give it one, and separate columns by semicolons if numbers have decimal commas"
            raise InputError(table.place(column=column), "has no heading", cure)
        if said.quantity not in _MAY_BE_LIGHT:
            raise InputError(
                table.place(column=column),
                f"holds {said.quantity}, not light",
                "remove the column, or rename it if it is light",
            )
