"""Reflectances of materials, read from files of every format and brought to the grid."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..choices import listed
from ..errors import InputError, parameter
from . import formats
from .checks import UNITS, on_grid, percent_columns, reflectances_of
from .curves import NoSpectra, Table
from .grid import WAVELENGTHS


class Kind(NamedTuple):
    """What was read: the kind of file (``format``), the ``quantity``, empty where the file does not
    say it and it is taken for a reflectance, and the ``unit``."""

    format: str
    quantity: str
    unit: str

    def __str__(self) -> str:
        return f"{self.format}: {self.quantity or 'not said, taken for reflectance'}, {self.unit}"


@dataclass(frozen=True)
class Reflectances:
    """Reflectances of the materials in one file, on the grid.

    ``values`` (m, 81) in 0 to 1, ``names`` (m), ``unit`` as read (``percent`` or ``fraction``),
    ``notes`` (what was done to the data, a sentence each), ``measured``: from where to where [nm]
    the file has values; beyond, the grid holds those of the ends; ``classes`` (m: what kind of
    thing each is) or none; ``kinds`` (m: what was read of each); ``problems``: the spectra that
    cannot be used, and why.
    """

    path: Path
    names: tuple[str, ...]
    values: NDArray[np.float64]
    unit: str
    notes: tuple[str, ...]
    measured: tuple[float, float]
    classes: tuple[str, ...] = ()
    kinds: tuple[Kind, ...] = ()
    problems: Mapping[str, InputError] = field(default_factory=dict)


def read_reflectances(
    path: str | Path, unit: str | None = None, column: str | None = None
) -> Reflectances:
    """Read the reflectances of all materials in a file, or of the one that ``column`` names.

    Parameters
    ----------
    path
        The file: `formats.read` says which forms are understood.
    unit
        ``percent`` or ``fraction``; without it the format, the headers or what the file says around
        its numbers decide, and without a unit there the size of a column's own numbers: over 2 is
        percent, up to 1.05 a fraction.
    column
        The header of the one column that matters: errors in others are not looked for.

    Returns
    -------
    Reflectances on the grid. Rows outside 380-780 nm count only as the nearest neighbours of
    that range. Outside the measured range the end values are held, and ``notes`` says so. Of a
    published library the spectra that cannot be used are left out and told in ``notes``, as are
    columns of other things: counts, light, gloss. Absorbance, log(1/R) and K/S are converted.

    Raises
    ------
    InputError
        What `formats.read` raises, and: a largest value between 1.05 and 2 without a unit; NaN or
        values of -0.01 and less or over 1.05 (fluorescence); a gap over 20 nm inside 400-700 nm; a
        range that does not cover 420-700 nm; numbers that are no reflectance; no such column, or
        several. The message names line and column.
    """
    table = formats.read(path)
    read = _admitted(table, unit, column)
    if read.problems and (column is not None or not table.sparse or not read.names):
        raise next(iter(read.problems.values()))
    return read


def read_all(path: str | Path, unit: str | None = None) -> Reflectances:
    """Read a file as `read_reflectances` does, but leave out each spectrum that cannot be used.

    ``problems`` names these. Raises `InputError` only for what spoils the whole file.
    """
    return _admitted(formats.read(path), unit, None)


def _admitted(table: Table, unit: str | None, column: str | None) -> Reflectances:
    """Return of a table the reflectances, or the one that ``column`` names, that can be used."""
    if unit is not None and unit not in UNITS:
        raise InputError(parameter("unit"), f"'{unit}' is not a unit", f"choose {listed(UNITS)}")
    if column is not None:
        table = table.columns([_index(table, column)])
    as_read = dict(zip(table.names, table.said, strict=True))
    table, notes, refused = reflectances_of(table)
    if not table.names:
        raise NoSpectra(*next(iter(refused.values())).args)
    percent, how, unclear = percent_columns(table, unit)
    on = on_grid(table, percent)
    problems = {**on.problems, **unclear}
    good = [k for k in range(len(table.names)) if k not in problems]
    notes += how
    if refused:
        some = ", ".join(f"'{name}' ({as_read[name].quantity})" for name in list(refused)[:4])
        notes.append(f"left out because they are not reflectances: {some}")
    if table.unsorted:
        notes.append("the rows were sorted by wavelength")
    if on.over.size:
        notes.append(f"{on.over.size} value(s) over 1, at most {on.over.max():.3f}, were read as 1")
    if on.under.size:
        least = f"{on.under.min():.2g}"
        notes.append(f"{on.under.size} value(s) under 0, at least {least}, were read as 0")
    told = {table.names[k]: error for k, error in sorted(problems.items())}
    if told:
        first = next(iter(told.values()))
        notes.append(f"{len(told)} of {len(table.names)} spectra are left out, the first: {first}")
    table, percent = table.columns(good), percent[good]
    low, high = _measured(on.measured[good])
    if low > WAVELENGTHS[0] or high < WAVELENGTHS[-1]:
        notes.append(f"measured from {low:g} to {high:g} nm; the end values are held beyond")
    return Reflectances(
        path=table.path,
        names=table.names,
        values=on.values[good],
        unit=UNITS[0] if percent.all() else UNITS[1] if not percent.any() else "mixed",
        notes=(*table.notes, *notes),
        measured=(low, high),
        classes=table.classes,
        kinds=tuple(
            Kind(table.format, as_read[name].quantity, UNITS[0] if one else UNITS[1])
            for name, one in zip(table.names, percent, strict=True)
        ),
        problems=told,
    )


def _measured(ends: NDArray[np.float64]) -> tuple[float, float]:
    """Return from where to where [nm] columns have values together, of the ends (m, 2) of each."""
    if not len(ends):
        return float("nan"), float("nan")
    return float(ends[:, 0].max()), float(ends[:, 1].min())


def split_assignment(text: str) -> tuple[Path, str | None]:
    """Split ``FILE[:COLUMN]``; a colon that belongs to the path (``C:\\``) stays there.

    So does one in the name of a column where the file before it is there, and those of a set
    (``colour:BabelColor Average:dark skin``).
    """
    if formats.built_in.recognises(text):
        name, column = formats.built_in.split(text)
        return Path(name), column or None
    if _is_file(text):
        return Path(text), None
    for at in (k for k, character in enumerate(text) if character == ":" and k > 1):
        if _is_file(text[:at]) and text[at + 1 :]:
            return Path(text[:at]), text[at + 1 :]
    head, colon, tail = text.rpartition(":")
    # 'C:\bricks.csv' splits into a drive letter and a path: no column is that.
    if not colon or len(head) < 2 or "/" in tail or "\\" in tail:
        return Path(text), None
    return Path(head), tail


def _is_file(text: str) -> bool:
    try:
        return Path(text).exists()
    except (OSError, ValueError):  # too long a name, a NUL
        return False


def read_assigned(text: str, unit: str | None = None) -> tuple[str, NDArray[np.float64]]:
    """Read the one reflectance that ``FILE.csv[:COLUMN]`` names: its name and values (81,).

    Raises `InputError` as `read_one` does.
    """
    reflectances = read_one(text, unit)
    return reflectances.names[0], reflectances.values[0]


def read_one(text: str, unit: str | None = None, quantity: str = "") -> Reflectances:
    """Read the one reflectance that ``FILE.csv[:COLUMN]`` names, alone in its `Reflectances`.

    Of a glazing's file the ``quantity`` is read, such as `formats.igsdb.TRANSMITTANCE`, where no
    column is named. Raises `InputError` where the file has many columns and none is named, and as
    `read_reflectances` does.
    """
    path, column = split_assignment(text)
    if quantity and column is None:
        column = column_of(path, quantity)
    reflectances = read_reflectances(path, unit, column)
    if len(reflectances.names) > 1:
        raise InputError(
            path,
            f"holds {len(reflectances.names)} materials",
            f"choose a column, as in {path.name}:{reflectances.names[0]}",
        )
    return reflectances


def column_of(path: str | Path, quantity: str) -> str | None:
    """Return the one column of a glazing's file that holds a quantity, None without.

    Raises `InputError` as `formats.read` does.
    """
    table = formats.read(path)
    kinds = zip(table.names, table.classes, strict=False)  # no classes, no choice
    fitting = [name for name, kind in kinds if kind.endswith(quantity)]
    return fitting[0] if len(fitting) == 1 else None


def reflectance_hash(values: NDArray[np.float64]) -> str:
    """Return a short stable fingerprint of a reflectance on the grid."""
    return hashlib.sha256(np.round(values, 9).astype("<f8").tobytes()).hexdigest()[:16]


def _index(table: Table, column: str) -> int:
    """Return where the one column of this name stands."""
    if table.names.count(column) > 1:
        raise InputError(table.path, f"several columns are named '{column}'", "rename them")
    if column not in table.names:
        folded = [" ".join(name.split()) for name in table.names]
        if folded.count(" ".join(column.split())) == 1:
            return folded.index(" ".join(column.split()))
        some = ", ".join(f"'{name}'" for name in table.names[:8])
        more = f" and {len(table.names) - 8} more" if len(table.names) > 8 else ""
        raise InputError(table.path, f"no column '{column}'", f"there are {some}{more}")
    return table.names.index(column)
