"""What objects show while their new light is computed: the last light, as long as there is one.

A bake is laid out by evaluating objects with it. So each has two for a while, and shows the new one
only while the bake works, never while it waits between two steps.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import bpy

from ....node_groups import modifiers
from . import storage

INPUTS = "Bake", "Faces", "Near", "Back"
"""Of the modifier, which together are one bake."""


class Shelf:
    """Objects with their last bakes, and new ones that have no faces yet."""

    def __init__(self, objects: Sequence[bpy.types.Object]) -> None:
        self._objects = list(objects)
        self._old = [_inputs(obj) if storage.is_lit(obj) else None for obj in objects]
        self.bakes = [storage.new(obj) for obj in objects]
        """The new ones, in the order of the objects."""
        self._new = [_inputs(obj) for obj in objects]

    def show_old(self) -> None:
        """Let objects show their last light; those without any, the open sky."""
        for k, obj in enumerate(self._objects):
            self._new[k] = _inputs(obj)
            if (old := self._old[k]) is not None:
                modifiers.set_inputs(storage.modifier_of(obj), **old)

    def show_new(self) -> None:
        """Let objects show their new light."""
        for obj, old, new in zip(self._objects, self._old, self._new, strict=True):
            if old is not None:  # else it shows it already, and is not evaluated again
                modifiers.set_inputs(storage.modifier_of(obj), **new)

    def clear(self) -> None:
        """Take the last light away: the new one is there, and has its names."""
        last = [None if old is None else (old["Bake"], old["Bake"].name) for old in self._old]
        storage.discard(each[0] for each in last if each is not None)
        for bake, each in zip(self.bakes, last, strict=True):
            if each is not None and not is_there(each[0]):
                bake.name = bake.data.name = each[1]
        self._old = [None] * len(self._old)

    def give_back(self) -> None:
        """Take the new bakes away; objects without a last light lose the modifier too."""
        there = [
            (obj, old, new["Bake"])
            for obj, old, new in zip(self._objects, self._old, self._new, strict=True)
            if is_there(obj)
        ]
        storage.remove(obj for obj, old, _ in there if old is None)
        kept = [(obj, old, new) for obj, old, new in there if old is not None]
        for obj, old, _ in kept:
            modifiers.set_inputs(storage.modifier_of(obj), **old)
        storage.discard(new for _, _, new in kept)


def is_there(obj: bpy.types.Object) -> bool:
    """Whether an object has not been deleted while a bake waited."""
    try:
        return bool(obj.name)
    except ReferenceError:
        return False


def _inputs(obj: bpy.types.Object) -> dict[str, Any]:
    modifier = storage.modifier_of(obj)
    return {name: modifiers.get_input(modifier, name) for name in INPUTS}


def there(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return those that have not been deleted."""
    return [obj for obj in objects if is_there(obj)]
