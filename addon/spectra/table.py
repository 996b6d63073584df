"""Text with a block of numbers in columns: a spreadsheet's CSV, an instrument's own export.

Lines before the block (a preamble, headings) and after it (a trailer) say what its columns hold.
Samples that stand in rows are read by `sample_rows`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from . import quantities, sample_rows, wavelengths
from .cells import Row, Sheet, read_sheet, value
from .curves import NoSpectra, Table
from .files import BinaryFile, plain
from .merging import merged, told_apart
from .quantities import Said
from .table_heads import Heads, heads_of
from .table_numbers import check_widths, numbers_of

__all__ = ["NoSpectra", "Table", "read_table"]

_MOST_PAIRS = 2000
"""Columns of wavelengths in a file: instruments write dozens."""


def read_table(path: str | Path) -> Table:
    """Read a text of spectra, in columns or in rows.

    Comma, semicolon, tab or blanks between columns; decimal commas; ``#`` comments; UTF-8 or UTF-16
    with or without a byte-order mark, else Latin-1. Of columns, one holds the wavelengths, the
    first where nothing is said; where several do, each belongs to the columns behind it. Columns
    that count rows are left out. A header is optional, what is missing reads as NaN.

    Raises
    ------
    InputError
        A file that is missing, empty, binary, larger than 64 MiB or with a line over 4 MiB; no
        column of wavelengths, or one in no known unit; text among rows of numbers; rows longer than
        their header; no further column; wavelengths that are not finite, not above 0, or there
        twice. `NoSpectra` where the text is about something else.
    """
    path = Path(path)
    try:
        sheet = read_sheet(path)
    except BinaryFile as error:
        raise NoSpectra(path, error.problem, "export it as CSV") from None
    if not sheet.rows:
        raise InputError(path, "holds no data", "give a wavelength column and a reflectance column")
    in_rows = sample_rows.read(sheet)
    return in_rows if in_rows is not None else _in_columns(sheet)


def _in_columns(sheet: Sheet) -> Table:
    """Return the spectra of a text that has them in columns."""
    block = _block(sheet)
    heads = heads_of(sheet, block.start, block.rows)
    if not heads.wavelengths and not block.numeric:
        raise _no_spectra(sheet, heads)
    return _table(sheet, block.rows, heads)


class _Block(NamedTuple):
    rows: list[Row]
    start: int
    numeric: int


def _kind(row: Row) -> int:
    """Return 2 for a row of numbers, 1 for one that begins with a number, 0 for text."""
    cells = row.cells[:64]
    numbers = sum(value(cell) is not None for cell in cells)
    if numbers >= 2 and 2 * numbers >= sum(map(bool, cells)):
        return 2
    return int(row.told >= 2 and value(cells[0]) is not None)


def _block(sheet: Sheet) -> _Block:
    """Return the longest run of rows of numbers, and where in the sheet it starts."""
    kinds = [_kind(row) for row in sheet.rows]
    runs: list[tuple[int, int, int]] = []  # rows of numbers, start, end
    start = 0
    for k in range(len(kinds) + 1):
        if k == len(kinds) or not kinds[k]:
            if k > start:
                runs.append((kinds[start:k].count(2), start, k))
            start = k + 1
    if not runs:
        return _Block([], len(kinds), 0)
    numeric, start, end = max(runs, key=lambda run: (run[0], run[2] - run[1]))
    first, last = start, end
    rows = sheet.rows
    numbered = [value(row.cells[0]) is not None for row in rows[first:last]]
    if 2 * sum(numbered) >= len(numbered):  # else the rows have names
        while first < last and not numbered[first - start]:
            first += 1
        while first < last and not numbered[last - 1 - start]:
            last -= 1
    width = Counter(len(row.cells) for row in rows[first:last]).most_common(1)[0][0]
    while last - first > 2 and kinds[last - 1] == 1 and len(rows[last - 1].cells) != width:
        last -= 1
    while last - first > 2 and kinds[first] == 1 and len(rows[first].cells) != width:
        first += 1
    for count, a, b in runs:
        if count >= 2 and a != start and len(rows[a].cells) == len(rows[first].cells):
            broken = rows[b] if a < start else rows[end]
            raise InputError(
                f"{sheet.path}:{broken.line}",
                f"'{plain(broken.text)[:40]}' stands among the rows of numbers",
                "correct or remove the line; give one table per file",
            )
    return _Block(rows[first:last], first, numeric)


def _no_spectra(sheet: Sheet, heads: Heads) -> InputError:
    """Return what is said where no block of numbers is found."""
    first = sheet.rows[0]
    if not wavelengths.heads_wavelengths(first.cells[0]):
        return NoSpectra(
            f"{sheet.path}:{first.line}",
            f"the first column is '{plain(first.cells[0])[:40]}', not a wavelength",
            "put the wavelength first and name it wavelength_nm",
        )
    if len(first.cells) < 2:
        return InputError(
            f"{sheet.path}:{first.line}",
            "there is a wavelength column but no other",
            "add a column, separated by comma, semicolon or tab",
        )
    return InputError(
        sheet.path, "there is a header but no row of numbers", "add the measured values"
    )


def _table(sheet: Sheet, rows: list[Row], heads: Heads) -> Table:
    """Return the table of a block of rows under their headings."""
    path = sheet.path
    if not rows:
        raise _no_spectra(sheet, heads)
    columns = len(heads.names)
    check_widths(sheet, rows, columns, heads.named)
    data, words = numbers_of(rows, columns)
    lines = np.array([row.line for row in rows])
    groups, notes = _groups(sheet, data, heads, words)
    said, x_unit = quantities.around(_texts_around(sheet, rows, heads))
    parts = []
    worded = {column for _, column in words}
    for at, values in groups:
        unit = _unit(sheet, rows, heads.texts[at], x_unit, data[:, at])
        has = np.isfinite(data[:, at]) | np.isfinite(data[:, values]).any(axis=1)
        if at in worded:
            has |= np.array([(k, at) in words for k in range(len(rows))])
        if not has.any():
            raise InputError(path, "holds no numbers of light", "add the measured values")
        nm = wavelengths.to_nm(data[has, at], unit)
        _check(path, nm, lines[has], unit)
        parts.append((nm, data[np.ix_(has, values)], lines[has]))
    chosen = [k for _, values in groups for k in values]
    names = told_apart([plain(heads.names[k]) for k in chosen], collapse=False)
    table = merged(path, names, parts)
    named = dict(zip(chosen, names, strict=True))
    missing = {
        (int(lines[row]), named[column]): word
        for (row, column), word in words.items()
        if column in named
    }
    spectra = len(heads.texts) - len(heads.wavelengths)
    return replace(
        table,
        said=tuple(_said(heads.texts[k], spectra, said) for k in chosen),
        format=_format(sheet),
        words=missing,
        notes=tuple(notes),
    )


def _format(sheet: Sheet) -> str:
    if sheet.path.suffix.lower() in (".csv", ".tsv"):
        return "CSV"
    return "text in columns"


def _said(text: str, spectra: int, around: Said) -> Said:
    """Return what a column's heading says of it, where it is silent what the lines around do."""
    own = quantities.said(text)
    if text == "A" and spectra == 1:  # PerkinElmer's absorbance, or somebody's sample
        return Said("A (absorbance, or a name?)")
    # A plastic among other materials, not absorbance.
    if text.strip() == "ABS" and spectra > 1:
        own = Said()
    return own.over(around)


