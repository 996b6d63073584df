"""What the formats share: text of a file, curves into one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ..table import NEEDED, Table

LARGEST_FILE = 1 << 26
"""Bytes of a text: the largest published ones have a few million."""


def content(path: Path, largest: int = LARGEST_FILE) -> bytes:
    """Return a file's bytes; `InputError` where it cannot be read or is larger than ``largest``."""
    try:
        if path.stat().st_size > largest:
            raise InputError(path, f"is larger than {largest >> 20} MiB", "split the file")
        return path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "check the path") from error


def text(path: Path) -> str:
    """Return a file's text: UTF-16 with a byte-order mark, UTF-8, else Latin-1."""
    found = content(path)
    if found.startswith((b"\xff\xfe", b"\xfe\xff")):
        return found.decode("utf-16", errors="replace")
    try:
        return found.decode("utf-8-sig")
    except UnicodeDecodeError:
        return found.decode("latin-1")


def numbers(path: Path, lines: Sequence[str], first: int, columns: int) -> NDArray[np.float64]:
    """Return rows of numbers, (k, columns), NaN where a line is empty.

    ``first``: the number of the first line in the file. Raises `InputError` that names the line
    which is not ``columns`` numbers.
    """
    try:
        return np.array([float(cell) for cell in " ".join(lines).split()]).reshape(-1, columns)
    except ValueError:
        pass
    rows = []
    for number, line in enumerate(lines, first):
        try:
            rows.append([float(cell) for cell in line.split()])
        except ValueError:
            rows.append([])
        if line.strip() and len(rows[-1]) != columns:
            raise InputError(f"{path}:{number}", f"'{line.strip()[:40]}' is no measurement", "mend")
    return np.array([row for row in rows if row]).reshape(-1, columns)


def to_nm(path: Path, wavelengths: ArrayLike, unit: str = "") -> NDArray[np.float64]:
    """Return wavelengths in nm; without a ``unit`` they are µm where more are visible light then.

    Raises `InputError` for a unit that is no length.
    """
    found = np.asarray(wavelengths, dtype=float)
    name = unit.strip().casefold()
    if name.startswith(("micro", "um", "µm", "μm")):
        return found * 1000.0
    if name.startswith(("nano", "nm")):
        return found
    if name and name not in ("unknown", "index"):
        raise InputError(path, f"gives wavelengths in '{unit.strip()}'", "give them in nm or µm")
    low, high = NEEDED
    in_nm, in_um = (
        np.count_nonzero((found >= low / size) & (found <= high / size)) for size in (1.0, 1000.0)
    )
    return found * (1000.0 if in_um > in_nm else 1.0)


def together(
    path: Path, curves: Iterable[tuple[NDArray[np.float64], NDArray[np.float64]]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the wavelengths (k,) of all curves and their values (k, m), NaN where one has none.

    ``curves``: wavelengths and values, (n,) each, of every curve. Raises `InputError` for one that
    has a wavelength twice.
    """
    found = list(curves)
    for x, _ in found:
        if np.unique(x).size < x.size:
            raise InputError(path, "a wavelength stands there twice", "remove one of the two")
    everywhere = np.unique(np.concatenate([x for x, _ in found]))
    values = np.full((everywhere.size, len(found)), np.nan)
    for column, (x, y) in enumerate(found):
        values[np.searchsorted(everywhere, x), column] = y
    return everywhere, values


def table(
    path: Path,
    names: Sequence[str],
    wavelengths: NDArray[np.float64],
    values: NDArray[np.float64],
    *,
    unit: str | None = None,
    classes: Sequence[str] = (),
    lines: NDArray[np.int64] | None = None,
    notes: tuple[str, ...] = (),
) -> Table:
    """Return curves as a `Table` in order of wavelength, in which NaN is what was not measured.

    ``wavelengths`` [nm] (k,), ``values`` (k, m). Names are told apart, for by them curves are
    chosen. Raises `InputError` for wavelengths that are none, or that stand in visible light twice.
    """
    bad = np.flatnonzero(~np.isfinite(wavelengths) | (wavelengths <= 0))
    if bad.size or not wavelengths.size:
        what = f"{wavelengths[bad[0]]:g}" if bad.size else "nothing"
        where = f"{path}:{lines[bad[0]]}" if bad.size and lines is not None else path
        raise InputError(where, f"{what} is not a wavelength", "mend or remove it")
    order = np.argsort(wavelengths, kind="stable")
    wavelengths, values = wavelengths[order], values[order]
    twice = np.diff(wavelengths) == 0
    visible = (wavelengths[1:] >= NEEDED[0]) & (wavelengths[1:] <= NEEDED[1])
    if (twice & visible).any():
        nm = wavelengths[1:][twice & visible][0]
        raise InputError(path, f"wavelength {nm:g} nm stands there twice", "remove one of the two")
    once = np.append(True, ~twice)
    return Table(
        path=path,
        names=_told_apart(names),
        wavelengths=wavelengths[once],
        values=values[once],
        lines=None if lines is None else lines[order][once],
        unsorted=False,
        unit=unit,
        sparse=True,
        classes=tuple(classes),
        notes=notes,
    )


def _told_apart(names: Sequence[str]) -> tuple[str, ...]:
    """Return names without superfluous blanks, a number after those that stand there again."""
    clean = [" ".join(name.split()) or "unnamed" for name in names]
    taken, seen, apart = set(clean), Counter[str](), []
    for name in clean:
        seen[name] += 1
        told = name
        while seen[name] > 1 and (told == name or told in taken):
            told = f"{name} ({seen[name]})"
            seen[name] += told in taken
        taken.add(told)
        apart.append(told)
    return tuple(apart)
