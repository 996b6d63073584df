"""Spectra in columns, as they stand in a file: what every reader returns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .grid import WAVELENGTHS
from .quantities import Said

LARGEST_GAP = 20.0
"""[nm] between neighbouring samples inside `LIGHT`."""

LIGHT = (400.0, 700.0)
"""The range [nm] that holds 99.9 % of what the eye sees of sunlight."""

NEEDED = (420.0, 700.0)
"""The range [nm] that reflectances must cover: under it 0.4 % of what the eye sees is left, and
several published libraries begin there."""


class NoSpectra(InputError):
    """A file that is whole, but about something else than spectra."""


@dataclass(frozen=True)
class Table:
    """Columns of spectra as they stand in a file, rows in order of wavelength.

    ``wavelengths`` [nm] (k,), ``values`` (k, m), ``names`` (m column headers), ``lines`` (k line
    numbers in the file, for messages, None where it has no lines), ``unsorted`` (whether the rows
    had to be sorted), ``said`` (m: quantity and unit that the file tells of each column),
    ``format`` (what kind of file it is), ``sparse`` (whether NaN says that a spectrum has no value
    there, as in published libraries, and a broken spectrum spoils itself alone), ``classes`` (m:
    what kind of thing each is, or none), ``words`` (what stands where a number is missing, by line
    and column), ``notes`` (what was done to the data, a sentence each).
    """

    path: Path
    names: tuple[str, ...]
    wavelengths: NDArray[np.float64]
    values: NDArray[np.float64]
    lines: NDArray[np.int64] | None
    unsorted: bool
    said: tuple[Said, ...] = ()
    format: str = "table"
    sparse: bool = False
    classes: tuple[str, ...] = ()
    words: Mapping[tuple[int, str], str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.said:
            object.__setattr__(self, "said", (Said(),) * len(self.names))

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
            said=tuple(self.said[k] for k in chosen),
            classes=tuple(self.classes[k] for k in chosen) if self.classes else (),
        )

    def with_said(self, said: Sequence[Said]) -> Table:
        """Return the table of which the file says so of each column."""
        return replace(self, said=tuple(said))

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


def check_range(table: Table, needed: tuple[float, float] = NEEDED) -> None:
    """Check that a table covers the range ``needed`` [nm] without gaps in `LIGHT`.

    Raises `InputError` that names lines and column.
    """
    wavelengths = table.wavelengths
    if wavelengths.size < 2 or wavelengths[0] > needed[0] or wavelengths[-1] < needed[1]:
        span = f"{wavelengths[0]:g}-{wavelengths[-1]:g} nm" if wavelengths.size else "no light"
        if table.sparse or table.lines is None:
            place = table.place(None, 0)
        else:
            ends = f", lines {table.lines.min()}-{table.lines.max()}" if table.lines.size else ""
            place = f"{table.path}, wavelength column{ends}"
        raise InputError(
            place,
            f"covers {span}",
            f"measure at least {needed[0]:g}-{needed[1]:g} nm",
        )
    gaps = np.diff(wavelengths) * (wavelengths[1:] > LIGHT[0]) * (wavelengths[:-1] < LIGHT[1])
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
