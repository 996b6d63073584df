"""What a reflectance may be: the rules that all files are held to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, parameter
from . import quantities
from .curves import Table, check_range
from .files import plain
from .grid import WAVELENGTHS, resample

UNITS = (quantities.PERCENT, quantities.FRACTION)

CLIPPED_UP_TO = 1.05
"""Reflectances over 1 up to this are measurement error and read as 1; more is fluorescence."""

CLIPPED_DOWN_TO = -0.01
"""Reflectances under 0 and over this are noise, of a dark current taken off, and read as 0."""


class OnGrid(NamedTuple):
    """Columns on the grid (m, 81), 0 in place of those that cannot be used; why, by column; the
    values that were clipped, over 1 and under 0; from where to where [nm] each has values (m, 2).
    """

    values: NDArray[np.float64]
    problems: dict[int, InputError]
    over: NDArray[np.float64]
    under: NDArray[np.float64]
    measured: NDArray[np.float64]


def reflectances_of(table: Table) -> tuple[Table, list[str], dict[str, InputError]]:
    """Return a table's reflectances and transmittances, what was done for it, and what is neither.

    Absorbance, log(1/R) and Kubelka-Munk's K/S are converted, which is exact. Columns of other
    things (counts, light, gloss) are left out; each is told by an `InputError` under its name.
    """
    values, said, notes = table.values, list(table.said), []
    refused: dict[str, InputError] = {}
    kept = []
    for k, one in enumerate(table.said):
        if one.quantity in quantities.TAKEN:
            kept.append(k)
            continue
        made = quantities.converted(one.quantity, values[:, k])
        if made is None:
            refused[table.names[k]] = InputError(
                table.place(None, k),
                f"holds {one.quantity}, not reflectance",
                "give reflectance, transmittance or absorbance",
            )
            continue
        if values is table.values:
            values = values.copy()
        values[:, k] = made
        said[k] = said[k]._replace(unit=quantities.FRACTION)
        kept.append(k)
    for quantity in dict.fromkeys(table.said[k].quantity for k in kept):
        if quantity not in quantities.TAKEN:
            notes.append(f"{quantity} was made reflectance or transmittance: {_FORMULA[quantity]}")
    columns = Table(**{**vars(table), "values": values, "said": tuple(said)}).columns(kept)
    return columns, notes, refused


_FORMULA = {
    quantities.ABSORBANCE: "10^-A",
    quantities.LOG_R: "10^-A",
    quantities.LOG_T: "10^-A",
    quantities.LN_R: "e^-A",
    quantities.LN_T: "e^-A",
    quantities.KUBELKA_MUNK: "1 + F - sqrt(F² + 2F)",
}


def percent_columns(
    table: Table, unit: str | None
) -> tuple[NDArray[np.bool_], list[str], dict[int, InputError]]:
    """Decide for every column whether it is in percent, say how, and where it cannot be decided."""
    told = [one.unit for one in table.said]
    converted = np.array([one.quantity not in quantities.TAKEN for one in table.said], dtype=bool)
    if unit is not None:
        percent = np.full(len(told), unit == quantities.PERCENT) & ~converted
        return percent, [f"read as {unit}, as requested"] if not converted.all() else [], {}
    percent = np.array([one == quantities.PERCENT for one in told], dtype=bool)
    silent = np.array([one not in UNITS for one in told], dtype=bool)
    notes, unclear = [], {}
    if (~silent & ~converted).any() and table.format in ("CSV", "text in columns"):
        notes.append("the unit is the one that the file states")
    if not silent.any():
        return percent, notes, unclear
    seen = table.visible()
    largest = np.where(np.isfinite(seen.values), seen.values, 0.0).max(axis=0, initial=0.0)
    decisive = largest.copy()
    if table.sparse:  # of a library's many spectra, some of which may be broken, most decide
        decisive[silent] = np.median(largest[silent])
    percent[silent] = decisive[silent] > 2.0
    for k in np.flatnonzero(silent):
        never = told[k] == quantities.UNCLEAR and decisive[k] <= 2.0
        if never or CLIPPED_UP_TO < decisive[k] <= 2.0:
            row = int(np.argmin(np.abs(seen.values[:, k] - largest[k])))
            unclear[int(k)] = InputError(
                seen.place(row, int(k)),
                f"the largest value is {largest[k]:g}: percent or fraction?",
                f"give {parameter('unit')} percent or fraction",
            )
    notes += _decided(
        table, silent & ~np.isin(np.arange(len(told)), list(unclear)), percent, decisive
    )
    return percent, notes, unclear


def _decided(table: Table, by_size: NDArray, percent: NDArray, largest: NDArray) -> list[str]:
    """Return a sentence for each unit that sizes have decided."""
    notes = []
    both = (by_size & percent).any() and (by_size & ~percent).any()
    for unit, chosen in zip(UNITS, (by_size & percent, by_size & ~percent), strict=True):
        if chosen.any():
            few = [f"'{table.names[k]}'" for k in np.flatnonzero(chosen)[:3]]
            more = f" and {chosen.sum() - 3} more" if chosen.sum() > 3 else ""
            which = f"{', '.join(few)}{more} " if both else ""
            notes.append(f"{which}read as {unit}: the largest value is {largest[chosen].max():g}")
    return notes


def on_grid(table: Table, percent: NDArray[np.bool_]) -> OnGrid:
    """Return the columns on the grid, and what stands against those that cannot be used.

    What lies outside 380-780 nm cannot spoil a column, nor can its ends where nothing was measured.
    """
    count = len(table.names)
    grid, measured = np.zeros((count, WAVELENGTHS.size)), np.full((count, 2), np.nan)
    problems: dict[int, InputError] = {}
    over, under = [np.empty(0)], [np.empty(0)]
    table = table.visible()
    with np.errstate(all="ignore"):
        fractions = np.where(percent, table.values / 100.0, table.values)
    worded = {name for _, name in table.words}
    for columns, rows in _alike(table, fractions):
        part = table.rows(rows)
        # Most that cannot be used are told by the range that they have in common.
        try:
            check_range(part.columns(columns[:1]))
            fault = None
        except InputError as error:
            fault = error
        values = fractions[np.ix_(rows, columns)]
        good = ((values > CLIPPED_DOWN_TO) & (values <= CLIPPED_UP_TO)).all(axis=0)
        if fault is not None:
            good[:] = False
        for k in np.flatnonzero(~good):
            problems[int(columns[k])] = _problem(
                part.columns(columns[[k]]),
                values[:, [k]],
                percent[columns[k]],
                None if table.names[columns[k]] in worded else fault,
                table.names[columns[0]],
            )
        if good.any():
            usable = np.ascontiguousarray(values[:, good])
            over.append(usable[usable > 1.0])
            under.append(usable[usable < 0.0])
            on = resample(part.wavelengths, np.clip(usable, 0.0, 1.0))
            grid[columns[good]] = np.clip(on, 0.0, 1.0)
            measured[columns[good]] = part.wavelengths[[0, -1]]
    return OnGrid(
        grid, dict(sorted(problems.items())), np.concatenate(over), np.concatenate(under), measured
    )


def _alike(
    table: Table, fractions: NDArray[np.float64]
) -> list[tuple[NDArray[np.int64], NDArray[np.bool_]]]:
    """Return columns that have values in the same rows, and these rows."""
    has = np.isfinite(table.values)
    if not table.sparse:  # a number that is missing between others is a mistake
        begun = np.logical_or.accumulate(has, axis=0)
        has = begun & np.logical_or.accumulate(has[::-1], axis=0)[::-1]
        has |= ~has.any(axis=0)
        at = {name: k for k, name in enumerate(table.names)}
        lines = () if table.lines is None else table.lines.tolist()
        row_of = {line: row for row, line in enumerate(lines)}
        for line, name in table.words:
            if line in row_of and name in at:
                has[row_of[line], at[name]] = True
    outside = (table.wavelengths < WAVELENGTHS[0]) | (table.wavelengths > WAVELENGTHS[-1])
    with np.errstate(invalid="ignore"):
        sound = (fractions > CLIPPED_DOWN_TO) & (fractions <= CLIPPED_UP_TO)
    has &= ~outside[:, None] | sound
    alike: dict[bytes, list[int]] = {}
    for k, pattern in enumerate(np.packbits(has, axis=0).T):
        alike.setdefault(pattern.tobytes(), []).append(k)
    return [(np.array(columns), has[:, columns[0]]) for columns in alike.values()]


def _problem(
    part: Table, values: NDArray, percent: bool, fault: InputError | None, first: str
) -> InputError:
    """Return why one column cannot be used: a ``fault`` that it shares, told of the ``first``."""
    if fault is not None:
        return fault.of(first, part.names[0])
    try:
        _check_values(part, values, percent)
        check_range(part)
    except InputError as error:
        return error
    return InputError(part.place(None, 0), "cannot be used", "correct it")


def _check_values(table: Table, values: NDArray, percent: bool) -> None:
    """Raise for the first value that no reflectance can have."""
    for wrong, problem, cure in (
        (~np.isfinite(values), "is not a number", "fill in the measurement or remove the row"),
        (
            values <= CLIPPED_DOWN_TO,
            "is below 0",
            "correct the measurement: a reflectance lies in 0 to 1",
        ),
        (
            values > CLIPPED_UP_TO,
            "is over 1.05 (as a fraction)",
            f"check the {parameter('unit')}; fluorescent materials are not covered",
        ),
    ):
        if wrong.any():
            row = int(np.argmax(wrong[:, 0]))
            shown = f"{table.values[row, 0]:g}" + (" %" if percent else "")
            word = None
            if table.lines is not None:
                word = table.words.get((int(table.lines[row]), table.names[0]))
            if word is not None:
                shown, cure = f"'{plain(word)[:40]}'", "correct it"
            raise InputError(table.place(row, 0), f"{shown} {problem}", cure)
