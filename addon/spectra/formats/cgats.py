"""Spectra in CGATS text files, as measuring programs write them (i1Profiler, Argyll, IT8 charts).

ANSI CGATS.17, and Argyll's dialect of it (https://www.argyllcms.com/doc/File_Formats.html): fields
named between BEGIN_DATA_FORMAT and END_DATA_FORMAT, samples between BEGIN_DATA and END_DATA.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .. import quantities
from ..cells import split
from ..curves import NoSpectra, Table
from ..files import lines as lines_of
from ..files import number
from ..merging import together
from ..quantities import Said
from .spectra import table

NAME = "CGATS"
ENDINGS = (".cgats", ".cie", ".it8", ".sp", ".ti3", ".txt")

_FIELD = re.compile(
    r"(?:(?P<what>[A-Z\d]*)_?)??(?:SPECTRAL|SPECTRUM|SPEC|NM|REFLECTANCE|REFL|TRANSMITTANCE|TRANS|R|T)?_?"
    r"(?:NM|WL)?_?(?P<nm>\d{3,4}(?:[.,]\d+)?)_?(?:NM)?",
    re.IGNORECASE,
)
_NO_SPECTRUM = re.compile(r"(D|DENSITY|STDEV|SD|MIN|MAX|SAMPLE|PATCH|ID)_?$", re.IGNORECASE)
_NAMES = ("SAMPLE_NAME", "SAMPLENAME", "SAMPLE_ID", "SAMPLEID", "SAMPLE_LOC", "PATCH_NAME")
_KINDS = (
    "DEVICE_CLASS",
    "MEAS_TYPE",
    "MEASUREMENT_TYPE",
    "MEASUREMENT_MODE",
    "MEASURE_MODE",
    "TYPE",
)
_EMITS = re.compile(r"display|emis|ambient|flash|illumin|radian|luminance|projector", re.IGNORECASE)
_TRANSMITS = re.compile(r"transmi", re.IGNORECASE)


def recognises(path: Path, start: bytes) -> bool:
    """Whether fields are named in it, or its first word is that of the standard."""
    return re.match(rb"(\xef\xbb\xbf)?\s*(CGATS|CTI\d|SPECT\b|IT8)", start) is not None or (
        b"BEGIN_DATA_FORMAT" in start
    )


@dataclass
class _Header:
    """What stands before samples: fields, where the spectrum is in them, and keywords."""

    fields: list[str] = field(default_factory=list)
    places: list[tuple[float | int, int]] = field(default_factory=list)
    name: int | None = None
    norm: float | None = None
    said: Said = field(default_factory=Said)


def read(path: Path) -> Table:
    """Read all samples of all tables in the file that have spectral fields.

    Values are divided by SPECTRAL_NORM. Raises `InputError` for a sample with another count of
    values than there are fields and for text among the numbers, `NoSpectra` where no field is
    spectral.
    """
    names, curves, told = [], [], []
    lines = iter(enumerate(lines_of(path), 1))
    header = _Header()
    for place, line in lines:
        word = line.strip().upper()
        if word == "BEGIN_DATA_FORMAT":
            fields = [one for _, more in _until(lines, "END_DATA_FORMAT") for one in _split(more)]
            header.fields, header.places = fields, _spectral(fields)
            upper = [one.upper() for one in fields]
            header.name = next((upper.index(name) for name in _NAMES if name in upper), None)
        elif word == "BEGIN_DATA":
            for at, more in _until(lines, "END_DATA"):
                if not header.places or not more.strip():
                    continue
                cells = _sample(path, at, more, header)
                names.append(_name(cells, header, len(names) + 1))
                x, y = _curve(path, at, cells, header.places)
                curves.append((x, y / (header.norm or 1.0)))
                # A norm of 1 is what many write who know nothing of it.
                normed = header.norm is not None and header.norm != 1.0
                told.append(Said("", quantities.FRACTION if normed else None).over(header.said))
        else:
            _keyword(path, place, line, header)
    if not curves:
        raise NoSpectra(path, "holds no spectral data", "export the measurement with spectra")
    wavelengths, values = together(path, curves)
    return table(path, names, wavelengths, values, format=NAME).with_said(told)


def _keyword(path: Path, place: int, line: str, header: _Header) -> None:
    """Take what a line of the header says of the spectra."""
    parts = line.split(None, 1)
    if len(parts) < 2:
        return
    key, value = parts[0].upper(), parts[1].strip().strip('"').strip()
    if key == "SPECTRAL_NORM":
        norm = number(value)
        if norm is None or not np.isfinite(norm) or norm <= 0:
            raise InputError(f"{path}:{place}", f"SPECTRAL_NORM is '{value[:40]}'", "correct it")
        header.norm = norm
    elif key in _KINDS:
        if _EMITS.search(value):
            header.said = Said("light")
        elif _TRANSMITS.search(value):
            header.said = Said(quantities.TRANSMITTANCE)
        elif "reflect" in value.casefold():
            header.said = Said(quantities.REFLECTANCE)


def _until(lines: Iterator[tuple[int, str]], end: str) -> Iterator[tuple[int, str]]:
    """Yield numbered lines up to the word that ends their section."""
    for place, line in lines:
        if line.strip().upper() == end:
            return
        yield place, line


def _split(line: str) -> list[str]:
    return split(line.replace("\t", " "), " ") if '"' in line else line.split()


def _sample(path: Path, place: int, line: str, header: _Header) -> list[str]:
    """Return the cells of a sample, whose name may hold blanks and no quotation marks."""
    count = len(header.fields)
    cells = _split(line)
    if len(cells) == count:
        return cells
    if "\t" in line:
        tabbed = split(line, "\t")
        while len(tabbed) > count and not tabbed[-1]:
            tabbed.pop()
        if len(tabbed) == count:
            return tabbed
    more = len(cells) - count
    if more > 0 and header.name is not None:
        at = header.name
        joined = [*cells[:at], " ".join(cells[at : at + more + 1]), *cells[at + more + 1 :]]
        if all(number(joined[column]) is not None for _, column in header.places):
            return joined
    raise InputError(
        f"{path}:{place}",
        f"{len(cells)} values for {count} fields",
        "correct the row or the DATA_FORMAT",
    )


def _spectral(fields: list[str]) -> list[tuple[float | int, int]]:
    """Return wavelength and column of each spectral field.

    CGATS.17 also knows pairs SPECTRAL_NM and SPECTRAL_PCT or SPECTRAL_DEC, the wavelength in the
    row: of these the column of the wavelength stands for it, as a negative number.
    """
    found: list[tuple[float | int, int]] = []
    for column, one in enumerate(fields):
        match = _FIELD.fullmatch(one) if len(one) < 40 else None
        before = one[: match.start("nm")] if match else ""
        if match and not _NO_SPECTRUM.match(before):
            nm = number(match["nm"])
            if nm is not None and 200.0 <= nm <= 2600.0:
                found.append((nm, column))
        elif one.upper() in ("SPECTRAL_PCT", "SPECTRAL_DEC") and column:
            found.append((-column, column))
    return found


def _curve(
    path: Path, place: int, cells: list[str], places: list[tuple[float | int, int]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    x = [number(cells[int(-at) - 1]) if at < 0 else at for at, _ in places]
    y = [number(cells[column]) for _, column in places]
    for value, (_, column) in zip(y, places, strict=True):
        if value is None:
            raise InputError(
                f"{path}:{place}",
                f"could not convert '{cells[column][:40]}' to a number",
                "correct the row",
            )
    if None in x:
        raise InputError(f"{path}:{place}", "a wavelength is not a number", "correct the row")
    return np.array(x, dtype=float), np.array(y, dtype=float)


def _name(cells: list[str], header: _Header, count: int) -> str:
    found = cells[header.name] if header.name is not None else ""
    return found or f"sample {count}"
