"""Whether the files that materials were given are as they were, and where moved ones are now."""

from __future__ import annotations

from typing import Any

import bpy

from ..errors import InputError
from . import choice


def refresh(library: Any) -> list[tuple[str, str]]:
    """Follow files that moved into the library, by what is in them; tell those that changed.

    Materials keep their reflectances whatever became of the files. ``library``: a
    `spectra.library.Library`. Returns (level, line) pairs.
    """
    from ..scene import materials
    from ..spectra.reflectance import reflectance_hash

    lines = []
    for material in bpy.data.materials:
        own, managed = material.skylight, materials.managed(material)
        if managed is None or not own.filepath or own.kind != "REFLECTANCE":
            continue
        try:
            now = reflectance_hash(choice.read(own, material).values)
        except InputError as error:
            lines.append(_follow(material, managed.reflectance_hash, library, str(error)))
            continue
        if now != managed.reflectance_hash:
            said = f"{own.filepath} has changed since it was applied: apply it to take it over"
            lines.append(("WARNING", f"{material.name}: {said}"))
    return lines


def _follow(material: bpy.types.Material, was: str, library: Any, error: str) -> tuple[str, str]:
    """Find what a material was given elsewhere in the library, and choose it there."""
    from ..scene import materials

    try:
        number = library.hashes.index(was)
        materials.check_editable(material)
    except (ValueError, InputError):
        return ("WARNING", f"{material.name} keeps what it was given, but {error}")
    own = material.skylight
    own.filepath = library.paths[number]
    own.column = library.names[number]
    return ("INFO", f"{material.name}: its file is found at {own.filepath}")
