"""Published tables that come from colour-science, in one small file that is read when first needed.

``.ci/datasets/write.py`` writes the file. It holds every table as it is in colour-science, so that
nothing else of it is needed to run: importing it takes seconds.
"""

from __future__ import annotations

import json
import zlib
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

FILE = Path(__file__).with_name("datasets.npz")

CMFS, SUNLIGHT, DAYLIGHT = "cmfs", "sunlight", "daylight"
ILLUMINANTS, LIGHT_SOURCES = "illuminants", "light sources"
CAMERAS, CHECKERS, BASIS_REFLECTANCES = "cameras", "checkers", "basis reflectances"
TEST_COLOURS = "test colours"
"""The kinds of tables."""

ABOUT = "about"
"""The member of the file that holds `about` as JSON; all others are called ``KIND/NAME``."""


class Dataset(NamedTuple):
    """A published table: ``wavelengths`` [nm] (k,), ``values`` (k, m), ``columns`` (m) names."""

    wavelengths: NDArray[np.float64]
    values: NDArray[np.float64]
    columns: tuple[str, ...]


def dataset(kind: str, name: str) -> Dataset:
    """Return a table by its kind and colour-science's name for it, as it was published.

    Raises `InputError` where the file is missing or damaged, `KeyError` for a table that it lacks.
    """
    table = _member(f"{kind}/{name}")
    return Dataset(table[:, 0], table[:, 1:], tuple(about()["columns"][kind][name]))


def names(kind: str) -> tuple[str, ...]:
    """Return the names of all tables of a kind, in colour-science's order."""
    return tuple(about()["columns"][kind])


@cache
def about() -> dict[str, Any]:
    """Return where the tables come from.

    ``library``, ``version``, ``url`` and ``license`` of colour-science, ``sources``: the published
    source of each kind, ``columns``: what each table's columns are called, by kind and name.
    """
    return json.loads(_member(ABOUT).tobytes())


def _member(name: str) -> NDArray:
    try:
        return _file()[name]
    except (OSError, ValueError, EOFError, BadZipFile, zlib.error) as error:
        raise InputError(FILE, f"cannot be read ({error})", "install the add-on again") from error


@cache
def _file() -> Any:
    """Return the open file: it stays in memory, and its tables are unpacked when asked for."""
    return np.load(BytesIO(FILE.read_bytes()), allow_pickle=False)
