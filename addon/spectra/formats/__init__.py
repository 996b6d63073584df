"""Files of reflectances as the world publishes them: one module a format, one way to read all.

A module has ``NAME``, ``ENDINGS``, ``recognises(path, start)`` by a file's first bytes, and
``read(path)``, which returns a `Table`. What no module recognises is a text with numbers in columns
or rows. The rules for what a reflectance may be are not here: `reflectance` holds them for all.
"""

from __future__ import annotations

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
    head = start(path)
    for module in FORMATS:
        if module.recognises(path, head):
            return module.read(path)
    return read_table(path)


def companions(path: Path) -> tuple[Path, ...]:
    """Return the other files that reading this one looks into."""
    if path.suffix.lower() in envi.ENDINGS:
        return (envi.header_of(path),)
    if splib07.PREFIX.match(path.name):
        return splib07.wavelength_files(path)
    return ()
