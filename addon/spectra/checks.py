"""What a reflectance may be: the rules that all files are held to."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .grid import resample
from .table import Table, check_range

UNITS = ("percent", "fraction")

CLIPPED_UP_TO = 1.05
"""Reflectances over 1 up to this are measurement error and read as 1; more is fluorescence."""

_PERCENT = re.compile(r"%|\bper ?cent|(?<![a-z])pct(?![a-z])|_percent", re.IGNORECASE)
_FRACTION = re.compile(r"\bfraction|_fraction|\[0 ?[-–.]+ ?1\]|\(0 ?[-–.]+ ?1\)", re.IGNORECASE)


def percent_columns(table: Table, unit: str | None) -> tuple[NDArray[np.bool_], list[str]]:
    """Decide for every column whether it is in percent, and say how it was decided."""
    columns = len(table.names)
    if unit is None and table.unit is not None:
        return np.full(columns, table.unit == "percent"), []
    if unit is not None:
        return np.full(columns, unit == "percent"), [f"read as {unit}, as told"]
    seen = table.visible()
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
        open_values = np.where(np.isfinite(seen.values), seen.values, 0)[:, silent]
        largest = open_values.max(initial=0)
        if table.sparse:  # of many spectra, some of which may be broken, most decide
            largest = np.median(open_values.max(axis=0, initial=0))
        if CLIPPED_UP_TO < largest <= 2:
            row, column = np.unravel_index(
                np.argmin(np.abs(open_values - largest)), open_values.shape
            )
            raise InputError(
                seen.place(int(row), int(np.flatnonzero(silent)[column])),
                f"the largest value is {largest:g}: percent or fraction?",
                "say --unit percent or --unit fraction",
            )
        percent[silent] = largest > 2
        notes.append(
            f"read as {'percent' if largest > 2 else 'fraction'}: the largest value is {largest:g}"
        )
    return percent, notes


def on_grid(
    table: Table, percent: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], dict[int, InputError], NDArray[np.float64]]:
    """Return the columns on the grid (m, 81), why some of them cannot be used, and values over 1.

    The problems by column, in whose place the grid holds 0; the values over 1 that count as 1.
    """
    grid = np.zeros((len(table.names), 81))
    problems: dict[int, InputError] = {}
    over = []
    for columns, part in _alike(table):
        part = part.visible()
        values = np.where(percent[columns], part.values / 100.0, part.values)
        wrong = ~((values >= 0) & (values <= CLIPPED_UP_TO)).all(axis=0)
        found = {}
        try:
            check_range(part)
        except InputError:
            wrong[:] = True
        for k in np.flatnonzero(wrong):
            try:
                check_range(part.columns([k]))
                _check_values(part.columns([k]), values[:, [k]], percent[columns][[k]])
            except InputError as error:
                found[int(columns[k])] = error
        problems |= found
        good = np.flatnonzero(~wrong)
        if good.size:
            usable = np.ascontiguousarray(values[:, good])
            over.append(usable[usable > 1])
            on = resample(part.wavelengths, np.minimum(usable, 1.0))
            grid[columns[good]] = np.clip(on, 0.0, 1.0)
    return grid, dict(sorted(problems.items())), np.concatenate([*over, np.empty(0)])


def _alike(table: Table) -> list[tuple[NDArray[np.int64], Table]]:
    """Return the columns that have values at the same wavelengths, and their rows alone."""
    if not table.sparse:
        return [(np.arange(len(table.names)), table)]
    table = table.visible()
    has = np.isfinite(table.values)
    alike: dict[bytes, list[int]] = {}
    for k, pattern in enumerate(np.packbits(has, axis=0).T):
        alike.setdefault(pattern.tobytes(), []).append(k)
    return [
        (np.array(columns), table.columns(columns).rows(has[:, columns[0]]))
        for columns in alike.values()
    ]


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
                table.place(int(row), int(column)),
                f"{shown} {problem}",
                cure,
            )
