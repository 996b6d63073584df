"""ENVI spectral libraries: a binary file ``.sli`` of spectra in rows, and its header ``.hdr``.

NV5 Geospatial, "ENVI Header Files"
(https://www.nv5geospatialsoftware.com/docs/enviheaderfiles.html).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import content, number, regular
from .spectra import table, to_nm

NAME = "ENVI spectral library"
ENDINGS = (".sli",)

_TYPES = {1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4", 14: "i8", 15: "u8"}
_NO_SAMPLE = re.compile(r"(wavelengths?|resolution|bandpass|error bars?)\b", re.IGNORECASE)
_LARGEST = 1 << 28  # values


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is one, by the ending, or its header, by the first word."""
    return path.suffix.lower() == ".sli" or start.startswith(b"ENVI")


def header_of(path: Path) -> Path:
    """Return the header of a library: ``x.hdr`` beside ``x.sli``, else ``x.sli.hdr``."""
    if path.suffix.lower() == ".hdr":
        return path
    names = (path.with_suffix(".hdr"), path.with_suffix(".HDR"), Path(f"{path}.hdr"))
    return next((name for name in names if name.exists()), names[0])


def read(path: Path) -> Table:
    """Read all spectra but those that are wavelengths, bandpasses or errors of others.

    Raises
    ------
    InputError
        A header that is missing or broken, a file shorter than it says, wavelengths in no length.
        `NoSpectra` for an image.
    """
    header = header_of(path)
    fields = _fields(header)
    if "spectral library" not in fields.get("file type", "").casefold():
        raise NoSpectra(header, "is the header of an image", "give a spectral library")
    channels, count, bands = (_whole(header, fields, key) for key in ("samples", "lines", "bands"))
    if bands != 1:
        raise InputError(header, f"says {bands} bands", "a spectral library has one")
    wavelengths = np.array(_numbers(header, fields, "wavelength"))
    if len(wavelengths) != channels:
        raise InputError(
            header,
            f"names {len(wavelengths)} wavelengths for {channels} channels",
            "give one for each",
        )
    factor = _factor(header, fields)
    values = _values(path, header, fields, channels, count) / (factor or 1.0)
    if "bbl" in fields:
        bad = np.array(_numbers(header, fields, "bbl"))
        values[:, bad[:channels] == 0 if len(bad) >= channels else slice(0)] = np.nan
    names = _names(path, fields.get("spectra names", ""), count)
    samples = [k for k, name in enumerate(names) if not _NO_SAMPLE.match(name.strip())]
    return table(
        path,
        [names[k] for k in samples],
        to_nm(header, wavelengths, fields.get("wavelength units", "")),
        values[samples].T,
        format=NAME,
        unit="fraction" if factor else None,
        quantity=quantities.said(fields.get("z plot titles", "").partition(",")[2]).quantity,
    )


def _fields(header: Path) -> dict[str, str]:
    """Return a header's fields by their names in small letters, braces taken off."""
    if not header.exists():
        raise InputError(header, "is missing: the header of a spectral library", "put it there")
    found = content(header).decode("utf-8", errors="replace")
    if not found.lstrip("\ufeff").startswith("ENVI"):
        raise InputError(header, "is not an ENVI header", "its first line is ENVI")
    fields: dict[str, str] = {}
    at = 0
    while at < len(found):  # a brace that is never closed is looked for once
        end = found.find("\n", at)
        end = len(found) if end < 0 else end
        key, equals, value = found[at:end].partition("=")
        value = value.strip()
        if value.startswith("{") and "{" not in key and "}" not in key:
            close = found.find("}", at)
            if close < 0:
                raise InputError(header, f"{key.strip()[:40]}: a brace is not closed", "correct it")
            value = found[found.index("{", at) + 1 : close].strip()
            end = max(found.find("\n", close), close)
        if equals and key.strip():
            fields[key.strip().casefold()] = value
        at = end + 1
    return fields


def _whole(header: Path, fields: dict[str, str], key: str) -> int:
    try:
        value = int(fields.get(key, "1" if key == "bands" else "")[:20])
    except ValueError:
        value = 0
    if not 0 < value <= _LARGEST:
        said = fields.get(key, "nothing")[:40]
        raise InputError(header, f"says {key} = {said}", "correct the header")
    return value


def _numbers(header: Path, fields: dict[str, str], key: str) -> list[float]:
    cells = [cell.strip() for cell in fields.get(key, "").split(",") if cell.strip()]
    found = [number(cell) for cell in cells]
    if None in found:
        wrong = cells[found.index(None)][:40]
        raise InputError(header, f"{key}: '{wrong}' is not a number", "correct the header")
    return [value for value in found if value is not None]


def _factor(header: Path, fields: dict[str, str]) -> float | None:
    """Return what values were multiplied by, None where nothing says it."""
    said = fields.get("reflectance scale factor", "")
    if not said:
        title = re.search(r"reflectance\s*\[\s*\*\s*(\d+)\s*\]", fields.get("z plot titles", ""), 2)
        said = title[1] if title else ""
    factor = number(said) if said else None
    if said and (factor is None or not 0 < factor < np.inf):
        raise InputError(
            header, f"says reflectance scale factor = {said[:40]}", "correct the header"
        )
    return factor


def _values(
    path: Path, header: Path, fields: dict[str, str], channels: int, count: int
) -> NDArray[np.float64]:
    """Return the spectra (count, channels), NaN where the header says that there is no data."""
    kind, order = fields.get("data type", ""), fields.get("byte order", "0")
    if kind not in map(str, _TYPES) or order not in ("0", "1"):
        said = f"data type = {kind[:20]}, byte order = {order[:20]}"
        raise InputError(header, f"says {said}", "correct it")
    dtype = np.dtype("<>"[int(order)] + _TYPES[int(kind)])
    data = path if path.suffix.lower() != ".hdr" else _data_of(path)
    offset = number(fields.get("header offset") or "0")
    if offset is None or not 0 <= offset < 1 << 40:
        raise InputError(header, "says an odd header offset", "correct the header")
    offset = int(offset)
    needed = channels * count * dtype.itemsize
    if channels * count > _LARGEST:
        raise InputError(header, f"says {count} spectra of {channels} channels", "split it")
    try:
        size = regular(data)
        if size < offset + needed:
            raise InputError(data, f"has {size} bytes of {offset + needed}", "get the file again")
        raw = np.fromfile(data, dtype, channels * count, offset=offset)
    except OSError as error:
        raise InputError(data, f"cannot be read ({error.strerror})", "check the path") from error
    with np.errstate(all="ignore"):  # any bits may be a number
        values = raw.astype(float).reshape(count, channels)
    ignored = fields.get("data ignore value")
    if ignored:
        for value in _numbers(header, fields, "data ignore value")[:1]:
            values[np.isclose(values, value, rtol=1e-5, atol=1e-12)] = np.nan
    values[values < -1e30] = np.nan
    return values


def _data_of(header: Path) -> Path:
    names = (header.with_suffix(".sli"), header.with_suffix(".SLI"), header.with_suffix(""))
    return next((name for name in names if name.is_file()), names[0])


def _names(path: Path, said: str, count: int) -> list[str]:
    """Return the spectra's names, numbers where the header names another count of them."""
    for separator in (r",", r",[ \t]*\r?\n"):  # some names hold commas, and stand on lines then
        names = [name.strip() for name in re.split(separator, said)]
        if len(names) == count and said:
            return names
    return [f"{path.stem} {k}" for k in range(1, count + 1)]
