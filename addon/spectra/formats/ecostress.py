"""Spectra of the ECOSTRESS and ASTER spectral libraries, ``….spectrum.txt``.

S. K. Meerdink et al. 2019 (DOI 10.1016/j.rse.2019.05.015); A. M. Baldridge et al. 2009
(DOI 10.1016/j.rse.2008.11.007). About twenty lines ``Name: value``, then wavelength and value.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import lines as lines_of
from .spectra import numbers, table, to_nm

NAME = "ECOSTRESS"
ENDINGS = (".txt",)

_NUMBERS = re.compile(r"\s*[-+.\d][-+.\deE]{0,40}[\s,]{1,40}[-+.\d][-+.\deE]{0,40}\s*$")


def recognises(path: Path, start: bytes) -> bool:
    """Whether a file begins with a name and says what its columns hold."""
    return re.match(rb"\s*Name:", start) is not None and b"X Units:" in start


def read(path: Path) -> Table:
    """Read one spectrum.

    Raises `InputError` for units other than nm, µm, percent and fraction and for text among the
    numbers; `NoSpectra` for what is neither reflectance nor transmittance.
    """
    lines = lines_of(path)
    first = next((k for k, line in enumerate(lines) if _NUMBERS.match(line)), len(lines))
    fields = {}
    for line in lines[:first]:
        key, colon, value = line.partition(":")
        if colon:
            fields.setdefault(key.strip().casefold(), value.strip())
    measured = fields.get("y units", "")
    said = quantities.said(measured)
    if said.quantity not in (quantities.REFLECTANCE, quantities.TRANSMITTANCE):
        raise NoSpectra(path, f"holds '{measured}'", "give reflectance or transmittance")
    data = numbers(path, [line.replace(",", " ") for line in lines[first:]], first + 1, 2)
    if not len(data):
        raise InputError(path, "holds no row of numbers", "get the file again")
    unit = re.search(r"\(([^)]*)\)", fields.get("x units", ""))
    sample = fields.get("sample no.", "")
    classes = [fields.get(key, "") for key in ("type", "class", "subclass")]
    return table(
        path,
        [f"{fields.get('name') or path.stem} {sample}"],
        to_nm(path, data[:, 0], unit[1] if unit else ""),
        # Deleted channels of spectra that come from the USGS.
        np.where(data[:, 1:] < -1e30, np.nan, data[:, 1:]),
        format=NAME,
        unit=said.unit,
        quantity=said.quantity,
        classes=[", ".join(word for word in classes if word and word.casefold() != "none")],
        lines=np.arange(first + 1, first + 1 + len(data)),
    )
