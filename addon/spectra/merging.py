"""Curves at wavelengths of their own brought into one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .curves import LIGHT, Table
from .files import plain

MOST = 1 << 22
"""Numbers in a table, where it is more than eight times as large as the curves in it."""


def together(
    path: Path, curves: Iterable[tuple[NDArray[np.float64], NDArray[np.float64]]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the wavelengths (k,) of all curves and their values (k, m), NaN where one has none.

    ``curves``: wavelengths and values, (n,) each, of every curve. Raises `InputError` for one that
    has a wavelength twice in visible light (elsewhere the first counts), and for so many curves at
    wavelengths of their own that the table would be far larger than they are.
    """
    found = [_once(path, x, y) for x, y in curves]
    everywhere = np.unique(np.concatenate([x for x, _ in found]))
    given = sum(x.size for x, _ in found)
    if everywhere.size * len(found) > max(MOST, 8 * given):
        raise InputError(
            path, f"{len(found)} spectra at {everywhere.size} wavelengths", "split the file"
        )
    values = np.full((everywhere.size, len(found)), np.nan)
    for column, (x, y) in enumerate(found):
        values[np.searchsorted(everywhere, x), column] = y
    return everywhere, values


def _once(path: Path, x: NDArray, y: NDArray) -> tuple[NDArray, NDArray]:
    once, first = np.unique(x, return_index=True)
    if once.size < x.size:
        twice = np.delete(x, first)
        visible = twice[(twice >= LIGHT[0]) & (twice <= LIGHT[1])]
        if visible.size:
            raise InputError(
                path, f"wavelength {visible[0]:g} nm occurs twice", "remove one of the two"
            )
    return once, y[first]


def merged(
    path: Path,
    names: Sequence[str],
    parts: Sequence[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]],
) -> Table:
    """Return columns as a `Table`: ``parts`` have wavelengths [nm] (k,), values (k, m), lines (k,).

    Parts at the same wavelengths stay beside one another; others are merged, NaN where one has no
    value. Raises `InputError` for a wavelength that stands in a part twice in visible light, with
    both lines.
    """
    nm, _, lines = parts[0]
    alike = all(np.array_equal(nm, other) for other, _, _ in parts[1:])
    if len(parts) > 1 and not alike:
        curves = [(nm, column) for nm, values, _ in parts for column in values.T]
        everywhere, values = together(path, curves)
        return Table(path, tuple(names), everywhere, values, None, False, sparse=True)
    values = np.concatenate([values for _, values, _ in parts], axis=1)
    order = np.argsort(nm, kind="stable")
    nm, values, lines = nm[order], values[order], lines[order]
    once = np.append(True, np.diff(nm) > 0)
    visible = (nm >= LIGHT[0]) & (nm <= LIGHT[1])
    twice = np.flatnonzero(~once & visible)
    if twice.size:
        k = twice[0]
        raise InputError(
            f"{path}:{max(lines[k], lines[k - 1])}",
            f"wavelength {nm[k]:g} nm stands on line {min(lines[k], lines[k - 1])} too",
            "remove one of the rows",
        )
    steps = np.diff(order)
    return Table(
        path,
        tuple(names),
        nm[once],
        values[once],
        lines[once],
        # A scan from red to blue is in order too.
        bool(np.any(steps < 0)),
    )


def told_apart(names: Sequence[str], collapse: bool = True) -> tuple[str, ...]:
    """Return names that can be shown, a number after those that stand there again.

    ``collapse``: runs of blanks become one.
    """
    clean = [plain(" ".join(name.split()) if collapse else name) or "unnamed" for name in names]
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
