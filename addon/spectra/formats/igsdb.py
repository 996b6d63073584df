"""Products of the International Glazing and Shading Database, as its JSON.

Lawrence Berkeley National Laboratory (https://igsdb.lbl.gov): transmittance and the reflectances of
both faces at normal incidence, wavelengths in µm. Version 1 has ``spectral_data``, version 2
``physical_properties`` with blocks of angles, in which the specular and the diffuse part are apart.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from .. import quantities
from ..curves import NoSpectra, Table
from ..files import content, number
from ..merging import together
from .spectra import table, to_nm

NAME = "IGSDB"
ENDINGS = (".json",)

TRANSMITTANCE = "transmittance"
QUANTITIES = (TRANSMITTANCE, "front reflectance", "back reflectance")

_KEYS = {
    TRANSMITTANCE: ("T", "Tf", "tf", "t"),
    "front reflectance": ("Rf", "rf", "R", "r"),
    "back reflectance": ("Rb", "rb"),
}
_WAVELENGTHS = ("wavelength", "w", "wl")
_PARTS = ("specular", "diffuse")


def recognises(path: Path, start: bytes) -> bool:
    """Whether it is JSON, by its ending and first character."""
    head = start.removeprefix(b"\xef\xbb\xbf").lstrip()
    return path.suffix.lower() == ".json" and head[:1] in (b"{", b"[")


def read(path: Path) -> Table:
    """Read up to three curves of each product: "NAME transmittance" and so on.

    Raises `InputError` for broken JSON and for values that are no numbers, `NoSpectra` for JSON of
    anything else.
    """
    try:
        # Python's own integers have any number of digits: they would overflow, or take long.
        found = json.loads(content(path).decode("utf-8-sig"), parse_int=_plain, parse_float=_plain)
    except (ValueError, RecursionError) as error:
        raise InputError(path, f"is broken JSON ({error})", "get the file again") from None
    names, curves, classes, told = [], [], [], []
    for product in _products(found):
        rows = _rows(product)
        said = product.get("name")
        title = said if isinstance(said, str) and said.strip() else path.stem
        for quantity, keys in _KEYS.items():
            pairs = [pair for row in rows if (pair := _pair(path, row, quantity, keys)) is not None]
            if not pairs:
                continue
            data = np.array(pairs, dtype=float)
            names.append(f"{title} {quantity}")
            curves.append((to_nm(path, data[:, 0]), data[:, 1]))
            classes.append(f"glazing, {quantity}")
            told.append(quantities.said(quantity).quantity)
    if not curves:
        raise NoSpectra(path, "holds no spectral_data", "give a product of the IGSDB")
    wavelengths, values = together(path, curves)
    return table(
        path,
        names,
        wavelengths,
        values,
        format=NAME,
        unit=quantities.FRACTION,
        quantity=told,
        classes=classes,
    )


def _plain(digits: str) -> float:
    return value if (value := number(digits)) is not None else float("nan")


def _products(found: Any) -> Iterator[dict[str, Any]]:
    """Yield the products of a file: one, a list, or a page of an answer (``results``)."""
    if isinstance(found, dict) and isinstance(found.get("results"), list):
        found = found["results"]
    yield from (
        one for one in (found if isinstance(found, list) else [found]) if isinstance(one, dict)
    )


def _rows(product: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the measurements by wavelength, wherever the version of the record has them."""
    data: Any = product.get("spectral_data")
    while isinstance(data, dict):
        data = data.get("spectral_data")
    if not isinstance(data, list):
        data = _at_normal_incidence(product)
    return [row for row in data if isinstance(row, dict) and _wavelength(row) is not None]


def _at_normal_incidence(product: dict[str, Any]) -> list[Any]:
    """Return the rows of the block of the smallest angle; of version 2."""
    place: Any = product
    for key in ("physical_properties", "optical_properties", "optical_data"):
        inner = place.get(key) if isinstance(place, dict) else None
        place = inner if inner is not None else place
    blocks = place.get("angle_blocks") if isinstance(place, dict) else None
    known = [
        block
        for block in (blocks if isinstance(blocks, list) else [])
        if isinstance(block, dict) and isinstance(block.get("wavelength_data"), list)
    ]

    def angle(block: dict[str, Any]) -> float:
        found = _number(block.get("incidence_angle", 0.0))
        return float("inf") if found is None or not np.isfinite(found) else abs(found)

    return min(known, key=angle)["wavelength_data"] if known else []


def _wavelength(row: dict[str, Any]) -> Any:
    return next((row[key] for key in _WAVELENGTHS if row.get(key) is not None), None)


def _number(value: Any) -> float | None:
    if isinstance(value, str):
        return number(value)
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _pair(
    path: Path, row: dict[str, Any], quantity: str, keys: tuple[str, ...]
) -> tuple[float, float] | None:
    """Return a wavelength and a value, specular and diffuse light together; None without one."""
    parts = [row[part] for part in _PARTS if isinstance(row.get(part), dict)] or [row]
    told = [
        value
        for part in parts
        if (value := next((part[k] for k in keys if part.get(k) is not None), None)) is not None
    ]
    if not told:
        return None
    values = [_number(value) for value in (_wavelength(row), *told)]
    if None in values:
        raise InputError(
            f"{path}, spectral_data", f"{quantity} holds no numbers", "get the file again"
        )
    at, *shares = (float(value) for value in values if value is not None)
    return at, sum(shares)
