"""Spectra in JCAMP-DX files, ``.jdx`` and ``.dx``, in all forms of the standard.

R. S. McDonald, P. A. Wilks 1988, "JCAMP-DX: A Standard Form for the Exchange of Infrared Spectra in
Computer Readable Form" (DOI 10.1366/0003702884428734): labelled records ``##LABEL=``, pairs
``(XY..XY)``, or ordinates at even steps ``(X++(Y..Y))``, plain (AFFN), packed (PAC), squeezed
(SQZ), as differences (DIF) and with repetitions (DUP).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import lines, number
from ..merging import together
from .spectra import table, to_nm

NAME = "JCAMP-DX"
ENDINGS = (".dx", ".jcm", ".jdx")

MOST = 1 << 16
"""Values of one spectrum: three letters may stand for any number of them."""

MOST_OF_ALL = 1 << 20
"""Values of all spectra of a file."""

_ORDINATE = re.compile(
    r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[Ee][+-]\d{1,3})?|[@A-Ia-i]\d*\.?\d*|[%J-Rj-r]\d*\.?\d*|[S-Zs]\d*|\?"
)
_BETWEEN = re.compile(r"[\s,;]*")
_SQUEEZED = {c: d for d, c in enumerate("@ABCDEFGHI")} | {
    c: -d for d, c in enumerate("abcdefghi", 1)
}
_DIFFERENCE = {c: d for d, c in enumerate("%JKLMNOPQR")} | {
    c: -d for d, c in enumerate("jklmnopqr", 1)
}
_REPEATED = {c: d for d, c in enumerate("STUVWXYZs", 1)}


def recognises(path: Path, start: bytes) -> bool:
    """Whether it has the standard's name in a record."""
    return (
        b"##" in start and re.search(rb"##\s?JCAMP[-_ ]?DX\s?=", start, re.IGNORECASE) is not None
    )


def read(path: Path) -> Table:
    """Read all spectra of all blocks.

    Raises `InputError` for text among the numbers, a count or ends that the file does not keep and
    an abscissa that is no wavelength; `NoSpectra` for a file without spectra.
    """
    names, curves, told = [], [], []
    count = 0
    for fields, at, rows in _blocks(path):
        nm, values = _spectrum(path, fields, at, rows)
        names.append(fields.get("TITLE") or path.stem)
        curves.append((nm, values))
        count += len(values)
        if count > MOST_OF_ALL:
            raise InputError(path, f"holds more than {MOST_OF_ALL} values", "split the file")
        said = quantities.said(fields.get("YUNITS", ""))
        for other in ("DATATYPE", "YLABEL"):
            said = said.over(quantities.said(fields.get(other, "")))
        told.append(said)
    if not curves:
        raise NoSpectra(path, "holds no XYDATA or XYPOINTS", "export the spectrum")
    everywhere, values = together(path, curves)
    found = table(path, names, everywhere, values, format=NAME)
    return found.with_said(told)


def _blocks(path: Path) -> Iterator[tuple[dict[str, str], int, list[str]]]:
    """Yield the records before each set of data, the line on which it begins, and its lines."""
    fields: dict[str, str] = {}
    data: list[str] = []
    label = ""
    first = 0
    for place, line in enumerate(lines(path), 1):
        line = line.partition("$$")[0].rstrip()
        match = re.match(r"\s*##([^=]*)=(.*)", line)
        if match is None:
            if label in ("XYDATA", "XYPOINTS", "PEAKTABLE"):
                data.append(line)
            elif label and line.strip() and len(fields.get(label, "")) < 1000:
                fields[label] = f"{fields.get(label, '')} {line.strip()}".strip()
            continue
        if data:
            yield dict(fields), first, data
            data = []
        label = re.sub(r"[\s/_-]", "", match[1]).upper()
        if label == "TITLE":
            fields = {}
        if label:
            fields[label] = match[2].strip()
        if label in ("XYDATA", "XYPOINTS", "PEAKTABLE"):
            first, data = place + 1, []
    if data:
        yield dict(fields), first, data


