"""Products of the International Glazing and Shading Database, as its JSON.

Lawrence Berkeley National Laboratory (https://igsdb.lbl.gov): transmittance and the reflectances of
both faces at normal incidence, wavelengths in µm.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ..table import NoSpectra, Table
from .spectra import content, table, to_nm, together

NAME = "IGSDB"
ENDINGS = (".json",)

TRANSMITTANCE = "transmittance"
_QUANTITIES = {
    TRANSMITTANCE: ("T", "Tf", "tf"),
    "front reflectance": ("Rf", "rf"),
    "back reflectance": ("Rb", "rb"),
}


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
        found = json.loads(content(path).decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError(path, f"is broken JSON ({error})", "take it anew") from None
    names, curves, classes = [], [], []
    for product in found if isinstance(found, list) else [found]:
        records = _records(product)
        title = str(product.get("name") or path.stem) if records else ""
        for quantity, keys in _QUANTITIES.items():
            pairs = [
                (record["wavelength"], value)
                for record in records
                if (value := next((record[k] for k in keys if record.get(k) is not None), None))
                is not None
            ]
            if not pairs:
                continue
            try:
                data = np.array(pairs, dtype=float)
            except (TypeError, ValueError):
                raise InputError(
                    f"{path}, spectral_data", f"{quantity} holds no numbers", "take it anew"
                ) from None
            names.append(f"{title} {quantity}")
            curves.append((to_nm(path, data[:, 0]), data[:, 1]))
            classes.append(f"glazing, {quantity}")
    if not curves:
        raise NoSpectra(path, "holds no spectral_data", "give a product of the IGSDB")
    wavelengths, values = together(path, curves)
    return table(path, names, wavelengths, values, unit="fraction", classes=classes)


def _records(product: Any) -> list[dict[str, Any]]:
    """Return the measurements by wavelength, wherever the version of the record has them."""
    data = product.get("spectral_data") if isinstance(product, dict) else None
    while isinstance(data, dict):
        data = data.get("spectral_data")
    rows = data if isinstance(data, list) else []
    return [row for row in rows if isinstance(row, dict) and row.get("wavelength") is not None]
