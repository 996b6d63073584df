"""XML of spectra, read with Python's own parser: without entities, which can grow endlessly."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..files import content, number


class _Plain(ET.TreeBuilder):
    """A builder that refuses a document type: with it come entities."""

    def doctype(self, name, pubid, system):
        raise ValueError("it declares a document type")


def root_of(path: Path) -> ET.Element:
    """Return the root; `InputError` for broken XML and one with a document type."""
    try:
        return ET.XML(content(path), ET.XMLParser(target=_Plain()))
    except (ET.ParseError, ValueError, LookupError, RecursionError) as error:
        raise InputError(path, f"is broken XML ({error})", "export it again") from None


def tag(element: ET.Element) -> str:
    """Return an element's name without its namespace."""
    return str(element.tag).rpartition("}")[2]


def values(place: str, words: str) -> NDArray[np.float64]:
    """Return the numbers in a text, (k,); `InputError` for anything else among them."""
    found = []
    for word in re.split(r"[\s;]+", words.strip()) if words.strip() else []:
        one = number(word)
        if one is None:
            raise InputError(place, f"could not convert '{word[:40]}' to a number", "correct it")
        found.append(one)
    return np.array(found, dtype=float)
