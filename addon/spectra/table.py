"""Text tables of spectra: a wavelength column and further columns, as people publish them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .grid import WAVELENGTHS

LONGEST_LINE = 1 << 22
"""Characters: 100,000 columns fit; a longer line is no table of spectra."""

LARGEST_FILE = 1 << 28
"""Characters."""

LARGEST_GAP = 20.0
"""[nm] between neighbouring samples inside `NEEDED`."""

NEEDED = (400.0, 700.0)
"""The range [nm] that spectra must cover: 99.9 % of what the eye sees of sunlight."""

_WAVELENGTH_HEADERS = re.compile(
    r"(wave ?lengths?|wave|wvl?|wl|lambda|λ|nanomet(er|re)s?|nm|wellenlänge|longueur d.onde)?"
    r"( ?(nm|nanomet(er|re)s?))?"
)
_MICROMETRES = re.compile(r"\b(um|µm|μm|micron|micromet)", re.IGNORECASE)


class NoSpectra(InputError):
    """A file that is whole, but about something else than spectra."""


@dataclass(frozen=True)
class Table:
    """Columns of spectra as they stand in a file, rows in order of wavelength.

    ``wavelengths`` [nm] (k,), ``values`` (k, m), ``names`` (m column headers), ``lines`` (k line
    numbers in the file, for messages, None where it has no lines), ``unsorted`` (whether the rows
    had to be sorted), ``unit`` (``percent`` or ``fraction`` where the format itself says so),
    ``sparse`` (whether NaN says that a spectrum has no value there, as in published libraries, and
    a broken spectrum spoils itself alone), ``classes`` (m: what kind of thing each is, or none),
    ``notes`` (what was done to the data, a sentence each).
    """

    path: Path
    names: tuple[str, ...]
    wavelengths: NDArray[np.float64]
    values: NDArray[np.float64]
    lines: NDArray[np.int64] | None
    unsorted: bool
    unit: str | None = None
    sparse: bool = False
    classes: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def place(self, row: int | None = None, column: int | None = None) -> str:
        """Return where something stands, for messages: file, line or wavelength, column."""
        named = "" if column is None else f", column '{self.names[column]}'"
        if row is None:
            return f"{self.path}{named}"
        if self.lines is None:
            return f"{self.path}{named}, {self.wavelengths[row]:g} nm"
        return f"{self.path}:{self.lines[row]}{named}"

    def columns(self, chosen: Sequence[int] | NDArray[np.int64]) -> Table:
        """Return the columns of these numbers alone."""
        return replace(
            self,
            names=tuple(self.names[k] for k in chosen),
            values=self.values[:, chosen],
            classes=tuple(self.classes[k] for k in chosen) if self.classes else (),
        )

    def rows(self, chosen: slice | NDArray[np.bool_]) -> Table:
        """Return these rows alone."""
        return replace(
            self,
            wavelengths=self.wavelengths[chosen],
            values=self.values[chosen],
            lines=None if self.lines is None else self.lines[chosen],
        )

    def visible(self) -> Table:
        """Return the rows that the grid sees, and the nearest on either side."""
        first = max(np.searchsorted(self.wavelengths, WAVELENGTHS[0], side="right") - 1, 0)
        last = np.searchsorted(self.wavelengths, WAVELENGTHS[-1], side="left") + 1
        return self.rows(slice(first, last))


def read_table(path: str | Path) -> Table:
    """Read a table of spectra.

    Comma, semicolon or tab between columns; decimal commas with the latter two; ``#`` comments;
    UTF-8 with or without a byte-order mark, UTF-16 with one, else Latin-1. The first column is
    the wavelength in nm; a header is optional, empty cells read as NaN.

    Raises
    ------
    InputError
        A file that is missing, empty, binary, larger than 256 MiB or with a line over 4 MiB; a
        first column that is not a wavelength in nm; text for numbers; rows of unequal length;
        no further column; a wavelength that is not finite, not above 0, or there twice.
    """
    path = Path(path)
    rows = _rows(path)
    if not rows:
        raise InputError(path, "holds no data", "give a wavelength column and a reflectance column")
    separator = _separator(rows[0][1])
    decimal_comma = separator != ","
    number, first = rows[0]
    cells = [cell.strip().strip('"').strip() for cell in first.split(separator)]
    if _number(cells[0], decimal_comma) is None:
        _check_wavelength_header(path, number, cells[0])
        names, rows = cells[1:], rows[1:]
        # A trailing separator makes an empty last column.
        while names and not names[-1]:
            names.pop()
    else:
        if any(cell and _number(cell, decimal_comma) is None for cell in cells[1:]):
            raise NoSpectra(
                f"{path}:{number}",
                "is neither a header nor a row of numbers",
                "begin with a header: wavelength_nm and a name for each column",
            )
        names = [path.stem if len(cells) == 2 else f"{path.stem} {k}" for k in range(1, len(cells))]
    if not names:
        raise InputError(
            f"{path}:{number}",
            "there is a wavelength column but no other",
            "add a column, separated by comma, semicolon or tab",
        )
    if not rows:
        raise InputError(path, "there is a header but no row of numbers", "add the measured values")
    data = np.array([_parse(path, row, separator, decimal_comma, names) for row in rows])
    lines = np.array([row[0] for row in rows])
    order = np.argsort(data[:, 0], kind="stable")
    wavelengths = data[order, 0]
    _check_wavelengths(path, wavelengths, lines[order])
    return Table(
        path=path,
        names=tuple(names),
        wavelengths=wavelengths,
        values=data[order, 1:],
        lines=lines[order],
        unsorted=bool(np.any(np.diff(order) < 0)),
    )


def check_range(table: Table) -> None:
    """Check that a table covers 400-700 nm without gaps; `InputError` names lines and column."""
    wavelengths = table.wavelengths
    if wavelengths.size < 2 or wavelengths[0] > NEEDED[0] or wavelengths[-1] < NEEDED[1]:
        span = f"{wavelengths[0]:g}-{wavelengths[-1]:g} nm" if wavelengths.size else "no light"
        if table.sparse or table.lines is None:
            place = table.place(None, 0)
        else:
            first, last = table.lines.min(initial=0), table.lines.max(initial=0)
            place = f"{table.path}, wavelength column, lines {first}-{last}"
        raise InputError(
            place,
            f"covers {span}",
            f"measure at least {NEEDED[0]:g}-{NEEDED[1]:g} nm",
        )
    gaps = np.diff(wavelengths) * (wavelengths[1:] > NEEDED[0]) * (wavelengths[:-1] < NEEDED[1])
    k = int(np.argmax(gaps))
    if gaps[k] > LARGEST_GAP:
        column = (
            table.place(k + 1, 0) if table.sparse else f"{table.place(k + 1)}, wavelength column"
        )
        raise InputError(
            column,
            f"a gap from {wavelengths[k]:g} to {wavelengths[k + 1]:g} nm",
            f"measure at least every {LARGEST_GAP:g} nm",
        )


def _rows(path: Path) -> list[tuple[int, str]]:
    """Return line number and text of all lines that are neither empty nor comment."""
    try:
        with path.open("rb") as handle:
            start = handle.read(4096)
        if b"\0" in start and not start.startswith((b"\xff\xfe", b"\xfe\xff")):
            raise NoSpectra(path, "is binary, not text", "export it as CSV")
        rows = []
        read = 0
        with path.open(encoding=_encoding(path, start), errors="replace", newline=None) as handle:
            number = 0
            while line := handle.readline(LONGEST_LINE):
                number += 1
                read += len(line)
                if len(line) == LONGEST_LINE and not line.endswith("\n"):
                    raise InputError(
                        f"{path}:{number}",
                        f"the line is longer than {LONGEST_LINE >> 20} MiB",
                        "put one wavelength on each line",
                    )
                if read > LARGEST_FILE:
                    raise InputError(
                        f"{path}:{number}", "more than 256 MiB of text", "split the file"
                    )
                if line.strip() and not line.lstrip().startswith("#"):
                    rows.append((number, line.rstrip("\r\n")))
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "check the path") from error
    return rows


def _encoding(path: Path, start: bytes) -> str:
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        with path.open(encoding="utf-8") as handle:
            handle.read(LONGEST_LINE)
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _separator(line: str) -> str:
    return next((character for character in (";", "\t") if character in line), ",")


def _number(text: str, decimal_comma: bool) -> float | None:
    try:
        return float(text.replace(",", ".") if decimal_comma else text)
    except ValueError:
        return None


def _check_wavelength_header(path: Path, number: int, header: str) -> None:
    if _MICROMETRES.search(header):
        raise InputError(
            f"{path}:{number}", f"'{header}' is in micrometres", "give wavelengths in nm"
        )
    plain = re.sub(r"[\s_()\[\]/,.:-]+", " ", header).strip().casefold()
    if not _WAVELENGTH_HEADERS.fullmatch(plain):
        raise NoSpectra(
            f"{path}:{number}",
            f"the first column is '{header}', not a wavelength",
            "put the wavelength first and name it wavelength_nm",
        )


def _parse(
    path: Path, row: tuple[int, str], separator: str, decimal_comma: bool, names: list[str]
) -> list[float]:
    number, line = row
    cells = line.split(separator)
    columns = ["wavelength", *names]
    while len(cells) > len(columns) and not cells[-1].strip():
        cells.pop()
    if len(cells) != len(columns):
        raise InputError(
            f"{path}:{number}",
            f"{len(cells)} columns where the first line has {len(columns)}",
            "make every row as long as the first"
            + ("" if decimal_comma else "; with decimal commas separate by semicolons"),
        )
    values = []
    for column, cell in zip(columns, cells, strict=True):
        text = cell.strip().strip('"').strip()
        value = _number(text, decimal_comma) if text else float("nan")
        if value is None:
            raise InputError(
                f"{path}:{number}, column '{column}'", f"'{text[:40]}' is not a number", "mend it"
            )
        values.append(value)
    return values


def _check_wavelengths(path: Path, wavelengths: NDArray, lines: NDArray) -> None:
    """Check wavelengths in ascending order (NaN last) against what nanometres can be."""
    bad = np.flatnonzero(~np.isfinite(wavelengths) | (wavelengths <= 0))
    if bad.size:
        raise InputError(
            f"{path}:{lines[bad[0]]}",
            f"{wavelengths[bad[0]]:g} is not a wavelength",
            "give wavelengths in nm",
        )
    if wavelengths[-1] < 50:
        raise InputError(
            f"{path}:{lines[-1]}",
            f"the largest wavelength is {wavelengths[-1]:g}: micrometres",
            "multiply the first column by 1000: wavelengths are in nm",
        )
    twice = np.flatnonzero(np.diff(wavelengths) == 0)
    if twice.size:
        k = twice[0]
        raise InputError(
            f"{path}:{max(lines[k], lines[k + 1])}",
            f"wavelength {wavelengths[k]:g} nm stands on line {min(lines[k], lines[k + 1])} too",
            "remove one of the rows",
        )
