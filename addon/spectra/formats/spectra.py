"""What the formats share: numbers in lines, units of wavelength, curves into one table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from .. import wavelengths as units
from ..curves import LIGHT, Table
from ..files import number
from ..merging import together, told_apart
from ..quantities import NOT_SAID, Said

__all__ = ["numbers", "table", "to_nm", "together"]

_NOT_TOLD = ("", "unknown", "index")


def numbers(path: Path, lines: Sequence[str], first: int, columns: int) -> NDArray[np.float64]:
    """Return rows of numbers, (k, columns), NaN where a line is empty.

    ``first``: the number of the first line in the file. Raises `InputError` that names the line
    which is not ``columns`` numbers.
    """
    rows = []
    for place, line in enumerate(lines, first):
        row = [number(cell) for cell in line.split()]
        if row and (len(row) != columns or None in row):
            raise InputError(
                f"{path}:{place}", f"'{line.strip()[:40]}' is not a measurement", "mend"
            )
        if row:
            rows.append(row)
    return np.array(rows, dtype=float).reshape(-1, columns)


def to_nm(path: Path, wavelengths: ArrayLike, unit: str = "") -> NDArray[np.float64]:
    """Return wavelengths in nm; without a ``unit`` they are µm where more are visible light then.

    Raises `InputError` for a unit that is no length.
    """
    found = np.asarray(wavelengths, dtype=float)
    name = unit.strip()
    told = None if name.casefold() in _NOT_TOLD else units.unit_of(name)
    if name.casefold() not in _NOT_TOLD and told in (None, units.INDEX):
        raise InputError(path, f"gives wavelengths in '{name[:40]}'", "give them in nm or µm")
    if told is not None:
        nm = units.to_nm(found, told)
        if told in (units.PER_CM, units.EV) and not ((nm > 100.0) & (nm < 1e5)).any():
            raise InputError(path, f"gives wavelengths in '{name[:40]}'", "give them in nm or µm")
        return nm
    low, high = LIGHT
    in_nm, in_um = (
        np.count_nonzero((found >= low / size) & (found <= high / size)) for size in (1.0, 1000.0)
    )
    return units.to_nm(found, units.UM if in_um > in_nm else units.NM)


def table(
    path: Path,
    names: Sequence[str],
    wavelengths: NDArray[np.float64],
    values: NDArray[np.float64],
    *,
    format: str = "table",
    unit: str | None = None,
    quantity: str | Sequence[str] = NOT_SAID,
    classes: Sequence[str] = (),
    lines: NDArray[np.int64] | None = None,
    notes: tuple[str, ...] = (),
) -> Table:
    """Return curves as a `Table` in order of wavelength, in which NaN is what was not measured.

    ``wavelengths`` [nm] (k,), ``values`` (k, m); the ``quantity`` of all or of each, the ``unit``
    of all. Names are told apart, for by them curves are chosen. Raises `InputError` for wavelengths
    that are none, or that stand in visible light twice.
    """
    bad = np.flatnonzero(~np.isfinite(wavelengths) | (wavelengths <= 0))
    if bad.size or not wavelengths.size:
        what = f"{wavelengths[bad[0]]:g}" if bad.size else "nothing"
        where = f"{path}:{lines[bad[0]]}" if bad.size and lines is not None else path
        raise InputError(where, f"{what} is not a wavelength", "correct or remove it")
    order = np.argsort(wavelengths, kind="stable")
    wavelengths, values = wavelengths[order], values[order]
    twice = np.diff(wavelengths) == 0
    visible = (wavelengths[1:] >= LIGHT[0]) & (wavelengths[1:] <= LIGHT[1])
    if (twice & visible).any():
        nm = wavelengths[1:][twice & visible][0]
        raise InputError(path, f"wavelength {nm:g} nm occurs twice", "remove one of the two")
    once = np.append(True, ~twice)
    each = (quantity,) * len(names) if isinstance(quantity, str) else quantity
    return Table(
        path=path,
        names=told_apart(names),
        wavelengths=wavelengths[once],
        values=values[once],
        lines=None if lines is None else lines[order][once],
        unsorted=False,
        said=tuple(Said(one, unit) for one in each),
        format=format,
        sparse=True,
        classes=tuple(classes),
        notes=notes,
    )
