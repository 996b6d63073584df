"""Sets of reflectances that need no file: checkers, and the building materials that ship."""

from __future__ import annotations

from dataclasses import replace

from ..table import Table
from . import building_materials, checkers

SETS = (
    *(checkers.PREFIX + name for name in checkers.CHECKERS),
    *(building_materials.PREFIX + name for name in building_materials.SETS),
)
"""The names of all, as one gives them where a file is asked for."""


def recognises(path: str) -> bool:
    """Whether a path is the name of such a set, with or without a column's."""
    return path.startswith((checkers.PREFIX, building_materials.PREFIX))


def split(text: str) -> tuple[str, str]:
    """Split ``PREFIX:SET[:COLUMN]`` into the set's name and the column's, empty without."""
    prefix, _, rest = text.partition(":")
    name, _, column = rest.partition(":")
    return f"{prefix}:{name}", column


def read(path: str) -> Table:
    """Return a set's reflectances; `InputError` for one that is not there."""
    if path.startswith(checkers.PREFIX):
        return replace(checkers.read(path), format="colour-science")
    return replace(building_materials.read(path), format="building materials")
