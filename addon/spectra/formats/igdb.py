"""Products of the International Glazing Database as text: braces, then four columns of numbers.

LBNL, "IGDB data file format" (https://windows.lbl.gov/igdb-data-submission): wavelength in µm (or
as its first line says), transmittance, front and back reflectance at normal incidence, fractions.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import lines, number
from ..merging import told_apart
from .igsdb import QUANTITIES
from .spectra import table, to_nm

NAME = "IGDB"
ENDINGS = (".dat", ".txt")

_FIELD = re.compile(r"\s*\{(?P<key>[^}]{0,400})\}\s*(?P<value>.{0,400})$")


def recognises(path: Path, start: bytes) -> bool:
    """Whether it begins with a line in braces that names units or a thickness."""
    return (
        re.match(rb"(\xef\xbb\xbf)?\s*\{\s*(Units|Thickness)\b", start, re.IGNORECASE) is not None
    )


def read(path: Path) -> Table:
    """Read the transmittance and both reflectances of a product.

    Raises `InputError` for rows that are not four numbers, `NoSpectra` for a file without.
    """
    fields: dict[str, str] = {}
    rows, places = [], []
    for place, line in enumerate(lines(path), 1):
        match = _FIELD.match(line)
        if match:
            key, colon, inside = match["key"].partition(":")
            fields[key.strip().casefold()] = (inside if colon else match["value"]).strip()
            continue
        cells = re.split(r"[\s,;]+", line.strip()) if line.strip() else []
        values = [number(cell) for cell in cells if cell]
        if not values or (None in values and not rows):
            continue
        if None in values or len(values) != 4:
            raise InputError(
                f"{path}:{place}", f"'{line.strip()[:40]}' is not four numbers", "correct the row"
            )
        rows.append(values)
        places.append(place)
    if not rows:
        raise NoSpectra(path, "holds no rows of numbers", "export the product with its spectrum")
    data = np.array(rows, dtype=float)
    unit = next((said for key, said in fields.items() if "wavelength unit" in key), "")
    unit = next((word for word in unit.split() if word.casefold() not in ("si", "ip")), "")
    name = fields.get("product name") or path.stem
    return table(
        path,
        told_apart([f"{name} {quantity}" for quantity in QUANTITIES]),
        to_nm(path, data[:, 0], unit),
        data[:, 1:],
        format=NAME,
        unit=quantities.FRACTION,
        quantity=[quantities.said(quantity).quantity for quantity in QUANTITIES],
        classes=[f"glazing, {quantity}" for quantity in QUANTITIES],
        lines=np.array(places),
    )
