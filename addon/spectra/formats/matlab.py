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
from ..table import NoSpectra, Table
from .spectra import table, to_nm, together

NAME = "MATLAB"
ENDINGS = (".mat",)

_LARGEST = 1 << 26  # values in a variable


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is a MATLAB file, by its ending."""
    return path.suffix.lower() == ".mat"


def read(path: Path) -> Table:
    """Read all surfaces of a file; rows at either end that are 0 for all of a set are padding.

    Raises `InputError` for a broken file, one of MATLAB 7.3 (HDF5) and matrices that do not fit
    their wavelengths; `NoSpectra` for one without surfaces.
    """
    from scipy.io import loadmat, whosmat

    try:
        shapes = {name: shape for name, shape, _ in whosmat(path)}
        wanted = [
            name
            for name in shapes
            if name.startswith(("sur_", "S_", "labels_")) or name in ("data", "wavelength")
        ]
        if any(np.prod(shapes[name], dtype=float) > _LARGEST for name in wanted):
            raise InputError(path, "holds a matrix of over 64 million values", "split it")
        found = loadmat(path, variable_names=wanted, chars_as_strings=True) if wanted else {}
    except InputError:
        raise
    except NotImplementedError:
        raise InputError(path, "is of MATLAB 7.3 (HDF5)", "save it with -v7") from None
    except Exception as error:  # a damaged file raises whatever its bytes happen to mean
        raise InputError(path, f"is a broken MATLAB file ({error})", "take it anew") from None
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
    return table(path, names, everywhere, together_, notes=notes)


def _sets(path: Path, found: dict[str, Any]) -> list[tuple[str, NDArray, NDArray]]:
    """Return each set's name, wavelengths [nm] (k,) and values (k, m)."""
    sets = []
    for key in found:
        if key.startswith("sur_"):
            grid = found.get(f"S_{key[4:]}")
            try:
                start, step, count = (float(part) for part in np.ravel(grid)[:3])
                wavelengths = start + step * np.arange(int(count))
            except (TypeError, ValueError):
                raise InputError(
                    f"{path}, S_{key[4:]}", "is not [start step count]", "add it"
                ) from None
            sets.append((key[4:], wavelengths, _matrix(path, key, found[key], len(wavelengths))))
    if "data" in found and "wavelength" in found:
        wavelengths = to_nm(path, np.ravel(_matrix(path, "wavelength", found["wavelength"], None)))
        values = _matrix(path, "data", found["data"], len(wavelengths))
        sets.append((path.stem, wavelengths, values))
    return sets


def _matrix(path: Path, key: str, value: Any, rows: int | None) -> NDArray[np.float64]:
    """Return a variable as a matrix of numbers with so many rows."""
    matrix = np.asarray(value)
    if matrix.dtype.kind not in "fiu" or matrix.ndim != 2:
        raise InputError(f"{path}, {key}", "is no matrix of numbers", "give one")
    if rows is not None and matrix.shape[0] != rows:
        raise InputError(
            f"{path}, {key}", f"has {matrix.shape[0]} rows for {rows} wavelengths", "make them fit"
        )
    return matrix.astype(float)


def _labels(found: dict[str, Any], key: str, count: int) -> list[str]:
    """Return a set's labels where the file has one for each surface."""
    labels = found.get(f"labels_{key}")
    if labels is None or np.size(labels) != count:
        return []
    if labels.dtype.names:
        labels = labels[labels.dtype.names[0]]
    return [_words(label) for label in np.ravel(labels)]


def _words(label: Any) -> str:
    """Return the text in nested cells."""
    while isinstance(label, np.ndarray):
        label = label.flat[0] if label.size else ""
    return str(label)
