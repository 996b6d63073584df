"""What turns a spectrum into three numbers: the standard observer and cameras."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, parameter
from .curves import LIGHT
from .datasets import CAMERAS, CMFS, dataset, names
from .grid import WAVELENGTHS, WEIGHTS, resample
from .table import read_table
from .working_spaces import DEFAULT_SPACE, XYZ_to_working


@cache
def cmfs() -> NDArray[np.float64]:
    """Return the CIE 1931 2° colour matching functions on the grid, (3, 81).

    CIE 018:2019 (DOI 10.25039/TR.018.2019), from colour-science.
    """
    table = dataset(CMFS, "CIE 1931 2 Degree Standard Observer")
    # Tabulated at every nanometre: the grid's nodes are rows of the table.
    rows = np.searchsorted(table.wavelengths, WAVELENGTHS)
    functions = np.array(table.values[rows].T)
    functions.flags.writeable = False
    return functions


def observer(space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return the sensitivities of an observer who reads working-space RGB, (3, 81).

    Quadrature weights included: ``observer() @ spectrum`` is linear RGB, white at D65. Unscaled:
    the CIE functions' own size times nm. Raises `InputError` for an unknown ``space``.
    """
    return XYZ_to_working(space) @ (cmfs() * WEIGHTS)


def camera(name: str) -> NDArray[np.float64]:
    """Return a camera's spectral sensitivities, (3, 81), rows R, G, B.

    Quadrature weights included, unscaled. Zero outside the measured range.

    Parameters
    ----------
    name
        One of colour-science's cameras (case and spaces do not matter, the beginning is enough),
        or a CSV file: wavelength in nm, then R, G and B.

    Raises
    ------
    InputError
        Neither a known camera nor a file; a file that `read_table` refuses, that has not the
        columns R, G and B (or exactly three), holds NaN or does not cover 430-650 nm.
    """
    cameras = names(CAMERAS)
    known = {"".join(key.split()).casefold(): key for key in cameras}
    wanted = "".join(name.split()).casefold()
    matches = [key for short, key in known.items() if short.startswith(wanted)] if wanted else []
    if len(matches) == 1:
        wavelengths, values, _ = dataset(CAMERAS, matches[0])
    elif Path(name).exists():
        wavelengths, values = _read_camera(Path(name))
    else:
        raise InputError(
            parameter("camera"),
            f"'{name}' is neither a file nor a known camera",
            "give a CSV with the columns wavelength, R, G, B or one of "
            + ", ".join(f"'{key}'" for key in cameras),
        )
    measured = (wavelengths[0] <= WAVELENGTHS) & (wavelengths[-1] >= WAVELENGTHS)
    return resample(wavelengths, values) * measured * WEIGHTS


def _read_camera(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    table = read_table(path)
    headers = [name.strip().casefold()[:1] for name in table.names]
    if sorted(headers) == ["b", "g", "r"]:
        columns = [headers.index(channel) for channel in "rgb"]
    elif len(headers) == 3:
        columns = [0, 1, 2]
    else:
        raise InputError(
            path, f"the columns are {', '.join(table.names)}", "give wavelength, R, G and B"
        )
    values = table.values[:, columns]
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if bad.size:
        raise InputError(table.place(int(bad[0])), "not a number", "correct or remove the row")
    low, high = LIGHT[0] + 30, LIGHT[1] - 50
    if table.wavelengths[0] > low or table.wavelengths[-1] < high:
        raise InputError(
            path,
            f"covers {table.wavelengths[0]:g}-{table.wavelengths[-1]:g} nm",
            f"sensitivities must cover at least {low:g}-{high:g} nm",
        )
    return table.wavelengths, values
