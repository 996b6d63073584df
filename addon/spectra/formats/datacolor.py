"""Samples of Datacolor's programs as text, ``.qtx``: sections of ``KEY=value``, in percent.

Each section (``[STANDARD_DATA 0]``, ``[BATCH_DATA 0 1]``) tells the first wavelength, the step and
the reflectances: ``STD_REFLLOW``, ``STD_REFLINTERVAL``, ``STD_R``; ``BAT_…`` likewise.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import lines, number
from ..merging import together
from .spectra import table

NAME = "Datacolor QTX"
ENDINGS = (".qtx",)

_SECTION = re.compile(r"\s*\[(?P<name>[^\]]{1,60})\]\s*$")
_SPECTRUM = re.compile(r"(?P<prefix>\w*?)_?(?P<what>R|T|REFL|TRANS)(_?VALUES)?", re.IGNORECASE)


def recognises(path: Path, start: bytes) -> bool:
    """Whether a section or key of theirs stands at its beginning."""
    text = start.replace(b"\0", b"")
    return re.search(rb"^\s*(\[(STANDARD|BATCH)_DATA|(STD|BAT)_\w+\s*=)", text, re.M) is not None


def read(path: Path) -> Table:
    """Read the spectra of all sections.

    Raises `InputError` for a spectrum without its first wavelength or step, of another count than
    told, and with text among its numbers; `NoSpectra` where no section has one.
    """
    names, curves, told, classes = [], [], [], []
    for title, first, fields in _sections(path):
        for key, (line, said) in fields.items():
            match = _SPECTRUM.fullmatch(key)
            if match is None:
                continue
            prefix = f"{match['prefix']}_" if match["prefix"] else ""
            low, step, count = (
                _number(path, fields, f"{prefix}{name}")
                for name in ("REFLLOW", "REFLINTERVAL", "REFLPOINTS")
            )
            values = [number(cell.strip()) for cell in re.split(r"[,;\s]+", said) if cell.strip()]
            if None in values or not values:
                raise InputError(f"{path}:{line}", f"{key} holds no numbers", "export it again")
            if low is None or not step or step < 0:
                raise InputError(
                    f"{path}:{first}", f"[{title}] has no wavelengths", "export it again"
                )
            if count is not None and count != len(values):
                raise InputError(
                    f"{path}:{line}",
                    f"{len(values)} values where {count:g} are announced",
                    "export it again",
                )
            curves.append((low + step * np.arange(len(values)), np.array(values, dtype=float)))
            named = fields.get(f"{prefix}NAME", (0, ""))[1] or title
            names.append(named)
            classes.append(fields.get(f"{prefix}VIEWING", (0, ""))[1])
            light = match["what"][0].upper() == "T"
            told.append(quantities.TRANSMITTANCE if light else quantities.REFLECTANCE)
    if not curves:
        raise NoSpectra(path, "holds no spectrum", "export the samples with reflectances")
    everywhere, values = together(path, curves)
    # They write percent; only where all could be fractions too is it not taken for granted.
    unit = quantities.PERCENT if np.nanmax(values) > 2.0 else quantities.UNCLEAR
    return table(
        path, names, everywhere, values, format=NAME, unit=unit, quantity=told, classes=classes
    )


def _sections(path: Path):
    """Yield name, line and fields (line, value) of each section."""
    title, first = "", 1
    fields: dict[str, tuple[int, str]] = {}
    key = ""
    for place, line in enumerate(lines(path), 1):
        section = _SECTION.match(line)
        if section:
            if fields:
                yield title, first, fields
            title, first, fields, key = section["name"], place, {}, ""
            continue
        name, equals, said = line.partition("=")
        if equals:
            key = name.strip().upper()
            fields[key] = (place, said.strip())
        elif line.strip() and key:  # a list that goes on
            begun, so_far = fields[key]
            if len(so_far) < 1 << 16:
                fields[key] = (begun, f"{so_far},{line.strip()}")
    if fields:
        yield title, first, fields


def _number(path: Path, fields: dict[str, tuple[int, str]], key: str) -> float | None:
    line, said = fields.get(key, (0, ""))
    if not said:
        return None
    found = number(said.strip(" ,;\t"))
    if found is None or not np.isfinite(found):
        raise InputError(f"{path}:{line}", f"{key} is '{said[:40]}'", "export it again")
    return found
