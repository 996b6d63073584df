"""What stands over a block of numbers: names, quantities and units of its columns."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from .cells import Row, Sheet, split, value
from .quantities import said
from .wavelengths import heads_index, heads_wavelengths

_MOST = 4
"""Lines of headings."""

_ABOUT = re.compile(
    r"date|time|user|operator|instrument|serial|datum|zeit|benutzer|gerät|fecha|data\b|heure",
    re.IGNORECASE,
)
"""What a line tells that names no samples."""

_VISTA = ["Wavelength (nm)", "Radiance of the reference", "Radiance of the target", "Reflectance %"]
"""Columns of Spectra Vista's ``.sig`` files, which do not name them."""


@dataclass(frozen=True)
class Heads:
    """Headings of all columns: ``names`` and all ``texts`` over each; numbers of the columns of
    ``wavelengths``; whether there are headings (``named``), in which ``line``, and whether they say
    that the first column is something else than a wavelength (``wrong``)."""

    names: list[str]
    texts: list[str]
    wavelengths: list[int] = field(default_factory=list)
    named: bool = False
    wrong: bool = False
    line: int = 1


def heads_of(sheet: Sheet, start: int, rows: Sequence[Row]) -> Heads:
    """Return the headings of a block of ``rows`` that begins with row ``start`` of a sheet."""
    width = len(rows[0].cells) if rows else len(sheet.rows[0].cells)
    grid = _above(sheet, start, width, rows)
    main = next((k for k, (_, cells) in enumerate(grid) if _of_wavelengths(cells)), None)
    if main is None:
        return _without(sheet, start, rows, grid, width)
    while main + 1 < len(grid) and _of_wavelengths(grid[main + 1][1]):
        main += 1  # units stand under their quantities
    line, cells = grid[main]
    shift = _shift(cells, rows)
    below = [_padded(row, width, shift) for _, row in reversed(grid[:main])]
    head = _padded(cells, width, shift)
    width = max(width, len(head)) if len(head) > width else len(head)
    at = [k for k in range(width) if heads_wavelengths(head[k])]
    over = [""] * width
    for _, row in grid[main + 1 :]:  # the nearest that names samples
        named = _spread(_padded(row, width, shift), at)
        if len(named) == width and not _ABOUT.match(row[0]):
            over = [one or other for one, other in zip(over, named, strict=True)]
    texts, names = [], []
    for k in range(width):
        under = [row[k] for row in below if k < len(row) and row[k]]
        texts.append(" ".join(word for word in (head[k], *under) if word))
        names.append(_name(head[k], over[k], under))
    return Heads(_unlike(names, texts), texts, at, True, False, line)


def _above(
    sheet: Sheet, start: int, width: int, rows: Sequence[Row]
) -> list[tuple[int, list[str]]]:
    """Return lines and cells of what can be headings, the lowest first."""
    found: list[tuple[int, list[str]]] = []
    for row in sheet.rows[max(start - _MOST, 0) : start][::-1]:
        cells = _fitting(row, sheet.separator, width)
        if len(cells) < 2 and row.told < 2:
            break
        found.append((row.line, cells))
    if not any(_of_wavelengths(cells) for _, cells in found) and rows:
        comments = [text for line, text in sheet.comments if line < rows[0].line]
        if comments:
            cells = split(comments[-1].lstrip("#! \t"), sheet.separator)
            while cells and not cells[-1]:
                cells.pop()
            if len(cells) == width and _of_wavelengths(cells):
                line = next(line for line, text in sheet.comments if text == comments[-1])
                return [(line, cells)]
    return found


def _fitting(row: Row, separator: str, width: int) -> list[str]:
    """Return the cells of a heading; where blanks separate, names may hold single ones."""
    if separator != " " or len(row.cells) == width:
        return row.cells
    wide = [cell for cell in re.split(r"\s{2,}|\t", row.text.strip()) if cell]
    return wide if len(wide) == width else row.cells