def _groups(
    sheet: Sheet, data: NDArray, heads: Heads, words: dict[tuple[int, int], str]
) -> tuple[list[tuple[int, list[int]]], list[str]]:
    """Return each column of wavelengths with those of its values, and what was left out."""
    columns = data.shape[1]
    notes = []
    at = heads.wavelengths or _unnamed(sheet, data, heads)
    if not heads.wavelengths and heads.named:
        notes.append(f"column {at[0] + 1} is read as wavelengths in nm: nothing names it")
    empty = ~np.isfinite(data).any(axis=0)
    worded = {column for _, column in words}
    places = set(at)
    aside = [
        k
        for k in range(columns)
        if k not in places
        and (
            (empty[k] and (k in worded or not heads.texts[k]))
            or (wavelengths.numbers_rows(heads.texts[k], data[:, k]) and (heads.named or k < at[0]))
        )
    ]
    if len(aside) + len(at) == columns:  # a mistake in the only column is told
        aside = [k for k in aside if k < at[0] or k not in worded]
    remarks = [f"'{plain(heads.names[k])}'" for k in aside if k in worded and k > at[0]]
    if remarks:
        notes.append(f"left out because they hold no numbers: {', '.join(remarks[:4])}")
    if len(at) > _MOST_PAIRS:
        raise InputError(sheet.path, f"has {len(at)} columns of wavelengths", "split the file")
    left_out = {*at, *aside}
    ends = [*at[1:], columns]
    groups = []
    for number, (place, end) in enumerate(zip(at, ends, strict=True)):
        start = 0 if number == 0 else place + 1
        values = [k for k in range(start, end) if k not in left_out]
        if values:
            groups.append((place, values))
    if not groups:
        raise InputError(
            f"{sheet.path}:{sheet.rows[0].line}",
            "there is a wavelength column but no other",
            "add a column of numbers, separated by comma, semicolon or tab",
        )
    return groups, notes


