"""Spectra in CGATS text files, as measuring programs write them (i1Profiler, Argyll, IT8 charts).

ANSI CGATS.17, and Argyll's dialect of it (https://www.argyllcms.com/doc/File_Formats.html): fields
named between BEGIN_DATA_FORMAT and END_DATA_FORMAT, samples between BEGIN_DATA and END_DATA.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np

from ...errors import InputError
from ..table import NoSpectra, Table
from .spectra import table, text, together

NAME = "CGATS"
ENDINGS = (".cgats", ".cie", ".it8", ".sp", ".ti3", ".txt")

_FIELD = re.compile(
    r"(?:SPECTRAL_)?(?:NM|SPEC|SPECTRAL|R|REFL)_?(\d{3,4}(?:\.\d+)?)|(\d{3,4})(?:NM)?",
    re.IGNORECASE,
)
_NAMES = ("SAMPLE_NAME", "SAMPLENAME", "SAMPLE_ID", "SAMPLE_LOC", "PATCH_NAME")


def recognises(path: Path, start: bytes) -> bool:
    """Whether fields are named in it, or its first word is that of the standard."""
    return re.match(rb"\s*(CGATS|CTI\d|SPECT|IT8)", start) is not None or (
        b"BEGIN_DATA_FORMAT" in start
    )


def read(path: Path) -> Table:
    """Read all samples of all tables in the file that have spectral fields.

    Raises `InputError` for a sample with another count of values than there are fields and for text
    among the numbers, `NoSpectra` where no field is spectral.
    """
    names, curves, percent = [], [], []
    lines = enumerate(text(path).splitlines(), 1)
    fields: list[str] = []
    norm = None
    for _, line in lines:
        word = line.strip().upper()
        if word.startswith("SPECTRAL_NORM"):
            norm = re.sub(r"[^\d.]", "", word.removeprefix("SPECTRAL_NORM"))
        elif word == "BEGIN_DATA_FORMAT":
            fields = [
                field for _, more in _until(lines, "END_DATA_FORMAT") for field in _split(more)
            ]
        elif word == "BEGIN_DATA":
            places = _spectral(fields)
            for number, more in _until(lines, "END_DATA"):
                cells = _split(more)
                if not cells or not places:
                    continue
                if len(cells) != len(fields):
                    raise InputError(
                        f"{path}:{number}",
                        f"{len(cells)} values for {len(fields)} fields",
                        "mend the row or the DATA_FORMAT",
                    )
                names.append(_name(fields, cells, len(names) + 1))
                curves.append(_curve(path, number, cells, places))
                percent.append(norm is not None and norm not in ("", "1", "1.0", "1.000000"))
    if not curves:
        raise NoSpectra(path, "holds no spectral data", "export the measurement with spectra")
    wavelengths, values = together(path, curves)
    if len(set(percent)) > 1:
        values = values / np.where(percent, 100.0, 1.0)
    told = "percent" if all(percent) else None if not any(percent) else "fraction"
    return table(path, names, wavelengths, values, unit=told)


def _until(lines, end: str):
    """Yield numbered lines up to the word that ends their section."""
    for number, line in lines:
        if line.strip().upper() == end:
            return
        yield number, line


def _split(line: str) -> list[str]:
    try:
        return shlex.split(line, comments=False) if '"' in line else line.split()
    except ValueError:  # a lone quotation mark
        return line.split()


def _spectral(fields: list[str]) -> list[tuple[float | int, int]]:
    """Return wavelength and column of each spectral field.

    CGATS.17 also knows pairs SPECTRAL_NM and SPECTRAL_PCT or SPECTRAL_DEC, the wavelength in the
    row: of these the column of the wavelength stands for it, as a negative number.
    """
    found: list[tuple[float | int, int]] = []
    for column, field in enumerate(fields):
        match = _FIELD.fullmatch(field)
        if match:
            found.append((float(match[1] or match[2]), column))
        elif field.upper() in ("SPECTRAL_PCT", "SPECTRAL_DEC") and column:
            found.append((-column, column))
    return found


def _curve(path: Path, number: int, cells: list[str], places):
    try:
        x = [float(cells[int(-at) - 1]) if at < 0 else at for at, _ in places]
        y = [float(cells[column].replace(",", ".")) for _, column in places]
    except ValueError as error:
        raise InputError(f"{path}:{number}", str(error), "mend the row") from None
    return np.array(x), np.array(y)


def _name(fields: list[str], cells: list[str], number: int) -> str:
    upper = [field.upper() for field in fields]
    found = (cells[upper.index(name)] for name in _NAMES if name in upper)
    return next((name for name in found if name), f"sample {number}")
