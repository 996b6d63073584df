"""Spectra of the USGS Spectral Library Version 7 as ASCII files.

R. F. Kokaly et al. 2017, "USGS Spectral Library Version 7", Data Series 1035
(DOI 10.3133/ds1035). A file is a title and a number a line; the wavelengths, in µm, lie in a file
of their own for each spectrometer, some folders up; -1.23e34 is a channel without data.
"""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..curves import NoSpectra, Table
from ..files import lines as lines_of
from .spectra import numbers, table, to_nm

NAME = "USGS splib07"
ENDINGS = (".txt",)

PREFIX = re.compile(r"(splib|s)0\d", re.IGNORECASE)
"""How the names of its files begin."""

DELETED = -1e30
"""What is below is a channel without data."""

_TITLE = re.compile(r"\s*\w+ Record=\d+:\s*(?P<name>.+)")
_NO_SAMPLE = re.compile(r"(wavelengths?|bandpass|resolution|error ?bars?|srf)\b", re.IGNORECASE)
_FOLDERS_UP = 3


def recognises(path: Path, start: bytes) -> bool:
    """Whether a file begins as one of the library's, which has ``Record=`` in its title."""
    return _TITLE.match(start.decode("latin-1").partition("\n")[0]) is not None


def read(path: Path) -> Table:
    """Read one spectrum.

    Raises `InputError` for text among the numbers, and where no file of as many wavelengths lies in
    its folder or above; `NoSpectra` for files of wavelengths, bandpasses and errors.
    """
    title, *lines = lines_of(path)
    match = _TITLE.match(title)
    if match is None:  # UTF-16, or cut
        raise InputError(path, "has no title", "get the file again")
    name = match["name"].strip()
    if _NO_SAMPLE.match(name) or _NO_SAMPLE.match(path.name):
        raise NoSpectra(path, "holds no reflectances", "give the file of a sample")
    values = numbers(path, lines, 2, 1)
    wavelengths = _wavelengths(path, name, len(values))
    values = np.where(values < DELETED, np.nan, values)
    chapter = re.fullmatch(r"Chapter[A-Z]+_(.+)", path.parent.name)
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", chapter[1]) if chapter else ""
    return table(
        path,
        [name],
        wavelengths,
        values,
        format=NAME,
        unit="fraction",
        quantity="transmittance" if re.search(r"TRAN", name.split()[-1]) else "reflectance",
        classes=[words],
        lines=np.arange(2, 2 + len(values)),
    )


def wavelength_files(path: Path) -> tuple[Path, ...]:
    """Return the files of wavelengths that lie where a spectrum's may: in its folder or above."""
    folders = (path.parent, *path.parent.parents)[: _FOLDERS_UP + 1]
    return next((found for folder in folders if (found := _in_folder(folder))), ())


@lru_cache(maxsize=64)
def _listed(folder: Path, changed: int) -> tuple[Path, ...]:
    return tuple(sorted(folder.glob("*[Ww]avelengths*.txt")))


def _in_folder(folder: Path) -> tuple[Path, ...]:
    try:
        return _listed(folder, folder.stat().st_mtime_ns)
    except OSError:
        return ()


def _wavelengths(path: Path, name: str, count: int) -> NDArray[np.float64]:
    """Return the wavelengths [nm] of a spectrum of so many channels."""
    files = wavelength_files(path)
    fitting = []
    for file in files:
        try:
            found = _read(file, file.stat().st_mtime_ns)
        except OSError:
            continue
        if len(found) == count:
            fitting.append((file, found))
    # Several spectrometers may have as many channels: the sample's title names its own.
    spectrometer = next(iter(name.split()[-2:]), "")
    own = (re.search(r"avelengths_([A-Z]+\d?)", file.name) for file, _ in fitting)
    named = [
        found
        for (_, found), match in zip(fitting, own, strict=True)
        if match and spectrometer.startswith(match[1])
    ]
    if fitting and (len(fitting) == 1 or not named):
        return fitting[0][1]
    if named:
        return named[0]
    raise InputError(
        path,
        f"has {count} channels, and no file with that many wavelengths is next to it or above it",
        "keep it in the library's own folder",
    )


@lru_cache(maxsize=64)
def _read(file: Path, changed: int) -> NDArray[np.float64]:
    return to_nm(file, numbers(file, lines_of(file)[1:], 2, 1)[:, 0], "micrometres")
