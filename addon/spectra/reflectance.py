"""Reflectances of materials, read from CSV files and brought to the grid."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .grid import WAVELENGTHS, resample
from .table import Table, check_range, read_table

UNITS = ("percent", "fraction")

CLIPPED_UP_TO = 1.05
"""Reflectances over 1 up to this are measurement error and read as 1; more is fluorescence."""

_PERCENT = re.compile(r"%|\bper ?cent|(?<![a-z])pct(?![a-z])|_percent", re.IGNORECASE)
_FRACTION = re.compile(r"\bfraction|_fraction|\[0 ?[-–.]+ ?1\]|\(0 ?[-–.]+ ?1\)", re.IGNORECASE)


@dataclass(frozen=True)
class Reflectances:
    """Reflectances of the materials in one file, on the grid.

    ``values`` (m, 81) in 0 to 1, ``names`` (m), ``unit`` as read (``percent`` or ``fraction``),
    ``notes`` (what was done to the data, a sentence each), ``measured``: from where to where [nm]
    the file has values; beyond, the grid holds those of the ends.
    """

    path: Path
    names: tuple[str, ...]
    values: NDArray[np.float64]
    unit: str
    notes: tuple[str, ...]
    measured: tuple[float, float]


def read_reflectances(
    path: str | Path, unit: str | None = None, column: str | None = None
) -> Reflectances:
    """Read the reflectances of all materials in a CSV file, or of the one that ``column`` names.

    Parameters
    ----------
    path
        The file: `read_table` says which forms are understood.
    unit
        ``percent`` or ``fraction``; without it the column headers decide, and without a unit
        there the size of the numbers: over 2 is percent, up to 1.05 a fraction.
    column
        The header of the one column that matters: errors in others are not looked for.

    Returns
    -------
    Reflectances on the grid. Rows outside 380-780 nm count only as the nearest neighbours of
    that range. Outside the measured range the end values are held, and ``notes`` says so.

    Raises
    ------
    InputError
        What `read_table` raises, and: a largest value between 1.05 and 2 without a unit; NaN or
        values under 0 or over 1.05 (fluorescence); a gap over 20 nm inside 400-700 nm; a range
        that does not cover 400-700 nm; no such column, or several. The message names line and
        column.
    """
    if unit is not None and unit not in UNITS:
        raise InputError("--unit", f"'{unit}' is no unit", "choose percent or fraction")
    table = _visible(read_table(path))
    check_range(table)
    percent, notes = _percent_columns(table, unit)
    if column is not None:
        k = _index(table, column)
        table = replace(table, names=(column,), values=table.values[:, [k]])
        percent = percent[[k]]
    values = np.where(percent, table.values / 100.0, table.values)
    _check_values(table, values, percent)
    if table.unsorted:
        notes.append("the rows were sorted by wavelength")
    over = int(np.count_nonzero(values > 1))
    if over:
        notes.append(f"{over} value(s) over 1, at most {values.max():.3f}, were read as 1")
    low, high = table.wavelengths[[0, -1]]
    if low > WAVELENGTHS[0] or high < WAVELENGTHS[-1]:
        notes.append(f"measured from {low:g} to {high:g} nm; the end values are held beyond")
    return Reflectances(
        path=table.path,
        names=table.names,
        values=np.clip(resample(table.wavelengths, np.minimum(values, 1.0)), 0.0, 1.0),
        unit=UNITS[0] if percent.all() else UNITS[1] if not percent.any() else "mixed",
        notes=tuple(notes),
        measured=(float(low), float(high)),
    )


def split_assignment(text: str) -> tuple[Path, str | None]:
    """Split ``FILE.csv[:COLUMN]``; a colon that belongs to the path (``C:\\``) stays there."""
    if Path(text).exists():
        return Path(text), None
    head, colon, tail = text.rpartition(":")
    # 'C:\bricks.csv' splits into a drive letter and a path: no column is that.
    if not colon or len(head) < 2 or "/" in tail or "\\" in tail:
        return Path(text), None
    return Path(head), tail


def read_assigned(text: str, unit: str | None = None) -> tuple[str, NDArray[np.float64]]:
    """Read the one reflectance that ``FILE.csv[:COLUMN]`` names: its name and values (81,).

    Raises `InputError` as `read_one` does.
    """
    reflectances = read_one(text, unit)
    return reflectances.names[0], reflectances.values[0]


def read_one(text: str, unit: str | None = None) -> Reflectances:
    """Read the one reflectance that ``FILE.csv[:COLUMN]`` names, alone in its `Reflectances`.

    Raises `InputError` where the file has many columns and none is named, and as
    `read_reflectances` does.
    """
    path, column = split_assignment(text)
    reflectances = read_reflectances(path, unit, column)
    if len(reflectances.names) > 1:
        raise InputError(
            path,
            f"holds {len(reflectances.names)} materials",
            f"name one, as in {path.name}:{reflectances.names[0]}",
        )
    return reflectances


def reflectance_hash(values: NDArray[np.float64]) -> str:
    """Return a short stable fingerprint of a reflectance on the grid."""
    return hashlib.sha256(np.round(values, 9).astype("<f8").tobytes()).hexdigest()[:16]


def _visible(table: Table) -> Table:
    """Drop the rows that the grid cannot see, all but the nearest on either side."""
    first = max(np.searchsorted(table.wavelengths, WAVELENGTHS[0], side="right") - 1, 0)
    last = np.searchsorted(table.wavelengths, WAVELENGTHS[-1], side="left") + 1
    keep = slice(first, last)
    return replace(
        table,
        wavelengths=table.wavelengths[keep],
        values=table.values[keep],
        lines=table.lines[keep],
    )


def _index(table: Table, column: str) -> int:
    """Return where the one column of this name stands."""
    if table.names.count(column) > 1:
        raise InputError(table.path, f"several columns are named '{column}'", "rename them")
    if column not in table.names:
        some = ", ".join(f"'{name}'" for name in table.names[:8])
        more = f" and {len(table.names) - 8} more" if len(table.names) > 8 else ""
        raise InputError(table.path, f"no column '{column}'", f"there are {some}{more}")
    return table.names.index(column)


def _percent_columns(table: Table, unit: str | None) -> tuple[NDArray[np.bool_], list[str]]:
    """Decide for every column whether it is in percent, and say how it was decided."""
    columns = len(table.names)
    if unit is not None:
        return np.full(columns, unit == "percent"), [f"read as {unit}, as told"]
    said = [
        True if _PERCENT.search(name) else False if _FRACTION.search(name) else None
        for name in table.names
    ]
    silent = np.array([s is None for s in said])
    percent = np.array([bool(s) for s in said])
    notes = []
    if not silent.all():
        notes.append("the unit was read from the header")
    if silent.any():
        open_values = np.where(np.isfinite(table.values), table.values, 0)[:, silent]
        largest = open_values.max()
        if CLIPPED_UP_TO < largest <= 2:
            row, column = np.unravel_index(np.argmax(open_values), open_values.shape)
            name = np.array(table.names)[silent][column]
            raise InputError(
                f"{table.path}:{table.lines[row]}, column '{name}'",
                f"the largest value is {largest:g}: percent or fraction?",
                "say --unit percent or --unit fraction",
            )
        percent[silent] = largest > 2
        notes.append(
            f"read as {'percent' if largest > 2 else 'fraction'}: the largest value is {largest:g}"
        )
    return percent, notes


def _check_values(table: Table, values: NDArray, percent: NDArray) -> None:
    """Raise for the first value that no reflectance can have."""
    for wrong, problem, cure in (
        (~np.isfinite(values), "is not a number", "fill in the measurement or remove the row"),
        (values < 0, "is under 0", "mend the measurement: a reflectance lies in 0 to 1"),
        (
            values > CLIPPED_UP_TO,
            "is over 1.05 (as a fraction)",
            "check the unit (--unit); fluorescent materials are not covered",
        ),
    ):
        if wrong.any():
            row, column = np.unravel_index(np.argmax(wrong), wrong.shape)
            shown = f"{table.values[row, column]:g}" + (" %" if percent[column] else "")
            raise InputError(
                f"{table.path}:{table.lines[row]}, column '{table.names[column]}'",
                f"{shown} {problem}",
                cure,
            )
