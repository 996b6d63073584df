"""Complex refractive indices n + ik of matter, read from the files that people publish."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .curves import LIGHT
from .files import content, number
from .grid import WAVELENGTHS, resample
from .wavelengths import NM, UM, to_nm

LARGEST_GAP = 100.0
"""[nm] between neighbouring samples of visible light: tables by photon energy are that coarse."""

_LARGEST_FILE = 1 << 24
"""Bytes."""

_LARGEST = 1000.0
"""No n or k of visible light is larger."""


def read_nk(path: str | Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read n and k of one matter, each (81,).

    Columns wavelength, n and k, separated by comma, semicolon, tab or spaces, with a decimal comma
    where semicolons or tabs separate; or two tables below one another, wavelength and n, wavelength
    and k: so does refractiveindex.info write CSV, text, and its database's own records. The unit is
    nm, or µm where more samples are visible light then. Without k it is 0: a clear dielectric.
    Between samples both are monotone cubics; outside them the end values are held.

    Raises
    ------
    InputError
        A file that cannot be read, is larger than 16 MiB, or holds no such table; values that are
        not finite, an n not over 0, a k under 0; a wavelength that stands there twice; samples that
        do not cover 400-700 nm or have a gap of over 100 nm there; a record with a formula for n.
    """
    path = Path(path)
    lines = content(path, _LARGEST_FILE).decode("utf-8-sig", "replace").split("\n")
    if any(re.match(r"[\s-]{0,80}type:\s{0,80}formula", line) for line in lines):
        raise InputError(path, "gives n as a formula", "take the CSV file of the same page")
    first, *further = _tables(lines)
    n = _on_grid(path, "n", first, 1)
    if first.shape[1] > 2:
        return n, _on_grid(path, "k", first, 2)
    return n, _on_grid(path, "k", further[0], 1) if further else np.zeros_like(n)


def _tables(lines: list[str]) -> list[NDArray[np.float64]]:
    """Return the tables of numbers in lines, (rows, columns) each; an empty one if there are none.

    A line that is not all numbers, or that has another count of them, ends a table.
    """
    tables: list[list[list[float]]] = [[]]
    for line in lines:
        numbers = _numbers(line)
        if tables[-1] and len(numbers) != len(tables[-1][0]):
            tables.append([])
        if len(numbers) >= 2:
            tables[-1].append(numbers)
    return [np.array(table) for table in tables if table] or [np.zeros((0, 2))]


def _numbers(line: str) -> list[float]:
    """Return the numbers of a line, none where anything else stands in it."""
    if ";" in line or "\t" in line:
        cells = line.replace("\t", ";").split(";")
    else:
        cells = line.replace(",", " ").split()
    found = [number(cell.strip()) for cell in cells if cell.strip()]
    numbers = [one for one in found if one is not None]
    return numbers if len(numbers) == len(found) else []


def _on_grid(path: Path, name: str, table: NDArray, column: int) -> NDArray[np.float64]:
    wavelengths, values = table[:, 0], table[:, column]
    if wavelengths.size < 2:
        raise InputError(path, "holds no table of n and k", "give the columns wavelength, n, k")
    if not np.isfinite(wavelengths).all() or wavelengths.min() <= 0:
        raise InputError(path, "contains values that are not finite", "correct or remove the row")
    low, high = LIGHT
    in_nm, in_um = (
        np.count_nonzero((wavelengths >= low / size) & (wavelengths <= high / size))
        for size in (1.0, 1000.0)
    )
    wavelengths = to_nm(wavelengths, UM if in_um > in_nm else NM)
    order = np.argsort(wavelengths)
    wavelengths, values = wavelengths[order], values[order]
    # What the grid cannot see, all but the nearest on either side, may be as it likes.
    start = max(np.searchsorted(wavelengths, WAVELENGTHS[0], side="right") - 1, 0)
    seen = slice(start, np.searchsorted(wavelengths, WAVELENGTHS[-1]) + 1)
    wavelengths, values = wavelengths[seen], values[seen]
    if wavelengths.size < 2 or wavelengths[0] > low or wavelengths[-1] < high:
        raise InputError(path, f"does not cover {low:g}-{high:g} nm", "take another measurement")
    twice = np.flatnonzero(np.diff(wavelengths) == 0)
    if twice.size:
        where = f"{wavelengths[twice[0]]:g} nm"
        raise InputError(path, f"{where} occurs twice", "remove one of the rows")
    if not np.isfinite(values).all():
        raise InputError(path, "contains values that are not finite", "correct or remove the row")
    if values.max() > _LARGEST:
        raise InputError(
            path, f"{name} is {values.max():g}", f"correct it: none is over {_LARGEST:g}"
        )
    if values.min() < 0 or (name == "n" and values.min() <= 0):
        raise InputError(
            path, f"{name} is {values.min():g}", "correct it: n is over 0, k at least 0"
        )
    gap = (np.diff(wavelengths) * (wavelengths[1:] > low) * (wavelengths[:-1] < high)).max()
    if gap > LARGEST_GAP:
        raise InputError(
            path, f"a gap of {gap:.0f} nm", f"give a value every {LARGEST_GAP:g} nm at least"
        )
    return resample(wavelengths, values)
