"""What we keep as custom properties, read back: as it was, or as not there.

Anyone can change a custom property by hand or from a script. What is not of the kind that we wrote
counts as missing; no reader trusts more than these give.
"""

from __future__ import annotations

import json
import sys
from typing import Any, TypeVar

import bpy

T = TypeVar("T")
D = TypeVar("D", bound=bpy.types.ID)


def mapping(owner: bpy.types.bpy_struct, key: str) -> dict[str, Any]:
    """Return a property that is a group of others, empty where it is none."""
    found = owner.get(key)
    return found.to_dict() if hasattr(found, "to_dict") else {}


def numbers(owner: bpy.types.bpy_struct, key: str, count: int) -> tuple[float, ...]:
    """Return a property that is an array of so many finite numbers, empty where it is not."""
    found = owner.get(key)
    values = tuple(found.to_list()) if hasattr(found, "to_list") else ()
    right = len(values) == count and all(is_number(value) for value in values)
    return values if right else ()


def text(owner: bpy.types.bpy_struct, key: str) -> str:
    """Return a property that is text, empty where it is not."""
    found = owner.get(key)
    return found if isinstance(found, str) else ""


def data(owner: bpy.types.bpy_struct, key: str, kind: type[D]) -> D | None:
    """Return a property that is blend data of a kind, None where it is none."""
    found = owner.get(key)
    return found if isinstance(found, kind) else None


def plain(owner: bpy.types.bpy_struct, key: str, default: T) -> T:
    """Return what a property holds as JSON, ``default`` where that is of another type."""
    return parsed(text(owner, key), default)


def parsed(text: str, default: T) -> T:
    """Return what text holds as JSON, ``default`` where that is of another type."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return default
    return found if isinstance(found, type(default)) else default


def is_number(value: Any) -> bool:
    """Whether a value is a finite number, and no switch."""
    return type(value) in (int, float) and abs(value) <= sys.float_info.max


def are_numbers(value: Any, count: int | None = None) -> bool:
    """Whether a value is a sequence of finite numbers, of so many."""
    listed = isinstance(value, list | tuple) and all(is_number(each) for each in value)
    return listed and (count is None or len(value) == count)


def are_texts(value: Any) -> bool:
    """Whether a value is a sequence of texts."""
    return isinstance(value, list | tuple) and all(isinstance(each, str) for each in value)