def _spectrum(
    path: Path, fields: dict[str, str], at: int, rows: list[str]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return wavelengths [nm] and values (k,) of a block."""
    x_factor, y_factor = (_given(path, fields, key, 1.0) for key in ("XFACTOR", "YFACTOR"))
    form = fields.get("XYDATA", "").replace(" ", "").upper()
    if form.startswith("(X++"):
        ordinates = _unpacked(path, at, rows)
        count = _given(path, fields, "NPOINTS", len(ordinates))
        if count != len(ordinates):
            raise InputError(
                f"{path}:{at}",
                f"{len(ordinates)} values where NPOINTS is {count:g}",
                "export it again",
            )
        first, last = (_given(path, fields, key, float("nan")) for key in ("FIRSTX", "LASTX"))
        if not np.isfinite(last):
            last = first + _given(path, fields, "DELTAX", float("nan")) * (len(ordinates) - 1)
        if not (np.isfinite(first) and np.isfinite(last)):
            raise InputError(f"{path}:{at}", "FIRSTX or LASTX is missing", "export it again")
        x = np.linspace(first, last, len(ordinates))
        y = np.array(ordinates) * y_factor
    else:
        pairs = _pairs(path, at, rows)
        x, y = pairs[:, 0] * x_factor, pairs[:, 1] * y_factor
    if x.size < 2:
        raise InputError(f"{path}:{at}", "holds no spectrum", "export it again")
    return to_nm(path, x, fields.get("XUNITS", "")), y


def _given(path: Path, fields: dict[str, str], key: str, otherwise: float) -> float:
    said = fields.get(key, "").split(",")[0].strip()
    found = number(said) if said else otherwise
    if found is None:
        raise InputError(path, f"##{key}= {said[:40]} is not a number", "export it again")
    return found


def _pairs(path: Path, at: int, rows: list[str]) -> NDArray[np.float64]:
    found = []
    for place, row in enumerate(rows, at):
        cells = [number(cell) for cell in re.split(r"[\s,;]+", row.strip()) if cell]
        if None in cells or len(cells) % 2:
            raise InputError(
                f"{path}:{place}", f"'{row.strip()[:40]}' is not a pair", "export it again"
            )
        found += cells
    return np.array(found, dtype=float).reshape(-1, 2)


def _unpacked(path: Path, at: int, rows: list[str]) -> list[float]:
    """Return the ordinates of ``(X++(Y..Y))``; `InputError` where a line's check does not hold."""
    found: list[float] = []
    checked = False  # the last line ended in a difference: the next begins with its last ordinate
    for place, row in enumerate(rows, at):
        if not row.strip():
            continue
        tokens = _tokens(path, place, row)[1:]  # the abscissa is told by FIRSTX
        start = len(found)
        step: float | None = None
        for token in tokens:
            head = token[0]
            if head in _DIFFERENCE:
                step = _digits(_DIFFERENCE[head], token[1:])
                found.append((found[-1] if found else 0.0) + step)
            elif head in _REPEATED:
                more = int(_digits(_REPEATED[head], token[1:])) - 1
                if not found or not 0 <= more <= MOST:
                    raise InputError(
                        f"{path}:{place}", f"'{token[:20]}' repeats nothing", "correct it"
                    )
                last, rise = found[-1], step or 0.0
                found += [last + rise * k for k in range(1, more + 1)]
            else:
                step = None
                found.append(_ordinate(token))
            if len(found) > MOST:
                raise InputError(f"{path}:{place}", f"more than {MOST} values", "split it")
        if checked and start < len(found):
            if abs(found[start] - found[start - 1]) > 1.0 + 1e-9 * abs(found[start]):
                raise InputError(
                    f"{path}:{place}",
                    f"begins with {found[start]:g}, the last line ends with {found[start - 1]:g}",
                    "export it again",
                )
            del found[start]
        checked = step is not None
    return found


def _tokens(path: Path, place: int, row: str) -> list[str]:
    tokens = []
    at = _BETWEEN.match(row).end()  # type: ignore[union-attr]
    while at < len(row):
        match = _ORDINATE.match(row, at)
        if match is None or len(match[0]) > 64:
            raise InputError(
                f"{path}:{place}", f"'{row[at : at + 20]}' is not a number", "export it again"
            )
        tokens.append(match[0])
        at = _BETWEEN.match(row, match.end()).end()  # type: ignore[union-attr]
    return tokens


def _ordinate(token: str) -> float:
    if token == "?":
        return float("nan")
    if token[0] in _SQUEEZED:
        return _digits(_SQUEEZED[token[0]], token[1:])
    return float(token)


def _digits(first: int, rest: str) -> float:
    """Return the number whose first digit, with its sign, a letter stands for."""
    value = float(f"{abs(first)}{rest}")
    return -value if first < 0 else value
