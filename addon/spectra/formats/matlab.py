"""Spectra in MATLAB files as Psychtoolbox and ISETCam have them.

Psychtoolbox: a matrix ``sur_NAME`` of surfaces in columns, and ``S_NAME`` = [start, step, count] in
nm (https://github.com/Psychtoolbox-3). ISETCam: ``data`` beside ``wavelength``
(https://github.com/ISET/isetcam).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..curves import NoSpectra, Table
from ..files import content
from ..merging import together
from .mat_file import BrokenFile, variables
from .spectra import table, to_nm

NAME = "MATLAB"
ENDINGS = (".mat",)

LARGEST_FILE = 1 << 28
"""Bytes."""


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is a MATLAB file, by its ending."""
    return path.suffix.lower() == ".mat"


def read(path: Path) -> Table:
    """Read all surfaces of a file; rows at either end that are 0 for all of a set are padding.

    Raises `InputError` for a broken file, one of MATLAB 7.3 (HDF5) and matrices that do not fit
    their wavelengths; `NoSpectra` for one without surfaces.
    """
    try:
        found = variables(content(path, LARGEST_FILE))
    except NotImplementedError:
        raise InputError(path, "is of MATLAB 7.3 (HDF5)", "save it with -v7") from None
    except BrokenFile as error:
        raise InputError(path, f"is a broken MATLAB file ({error})", "get the file again") from None
    names: list[str] = []
    curves: list[tuple[NDArray, NDArray]] = []
    notes: tuple[str, ...] = ()
    for key, wavelengths, values in _sets(path, found):
        measured = np.flatnonzero((values != 0).any(axis=1))
        if not measured.size:
            continue
        rows = slice(measured[0], measured[-1] + 1)
        if len(values[rows]) < len(values):
            low, high = wavelengths[rows][[0, -1]]
            notes += (f"{key} is padded with zeros outside {low:g}-{high:g} nm: left out",)
        labels = _labels(found, key, values.shape[1])
        names += labels or [f"{key} {k}" for k in range(1, values.shape[1] + 1)]
        curves += [(wavelengths[rows], column) for column in values[rows].T]
    if not curves:
        raise NoSpectra(path, "holds neither sur_ and S_ nor data and wavelength", "give surfaces")
    everywhere, together_ = together(path, curves)
    return table(path, names, everywhere, together_, format=NAME, notes=notes)


def _sets(path: Path, found: dict[str, Any]) -> list[tuple[str, NDArray, NDArray]]:
    """Return each set's name, wavelengths [nm] (k,) and values (k, m)."""
    sets = []
    for key in found:
        if not key.startswith("sur_"):
            continue
        grid = np.ravel(found.get(f"S_{key[4:]}", ()))
        if grid.size != 3 or grid.dtype.kind not in "fiu":
            raise InputError(f"{path}, S_{key[4:]}", "is not [start step count]", "add it")
        start, step, count = grid.astype(float)
        values = _matrix(path, key, found[key], count)
        sets.append((key[4:], start + step * np.arange(len(values)), values))
    if "data" in found and "wavelength" in found:
        wavelengths = to_nm(path, np.ravel(_matrix(path, "wavelength", found["wavelength"], None)))
        values = _matrix(path, "data", found["data"], len(wavelengths))
        sets.append((path.stem, wavelengths, values))
    return sets


def _matrix(path: Path, key: str, value: Any, rows: float | None) -> NDArray[np.float64]:
    """Return a variable as a matrix of numbers with so many rows."""
    matrix = value if isinstance(value, np.ndarray) else np.empty(0)
    if matrix.ndim != 2 or not matrix.size or matrix.dtype.kind not in "fiu":
        raise InputError(f"{path}, {key}", "is not a matrix of numbers", "give one")
    if rows is not None and matrix.shape[0] != rows:
        raise InputError(
            f"{path}, {key}",
            f"has {matrix.shape[0]} rows for {rows:g} wavelengths",
            "make them fit",
        )
    return matrix.astype(float)


def _labels(found: dict[str, Any], key: str, count: int) -> list[str]:
    """Return a set's labels where the file has one for each surface."""
    labels = found.get(f"labels_{key}")
    if isinstance(labels, dict):
        labels = next(iter(labels.values()), None)
    if not isinstance(labels, list) or len(labels) != count:
        return []
    return [_words(label) for label in labels]


def _words(label: Any) -> str:
    """Return the text in nested cells, or in a matrix of characters."""
    while isinstance(label, list):
        label = label[0] if label else ""
    return label if isinstance(label, str) else ""