def _unnamed(sheet: Sheet, data: NDArray, heads: Heads) -> list[int]:
    """Return which columns hold the wavelengths where no heading says it."""
    if heads.wrong:
        raise NoSpectra(
            f"{sheet.path}:{heads.line}",
            f"the first column is '{plain(heads.texts[0])[:40]}', not a wavelength",
            "put the wavelength first and name it wavelength_nm",
        )
    first = data[:, 0]
    if data.shape[1] > 2 and wavelengths.counts(first) and wavelengths.likely(data[:, 1]):
        return [1]
    pairs = list(range(0, data.shape[1], 2))
    if len(pairs) > 1 and all(wavelengths.likely(data[:, k]) for k in pairs):
        return pairs
    if wavelengths.counts(first) or (heads.named and not wavelengths.likely(first)):
        raise NoSpectra(
            f"{sheet.path}:{heads.line}",
            "the first column counts rows, and no other is named as wavelengths",
            "name the column of wavelengths wavelength_nm",
        )
    return [0]


def _unit(sheet: Sheet, rows: list[Row], head: str, x_unit: str, values: NDArray) -> str:
    """Return the unit of a column of wavelengths; `InputError` for one that is no length."""
    unit = wavelengths.unit_of(head) or wavelengths.unit_of(x_unit) or wavelengths.NM
    if unit == wavelengths.INDEX:
        raise InputError(
            f"{sheet.path}:{rows[0].line}",
            f"'{plain(head or x_unit)[:40]}' is not a wavelength",
            "give wavelengths in nm",
        )
    return unit


def _check(path: Path, nm: NDArray, lines: NDArray, unit: str) -> None:
    """Check wavelengths [nm] against what they can be."""
    bad = np.flatnonzero(~np.isfinite(nm) | (nm <= 0))
    if bad.size:
        raise InputError(
            f"{path}:{lines[bad[0]]}",
            f"{nm[bad[0]]:g} is not a wavelength",
            "give wavelengths in nm",
        )
    if nm.max() < 50:
        raise InputError(
            f"{path}:{lines[np.argmax(nm)]}",
            f"the largest wavelength is {nm.max():g}: micrometres",
            "name the column wavelength_um, or multiply it by 1000",
        )
    if wavelengths.counts(nm) and unit == wavelengths.NM:
        raise InputError(
            f"{path}:{lines[0]}", "the wavelengths count 1, 2, 3", "give wavelengths in nm"
        )


def _texts_around(sheet: Sheet, rows: list[Row], heads: Heads) -> list[str]:
    """Return comments and the lines before and after a block, without those that head columns."""
    first, last = rows[0].line, rows[-1].line
    begun = min(heads.line, first) if heads.named else first
    outside = [
        row.text
        for row in sheet.rows
        if row.line > last
        or (row.line < begun and sum(map(bool, row.cells[:9])) < 3)
        or (row.line < begun and sheet.separator == " ")
    ]
    return [text for _, text in sheet.comments[:400]] + outside[:400] + outside[-200:]
