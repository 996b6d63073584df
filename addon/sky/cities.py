"""Cities of the world, found by their names: where they lie and which time zone they keep.

From GeoNames (https://www.geonames.org), CC BY 4.0: 34,000 cities of 15,000 people or more;
`.ci/datasets/cities.py` writes the file. Large ones are also found by names in other languages.
"""

from __future__ import annotations

import json
import unicodedata
from dataclasses import dataclass
from functools import cache
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, parameter

FILE = Path(__file__).with_name("cities.npz")

_PLAIN = str.maketrans({"ø": "o", "ł": "l", "đ": "d", "ı": "i", "æ": "ae", "œ": "oe", "ʻ": "'"})
"""Letters that Unicode does not take apart into a plain one and its mark."""


@dataclass(frozen=True)
class City:
    """A city: ``latitude`` and ``longitude`` [degrees] to 0.01°, ``timezone``: its zone's name.

    ``region``: its country; in the United States its state before that.
    """

    name: str
    region: str
    latitude: float
    longitude: float
    timezone: str

    @property
    def label(self) -> str:
        """How it is told apart: ``Paris, France``."""
        return f"{self.name}, {self.region}"


def suggestions(text: str, most: int = 24) -> list[str]:
    """Return labels of cities of which a name, or a word of it, begins with a text.

    Names that are the text come first, then those that begin with it, then other languages' and
    words; of each kind the largest city first, under the name that fits, so that `city` finds it
    again. Upper case and accents do not matter.
    """
    name, fits = _asked(text)
    if not name:
        return []
    names = _names()
    kinds: tuple[list[int], ...] = ([], [], [], [])
    for k, one in enumerate(names.folded):
        if not (fits is None or fits[names.rows[k]]):
            continue
        if one.startswith(name):
            kinds[0 if one == name else 1 if names.is_first[k] else 2].append(k)
        elif f" {name}" in one:
            kinds[3].append(k)
    found: dict[int, str] = {}
    for k in chain(*kinds):
        found.setdefault(names.rows[k], f"{names.spelled[k]}, {_region(names.rows[k])}")
        if len(found) == most:
            break
    return list(found.values())


def city(text: str) -> City:
    """Return the largest city of a name, ``Paris``, or of that in a region, ``Paris, Texas``.

    Upper case and accents do not matter. Raises InputError for one that is not in the list, naming
    those that begin alike.
    """
    name, fits = _asked(text)
    names = _names()
    for k, one in enumerate(names.folded):
        row = names.rows[k]
        if one == name and (fits is None or fits[row]):
            latitude, longitude = (_array("places")[:, row] / 100.0).tolist()
            zone = _about()["zones"][_array("zones")[row]]
            return City(names.spelled[k], _region(row), latitude, longitude, zone)
    alike = suggestions(name, 3)
    cure = f"did you mean {' or '.join(alike)}?" if alike else "give the nearest large one"
    raise InputError(parameter("city"), f"'{text}' is not in the list", cure)


def folded(text: str) -> str:
    """Return a text as it is compared: no upper case, no accents."""
    text = text.casefold()
    if text.isascii():  # most are, and there are 90,000
        return text
    apart = unicodedata.normalize("NFKD", text)
    return "".join(letter for letter in apart if not unicodedata.combining(letter)).translate(
        _PLAIN
    )


@dataclass(frozen=True)
class _Names:
    """All names, the largest city's first: as they are compared and spelled, and whose they are.

    ``is_first``: whether it is the name that the list goes by.
    """

    folded: list[str]
    spelled: list[str]
    rows: list[int]
    is_first: list[bool]


@cache
def _names() -> _Names:
    first = _text("names").split("\n")
    others = _text("others").split("\n")
    spelled, rows, is_first = [], [], []
    for row, name in enumerate(first):
        more = others[row].split("\t") if row < len(others) and others[row] else []
        spelled += [name, *more]
        rows += [row] * (1 + len(more))
        is_first += [True, *([False] * len(more))]
    return _Names([folded(name) for name in spelled], spelled, rows, is_first)


def _asked(text: str) -> tuple[str, NDArray[np.bool_] | None]:
    """Return the name that a text asks for, and which cities lie in its region; None: any may."""
    name, comma, region = (part.strip() for part in folded(text).partition(","))
    return name, _in_region(region) if comma else None


def _region(row: int) -> str:
    return _about()["regions"][_array("regions")[row]]


def _in_region(start: str) -> NDArray[np.bool_]:
    """Return of each city whether its region, or a part of that, begins with a text."""
    parts = [[part.strip() for part in folded(one).split(",")] for one in _about()["regions"]]
    whole = [", ".join(each) for each in parts]
    fits = [
        one.startswith(start) or any(part.startswith(start) for part in each)
        for one, each in zip(whole, parts, strict=True)
    ]
    return np.array(fits)[_array("regions")]


@cache
def _about() -> dict[str, list[str]]:
    return json.loads(_text("about"))


def _text(name: str) -> str:
    return _array(name).tobytes().decode()


@cache
def _array(name: str) -> NDArray:
    with np.load(FILE, allow_pickle=False) as file:
        return file[name]
