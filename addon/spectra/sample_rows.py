"""Text with a spectrum in each row, and the wavelengths in a heading: as spectrophotometers export
lists of samples, and R and spreadsheets write matrices."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from . import quantities
from .cells import Row, Sheet, value
from .curves import Table
from .files import plain
from .merging import together, told_apart
from .wavelengths import heads_wavelengths, in_header, unit_of

_LOOKED_AT = 200
"""Rows among which the heading of wavelengths is looked for."""

_MOST_OTHERS = 100
"""Columns that names are looked for in."""

_NAMES = re.compile(
    r"(data|sample|spectrum|target|patch|object|probe[n]?|messung|muster)?[ _-]?"
    r"(names?|labels?|id|title|ids|bezeichnung|beschreibung|nom|nombre|nome|naam|name_?|名称|名前|名)|"
    r"samples?|probe[n]?|muster|échantillons?|muestras?|campion[ei]|amostras?|monster|material|"
    r"materials?|species|description|サンプル名?|試料名?|样品名?称?|образец",
    re.IGNORECASE,
)
_NO_NAME = re.compile(
    r"date|time|datum|zeit|fecha|data$|operator|user|instrument|serial", re.IGNORECASE
)


def read(sheet: Sheet) -> Table | None:
    """Return the spectra of a text that has them in rows, None where it has not.

    Raises `InputError` for rows of another length than their heading, wavelengths both in a heading
    and down a column, and text among the numbers of light.
    """
    found = _heading(sheet)
    if found is None:
        return None
    head, runs, shift = found
    start = sheet.rows.index(head) + 1
    rows = [row for row in sheet.rows[start:] if len(row.cells) >= 2]
    cells = [""] * shift + head.cells
    if not rows or _down_too(sheet, rows, cells, runs):
        return None
    around, _ = quantities.around(
        [text for _, text in sheet.comments[:400]]
        + [row.text for row in sheet.rows[: start - 1][-200:]]
        + [row.text for row in sheet.rows[start:] if len(row.cells) < 2][:200]
    )
    first = min(columns[0] for _, columns, _ in runs) + shift
    taken = {k + shift for _, columns, _ in runs for k in columns}
    labels = _labels(sheet, rows, cells, taken, first)
    names, curves, said, words = [], [], [], {}
    for row, label in zip(rows, labels, strict=True):
        if len(row.cells) > max(len(cells), row.told if row.told == len(cells) else 0):
            raise InputError(
                f"{sheet.path}:{row.line}",
                f"{len(row.cells)} columns where the heading has {len(cells)}",
                "make every row as long as its heading",
            )
        for affix, columns, nm in runs:
            # Columns of a run stand side by side; a short row has the first of them.
            first_of_run = columns[0] + shift
            at = range(first_of_run, min(first_of_run + len(nm), len(row.cells)))
            nm = nm[: len(at)]
            numbers, strange = _values(row, at)
            if not np.isfinite(numbers).any():
                continue
            name = f"{label} {affix}" if len(runs) > 1 and affix else label
            names.append(name)
            curves.append((nm, numbers))
            own = quantities.said(affix)
            if heads_wavelengths(cells[0]):  # then a row is headed by what it holds
                own = own.over(quantities.said(label))
            said.append(own.over(around))
            words[len(names) - 1] = strange
    if not names:
        return None
    _check_words(sheet, rows, names, curves, words)
    everywhere, values = together(sheet.path, curves)
    kind = "CSV, samples in rows" if sheet.path.suffix.lower() == ".csv" else "samples in rows"
    return Table(
        path=sheet.path,
        names=told_apart(names),
        wavelengths=everywhere,
        values=values,
        lines=None,
        unsorted=False,
        said=tuple(said),
        format=kind,
        sparse=True,
    )


def _heading(sheet: Sheet) -> tuple[Row, list, int] | None:
    """Return the row that names wavelengths, its runs of them and by how much rows are longer."""
    for k, row in enumerate(sheet.rows[:_LOOKED_AT]):
        if len(row.cells) < 8:
            continue
        runs = in_header(row.cells)
        if runs:
            longer = [len(other.cells) for other in sheet.rows[k + 1 : k + 6]]
            shift = int(bool(longer) and all(size == len(row.cells) + 1 for size in longer))
            return row, runs, shift
    return None


def _down_too(sheet: Sheet, rows: Sequence[Row], cells: Sequence[str], runs) -> bool:
    """Whether wavelengths go down the first column, so that those in the heading are names.

    Raises `InputError` where both may be meant, as in a map of excitation and emission.
    """
    first = np.array([value(row.cells[0]) or np.nan for row in rows])
    # The heading itself may be the first row of a table of numbers without one.
    at_head = value(cells[0])
    down = (
        first.size >= 8
        and np.isfinite(first).all()
        and abs(np.sign(np.diff(first)).sum()) == first.size - 1
        and first.min() <= 430.0
        and first.max() >= 680.0
        and first.min() > 100.0
    )
    if not down:
        return False
    # Names of columns that end in numbers, under a heading of wavelengths, are names.
    named = all(affix and unit_of(affix) is None for affix, _, _ in runs)
    if (at_head is not None or named) and (named or not heads_wavelengths(cells[0])):
        return True
    nm = np.concatenate([nm for _, _, nm in runs])
    raise InputError(
        f"{sheet.path}:{rows[0].line}",
        f"wavelengths stand in the heading ({nm.min():g}-{nm.max():g}) and down the first column",
        "give one spectrum per column, with names over them",
    )


def _labels(
    sheet: Sheet, rows: Sequence[Row], cells: Sequence[str], taken: set[int], first: int
) -> list[str]:
    """Return the name of each row: of the column that is headed as names, else its first text."""
    others = [k for k in range(len(cells)) if k not in taken][:_MOST_OTHERS]

    def column(k: int) -> list[str]:
        return [row.cells[k] if k < len(row.cells) else "" for row in rows]

    named = [k for k in others if _NAMES.fullmatch(cells[k].replace("_", " ").strip())]
    worded = [
        k
        for k in others
        if k not in named
        and not _NO_NAME.search(cells[k])
        and any(cell and value(cell) is None and not _dated(cell) for cell in column(k))
    ]
    order = [*sorted(named, key=lambda k: (_ids(cells[k]), k)), *worded]
    if not order:
        order = [k for k in others if k < first][:1]
    if not order:
        return [f"{sheet.path.stem} {k}" for k in range(1, len(rows) + 1)]
    labels = [cell or f"row {row.line}" for cell, row in zip(column(order[0]), rows, strict=True)]
    for k in order[1:]:
        if len(set(labels)) == len(labels):
            break
        alike = Counter(labels)
        more = column(k)
        if len(set(zip(labels, more, strict=True))) > len(alike):
            labels = [
                f"{label} {cell}" if alike[label] > 1 and cell else label
                for label, cell in zip(labels, more, strict=True)
            ]
    return labels


def _ids(head: str) -> bool:
    return head.casefold().replace("_", " ").endswith(("id", "ids"))


def _dated(cell: str) -> bool:
    return re.fullmatch(r"[\d/.:\- TZ]+( ?[ap]m)?", cell, re.IGNORECASE) is not None


def _values(row: Row, at: Sequence[int]) -> tuple[NDArray[np.float64], dict[int, str]]:
    """Return a row's numbers in these columns, and what else stands there."""
    numbers = np.full(len(at), np.nan)
    strange = {}
    for place, k in enumerate(at):
        cell = row.cells[k] if k < len(row.cells) else ""
        found = value(cell)
        if found is not None:
            numbers[place] = found
        elif cell:
            strange[place] = cell
    return numbers, strange


def _check_words(sheet: Sheet, rows: Sequence[Row], names, curves, words) -> None:
    """Raise for text among numbers of light."""
    lines = {plain(name): row.line for name, row in zip(names, rows, strict=False)}
    for number, strange in words.items():
        for place, cell in strange.items():
            nm = curves[number][0][place]
            if 380.0 <= nm <= 780.0:
                line = lines.get(plain(names[number]), rows[0].line)
                raise InputError(
                    f"{sheet.path}:{line}, {nm:g} nm",
                    f"'{plain(cell)[:40]}' is not a number",
                    "correct it",
                )
