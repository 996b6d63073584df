"""Spectra in Color Exchange Format files, CxF3 (ISO 17972-1).

Objects with a ReflectanceSpectrum or TransmittanceSpectrum: numbers from ``StartWL`` on, at steps
that the color specification tells. Read with Python's own XML parser, for the one other reader
(colour-cxf) is young and would bring two more wheels.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..table import NoSpectra, Table
from .spectra import content, table, together

NAME = "CxF3"
ENDINGS = (".cxf",)

STEP = 10.0
"""[nm] between values where the file tells none: that of the instruments that write it."""

_SPECTRA = {"ReflectanceSpectrum": "", "TransmittanceSpectrum": "transmittance"}


class _Plain(ET.TreeBuilder):
    """A builder that refuses a document type: with it come entities, which can grow without end."""

    def doctype(self, name, pubid, system):
        raise ValueError("it declares a document type")


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is XML with that name."""
    return path.suffix.lower() == ".cxf" or (start.lstrip()[:1] == b"<" and b"CxF" in start)


def read(path: Path) -> Table:
    """Read all objects that have a spectrum.

    Raises `InputError` for broken XML, one with a document type, spectra without a first wavelength
    and text among their numbers; `NoSpectra` where no object has one.
    """
    try:
        root = ET.XML(content(path), ET.XMLParser(target=_Plain()))
    except (ET.ParseError, ValueError, LookupError) as error:
        raise InputError(path, f"is broken XML ({error})", "export it anew") from None
    ranges = {
        specification.get("Id"): found
        for specification in root.findall(".//{*}ColorSpecification")
        if (found := specification.find("{*}MeasurementSpec/{*}WavelengthRange")) is not None
    }
    names, curves, classes = [], [], []
    for thing in root.findall(".//{*}Object"):
        name = thing.get("Name") or thing.get("Id") or f"object {len(names) + 1}"
        for spectrum in thing.findall("{*}ColorValues/*"):
            kind = spectrum.tag.rpartition("}")[2]
            if kind not in _SPECTRA:
                continue
            place = f"{path}, object '{name}'"
            known = ranges.get(spectrum.get("ColorSpecification"))
            curves.append(_curve(place, spectrum, {} if known is None else known.attrib))
            names.append(name)
            classes.append(_SPECTRA[kind] or thing.get("ObjectType") or "")
    if not curves:
        raise NoSpectra(path, "holds no spectrum", "export the measurement with spectra")
    wavelengths, values = together(path, curves)
    return table(path, names, wavelengths, values, classes=classes)


def _curve(
    place: str, spectrum: ET.Element, known: dict[str, str]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return wavelengths [nm] and values of a spectrum, (k,) each."""
    try:
        start = float(spectrum.get("StartWL") or known["StartWL"])
        step = float(spectrum.get("Increment") or known.get("Increment") or STEP)
        values = np.array([float(part) for part in (spectrum.text or "").split()])
    except KeyError:
        raise InputError(place, "tells no first wavelength", "add StartWL") from None
    except ValueError as error:
        raise InputError(place, str(error), "mend the spectrum") from None
    if not step > 0:
        raise InputError(place, f"has steps of {step:g} nm", "mend its Increment")
    return start + step * np.arange(len(values)), values
