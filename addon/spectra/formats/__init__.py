"""Files of reflectances as the world publishes them: one module a format, one way to read all.

A module has ``NAME``, ``ENDINGS``, ``recognises(path, start)`` by a file's first bytes, and
``read(path)``, which returns a `Table`. What no module recognises is a text with numbers in columns
or rows. The rules for what a reflectance may be are not here: `reflectance` holds them for all.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from ..curves import Table
from ..files import start
from ..quantities import FRACTION, REFLECTANCE, Said
from ..table import read_table
from . import (
    built_in,
    cgats,
    cxf,
    datacolor,
    ecostress,
    envi,
    igdb,
    igsdb,
    jcamp,
    matlab,
    slum,
    splib07,
    tm27,
)

FORMATS = (
    envi,
    matlab,
    igsdb,
    tm27,
    cxf,
    jcamp,
    datacolor,
    cgats,
    igdb,
    ecostress,
    splib07,
    slum,
)

TABLES = (".csv", ".tsv", ".txt", ".spd", ".dat", ".asc", ".sed", ".sig", ".ttt", ".trt", ".tab")
"""Endings of texts in columns or rows: spreadsheets', renderers' and instruments'."""

ENDINGS = tuple(sorted({ending for module in FORMATS for ending in module.ENDINGS} | set(TABLES)))
"""What files of reflectances may end in, in small letters."""


def read(path: str | Path) -> Table:
    """Read the spectra of a file of any format, or of a set that is `built_in`.

    Raises
    ------
    InputError
        What cannot be read, or is broken, with file, place and cure. `curves.NoSpectra` where the
        file is whole but is about something else.
    """
    if built_in.recognises(str(path)):
        found = built_in.read(str(path))
        return found.with_said([Said(REFLECTANCE, FRACTION)] * len(found.names))
    path = Path(path)
    return _read(path, tuple(map(_state, (path, *companions(path)))))


@lru_cache(maxsize=1)
def _read(path: Path, _states: tuple[tuple[int, int], ...]) -> Table:
    """Read a file once for all its columns, which materials ask for one after another."""
    head = start(path)
    module = next((each for each in FORMATS if each.recognises(path, head)), None)
    table = read_table(path) if module is None else module.read(path)
    for values in (table.wavelengths, table.values):
        values.flags.writeable = False
    return table


def _state(path: Path) -> tuple[int, int]:
    """What tells a file from an earlier one of its name."""
    try:
        found = path.stat()
    except (OSError, ValueError):  # who reads it says what is wrong
        return (0, 0)
    return found.st_mtime_ns, found.st_size


def companions(path: Path) -> tuple[Path, ...]:
    """Return the other files that reading this one looks into."""
    if path.suffix.lower() in envi.ENDINGS:
        return (envi.header_of(path),)
    if splib07.PREFIX.match(path.name):
        return splib07.wavelength_files(path)
    return ()
