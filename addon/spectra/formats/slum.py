"""The Spectral Library of impervious Urban Materials (London), a CSV of 74 samples by number.

S. Kotthaus et al. 2014 (DOI 10.1016/j.isprsjprs.2014.05.005). The letter of a sample's number says
what it is, which people search for.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from ..curves import Table
from ..table import read_table

NAME = "SLUM"
ENDINGS = (".csv",)

KINDS = {
    "A": "asphalt",
    "B": "brick",
    "C": "concrete",
    "G": "granite",
    "L": "roofing, dark",
    "R": "roof tile or shingle",
    "S": "stone",
    "V": "PVC",
    "X": "mixed",
    "Z": "metal",
}

_HEADER = re.compile(rb'"?wavelength[^,;\t\r\n]*[,;\t](("?[A-Z]\d{3}[a-z]?"?)[,;\t\r\n]+)+')


def recognises(path: Path, start: bytes) -> bool:
    """Whether all columns are named by a letter of the library and three digits."""
    match = _HEADER.match(start.removeprefix(b"\xef\xbb\xbf"))
    return match is not None and match[0].endswith((b"\n", b"\r"))


def read(path: Path) -> Table:
    """Read the table, with what each sample is. Raises as `read_table` does."""
    read = read_table(path)
    return replace(read, format=NAME, classes=tuple(KINDS.get(name[:1], "") for name in read.names))
