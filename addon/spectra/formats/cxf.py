"""Spectra in Color Exchange Format files: CxF3 (ISO 17972-1), and CxF2 of GretagMacbeth.

CxF3: objects with a ReflectanceSpectrum or TransmittanceSpectrum: numbers from ``StartWL`` on, at
steps that the color specification tells. CxF2: samples with a Spectrum, of which each Value is
named by its wavelength. Read with Python's own XML parser, for the one other reader (colour-cxf) is
young and would bring two more wheels.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import number
from ..merging import together
from ..quantities import Said
from .spectra import table
from .xml_file import root_of, tag, values

NAME = "CxF"
ENDINGS = (".cxf",)

STEP = 10.0
"""[nm] between values where the file tells none: that of the instruments that write it."""

_SPECTRUM = re.compile(r"(\w*)Spectrum")


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is XML with that name."""
    return path.suffix.lower() == ".cxf" or (
        start.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<"
        and re.search(b"(?i)cxf", start) is not None
    )


def read(path: Path) -> Table:
    """Read all objects and samples that have a spectrum.

    Raises `InputError` for broken XML, one with a document type, spectra without a first wavelength
    and text among their numbers; `NoSpectra` where no object has one.
    """
    root = root_of(path)
    found = [*_of_version_3(path, root), *_of_version_2(path, root)]
    if not found:
        raise NoSpectra(path, "holds no spectrum", "export the measurement with spectra")
    names, classes, told, curves = zip(*found, strict=True)
    wavelengths, values = together(path, curves)
    return table(path, names, wavelengths, values, format=NAME, classes=classes).with_said(told)


_Found = tuple[str, str, Said, tuple[NDArray[np.float64], NDArray[np.float64]]]


def _of_version_3(path: Path, root: ET.Element) -> Iterator[_Found]:
    """Yield name, class, what is said and curve of each spectrum of each object."""
    ranges = {
        specification.get("Id"): found
        for specification in root.iterfind(".//{*}ColorSpecification")
        if (found := specification.find("{*}MeasurementSpec/{*}WavelengthRange")) is not None
    }
    for count, thing in enumerate(root.iterfind(".//{*}Object"), 1):
        name = thing.get("Name") or thing.get("Id") or f"object {count}"
        for spectrum in thing.iterfind("{*}ColorValues/*"):
            kind = _SPECTRUM.fullmatch(tag(spectrum))
            if kind is None:
                continue
            said = quantities.said(kind[1])
            place = f"{path}, object '{name}'"
            known = ranges.get(spectrum.get("ColorSpecification"))
            curve = _curve(place, spectrum, {} if known is None else known.attrib)
            light = said.quantity == quantities.TRANSMITTANCE
            kind_of_thing = "transmittance" if light else thing.get("ObjectType") or ""
            yield name, kind_of_thing, said if said.quantity else Said("light"), curve


def _of_version_2(path: Path, root: ET.Element) -> Iterator[_Found]:
    """Yield the same of each spectrum of each sample."""
    for count, sample in enumerate(root.iterfind(".//{*}Sample"), 1):
        title = sample.find("{*}Name")
        name = ((title.text if title is not None else "") or "").strip()
        name = name or sample.get("Name") or f"sample {count}"
        for attribute in sample.iterfind("{*}SampleAttribute"):
            for spectrum in attribute.iterfind("{*}Spectrum"):
                curve = _named(f"{path}, sample '{name}'", spectrum)
                words = " ".join(
                    str(e.get(key) or "") for e in (attribute, spectrum) for key in ("Type", "Name")
                )
                yield name, "", quantities.said(words), curve


def _named(place: str, spectrum: ET.Element) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return wavelengths [nm], by which the values are named or which are counted, and values."""
    cells = [one for one in spectrum if tag(one) == "Value"]
    named = [number((one.get("Name") or "").strip().removesuffix("nm").strip()) for one in cells]
    numbers = values(place, " ".join((one.text or "").strip() for one in cells))
    if len(numbers) != len(cells):
        raise InputError(place, "has values without a number", "export it again")
    if None not in named and named:
        return np.array(named, dtype=float), numbers

    def told(*keys: str) -> float | None:
        inside = (child.text for child in spectrum if tag(child) in keys)
        return number((next(inside, None) or "").strip())

    start, step = told("StartWL"), told("Increment", "Step", "Interval") or STEP
    if start is None:
        raise InputError(place, "has no first wavelength", "add StartWL")
    return start + step * np.arange(len(numbers)), numbers


def _curve(
    place: str, spectrum: ET.Element, known: Mapping[str, str]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return wavelengths [nm] and values of a spectrum, (k,) each."""
    told = spectrum.get("StartWL") or known.get("StartWL")
    if told is None:
        raise InputError(place, "has no first wavelength", "add StartWL")
    start = number(told)
    step = number(spectrum.get("Increment") or known.get("Increment") or f"{STEP}")
    numbers = values(place, spectrum.text or "")
    if start is None or step is None or not step > 0:
        raise InputError(place, f"starts at {told[:20]} nm, in steps of {step} nm", "correct them")
    return start + step * np.arange(len(numbers)), numbers
