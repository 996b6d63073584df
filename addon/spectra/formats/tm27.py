"""Spectra in ANSI/IES TM-27 files, ``.spdx``: XML with a value for each wavelength.

IES TM-27-20, "IES Standard Format for the Electronic Transfer of Spectral Data". Made for lamps, it
also carries reflectances and transmittances, which its ``SpectralQuantity`` says.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import number
from ..merging import together
from ..quantities import Said
from .spectra import table
from .xml_file import root_of, tag

NAME = "TM-27"
ENDINGS = (".spdx",)

_LIGHT = ("flux", "intensity", "radiance", "irradiance", "exitance", "power", "relative", "other")


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is XML with that name."""
    return path.suffix.lower() == ".spdx" or b"IESTM27" in start


def read(path: Path) -> Table:
    """Read all spectra of the file.

    Raises `InputError` for broken XML and text for numbers, `NoSpectra` where there is no spectrum.
    """
    root = root_of(path)
    title = next((_text(e) for e in root.iter() if tag(e) == "Description" and _text(e)), path.stem)
    names, curves, told = [], [], []
    for spectrum in (e for e in root.iter() if tag(e) == "SpectralDistribution"):
        pairs = []
        for one in spectrum:
            if tag(one) != "SpectralData":
                continue
            at, value = (
                number(text.strip()) for text in (one.get("wavelength", ""), one.text or "")
            )
            if at is None or value is None:
                raise InputError(
                    path, f"'{_text(one)[:40]}' is not a measurement", "export it again"
                )
            pairs.append((at, value))
        if not pairs:
            continue
        data = np.array(pairs)
        curves.append((data[:, 0], data[:, 1]))
        names.append(title)
        told.append(_said(next((_text(e) for e in spectrum if tag(e) == "SpectralQuantity"), "")))
    if not curves:
        raise NoSpectra(path, "holds no SpectralData", "export the measurement with its spectrum")
    everywhere, values = together(path, curves)
    return table(path, names, everywhere, values, format=NAME).with_said(told)


def _text(element: ET.Element) -> str:
    return (element.text or "").strip()


def _said(quantity: str) -> Said:
    """Return what a ``SpectralQuantity`` is; without one it is a lamp's, as in the standard."""
    found = quantities.said(quantity)
    if found.quantity:
        return found
    return Said("light" if not quantity or quantity.casefold() in _LIGHT else quantity)
