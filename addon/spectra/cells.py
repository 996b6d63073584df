"""Lines of a text as rows of cells: which character separates them, which rows are numbers."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from .files import LONGEST_NUMBER, number, streamed

SEPARATORS = ("\t", ";", ",", " ")
"""In the order of preference; a blank stands for any run of blanks."""

_MISSING = (
    "na n/a nan nil null none n.a. - -- --- . * ** *** ? inf -inf infinity -infinity nd n.d. "
    "#n/a #na #nv #div/0! #value! #wert! #ref! #num! #zahl! missing"
)
MISSING = frozenset(_MISSING.split(" "))
"""What stands where nothing was measured, in small letters."""

_LOOKED_AT = (4000, 1 << 20)
"""Lines and characters that the separator is chosen by."""

_QUOTED_LINES = 8
"""Lines that a quoted cell may reach over, as a heading with line breaks does."""


@dataclass(frozen=True)
class Row:
    """A line's ``cells``, without blanks around them; ``line``: its number, ``text``: itself.

    ``told``: how many cells there are with the empty ones at the end.
    """

    line: int
    text: str
    cells: list[str]
    told: int


@dataclass(frozen=True)
class Sheet:
    """A text as rows of cells; comments (``#``) apart, in ``comments`` (line, text)."""

    path: Path
    separator: str
    rows: list[Row]
    comments: list[tuple[int, str]]


def read_sheet(path: Path) -> Sheet:
    """Read a text as rows of cells. Raises `InputError` as `files.streamed` does."""
    lines, comments = [], []
    for line, text in _whole(streamed(path)):
        if text.lstrip().startswith("#"):
            comments.append((line, text.strip()))
        else:
            lines.append((line, text))
    separator = _separator([text for _, text in lines])
    rows = []
    for line, text in lines:
        cells = split(text, separator)
        told = len(cells)
        while cells and not cells[-1]:
            cells.pop()
        if cells:
            rows.append(Row(line, text, cells, told))
    return Sheet(path, separator, rows, comments)


def _whole(lines: Iterable[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Join lines of which a quoted cell holds the break."""
    kept: list[tuple[int, str]] = []
    for line, text in lines:
        if kept:
            kept.append((line, text))
            if text.count('"') % 2:
                yield kept[0][0], " ".join(text for _, text in kept)
                kept = []
            elif len(kept) > _QUOTED_LINES:  # a quotation mark alone means nothing
                yield from kept
                kept = []
        elif text.count('"') % 2:
            kept = [(line, text)]
        else:
            yield line, text
    yield from kept


def split(text: str, separator: str) -> list[str]:
    """Return a line's cells, quotes and blanks around them taken off."""
    if '"' in text:
        try:
            (cells,) = csv.reader([text], delimiter=separator, skipinitialspace=True, strict=False)
        except (csv.Error, ValueError):  # an endless cell
            cells = text.replace('"', "").split(separator)
        if separator == " ":
            cells = [cell for cell in cells if cell]
    elif separator == " ":
        cells = text.split()
    else:
        cells = text.split(separator)
    return [cell.strip().strip('"').strip() for cell in cells]


def is_number(cell: str) -> bool:
    """Whether a cell is a number, also with a sign of percent."""
    return value(cell) is not None


def value(cell: str) -> float | None:
    """Return the number in a cell, also in percent (``5.1%`` is 5.1), NaN where it is missing.

    None where there is anything else.
    """
    try:
        if len(cell) <= LONGEST_NUMBER and "_" not in cell:
            return float(cell)
    except ValueError:
        pass
    if not cell:
        return None
    found = number(cell.removesuffix("%"))
    if found is None and cell.casefold() in MISSING:
        return float("nan")
    return found


def _separator(texts: Sequence[str]) -> str:
    """Return the separator with which most rows are numbers, the first of those alike."""
    sample, size = [], 0
    for text in texts[: _LOOKED_AT[0]]:
        size += len(text)
        if size > _LOOKED_AT[1] and len(sample) > 20:
            break
        sample.append(text)
    scores = {separator: _score(sample, separator) for separator in SEPARATORS}
    best = max(scores.values())
    # A heading decides where no row is of numbers.
    if best == (0, 0):
        head = sample[0] if sample else ""
        return next((separator for separator in SEPARATORS[:3] if separator in head), ",")
    for separator in SEPARATORS:
        if scores[separator][0] >= 0.9 * best[0] and (best[0] or scores[separator] == best):
            return separator
    return ","


def _score(texts: Sequence[str], separator: str) -> tuple[int, int]:
    """Return how many lines begin with a number and have another, and how many begin with one."""
    whole = begun = 0
    for text in texts:
        if separator != " " and separator not in text:
            continue
        cells = split(text, separator)[:64]
        if len(cells) < 2:
            continue
        first = sum(map(is_number, cells))
        if first >= 2 and 2 * first >= sum(map(bool, cells)):
            whole += 1
        elif is_number(cells[0]) and cells[0] and any(cells[1:]):
            begun += 1
    return whole, begun