def _of_wavelengths(cells: Sequence[str]) -> bool:
    return any(heads_wavelengths(cell) for cell in cells)


def _shift(cells: Sequence[str], rows: Sequence[Row]) -> int:
    """Return 1 where rows have a name that their heading does not name, as R writes them."""
    some = rows[:50]
    if not some or any(len(row.cells) != len(cells) + 1 for row in some):
        return 0
    first = [value(row.cells[0]) for row in some]
    counted = any(first == [float(k) for k in range(n, n + len(some))] for n in (0, 1))
    return int(counted or all(number is None for number in first))


def _padded(cells: Sequence[str], width: int, shift: int) -> list[str]:
    row = [""] * shift + list(cells)
    return row + [""] * (width - len(row))


def _spread(over: list[str], at: Sequence[int]) -> list[str]:
    """Return headings over pairs of columns: one over the wavelengths names what follows them."""
    if len(at) < 2 and not (len(at) == 1 and len(over) == 2 and over[0] and not over[1]):
        return over
    spread, last = list(over), ""
    for k, cell in enumerate(over):
        last = cell if cell or k in at else last
        spread[k] = cell or last
    return spread


def _name(head: str, over: str, under: Sequence[str]) -> str:
    """Return a column's name: what does not merely say a quantity or unit, the nearest first."""
    if over and (not head or _pure(head)) and not _pure(over) and value(over) is None:
        return over
    if head and not (_pure(head) and under and not all(map(_pure, under))):
        return head
    return next((word for word in under if not _pure(word)), head or next(iter(under), ""))


def _pure(text: str) -> bool:
    """Whether a heading only says what is measured, or in what unit."""
    found = said(text)
    return bool(found.quantity or found.unit) or text in ("-", "1", "[1]", "[-]")


def _unlike(names: list[str], texts: Sequence[str]) -> list[str]:
    """Return names, with all that stands over a column where it is needed to tell two apart."""
    alike = {name for name, count in Counter(names).items() if count > 1}
    return [
        f"{name} {text}" if name in alike and text and text != name else name
        for name, text in zip(names, texts, strict=True)
    ]


def _without(
    sheet: Sheet,
    start: int,
    rows: Sequence[Row],
    grid: Sequence[tuple[int, list[str]]],
    width: int,
) -> Heads:
    """Return what is known where no heading names wavelengths."""
    stem = sheet.path.stem
    names = [stem if width <= 2 else f"{stem} {k}" for k in range(width)]
    blank = Heads(names, [""] * width, line=rows[0].line if rows else 1)
    if width == len(_VISTA) and "Spectra Vista" in sheet.rows[0].text:
        return Heads(_VISTA, _VISTA, [0], True, False, blank.line)
    if not rows or not grid:
        return _free(sheet, start, blank, width)
    line, cells = grid[0]
    shift = _shift(cells, rows)
    head = _padded(cells, width, shift)
    if any(value(cell) is not None for cell in head[1:2]) or len(head) > width:
        return _free(sheet, start, blank, width)
    if heads_index(head[0]):
        return Heads(
            [h or n for h, n in zip(head, names, strict=True)], head, [], True, False, line
        )
    # The one heading of a table says what its first column is; of many lines, none need be it.
    if sheet.separator != " " and (start == 1 or len(cells) > 2):
        return Heads(head, head, [], True, True, line)
    return _free(sheet, start, blank, width)


def _free(sheet: Sheet, start: int, blank: Heads, width: int) -> Heads:
    """Return the heading of two columns whose words cannot be told apart by blanks."""
    if width != 2 or not start:
        return blank
    text = sheet.rows[start - 1].text
    words = text.split()
    told = next(
        (n for n in range(min(len(words), 4), 0, -1) if heads_wavelengths(" ".join(words[:n]))), 0
    )
    if not told or len(words) == told:
        return blank
    rest = " ".join(words[told:])
    return Heads(
        ["", rest], [" ".join(words[:told]), rest], [0], True, False, sheet.rows[start - 1].line
    )
