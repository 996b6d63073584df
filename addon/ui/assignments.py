"""Whether the files that materials were given are as they were, and where moved ones are now."""

from __future__ import annotations

from typing import Any

import bpy

from ..errors import InputError
from . import choice, staleness_handlers


def refresh(library: Any) -> list[tuple[str, str]]:
    """Follow files that moved into the library, by what is in them; tell those that changed.

    Materials keep their reflectances whatever became of the files. ``library``: a
    `spectra.library.Library`. Returns (level, line) pairs.
    """
    from ..scene.materials import spectral_material

    managed = spectral_material.managed_materials()
    lines = [("INFO", line) for material in managed if (line := _follow(material, library))]
    changed, lost = choice.changed_files(managed)
    staleness_handlers.found_files(changed)
    lines += [("WARNING", f"{material.name}: {line}") for material, line in changed.items()]
    return [*lines, *(("WARNING", line) for line in lost)]


def _follow(material: bpy.types.Material, library: Any) -> str:
    """Choose what a material was given where the library has it now, if it is gone; say so."""
    from ..scene.materials import spectral_material

    own, managed = material.skylight, spectral_material.managed(material)
    if managed is None or not own.filepath or own.kind != "REFLECTANCE":
        return ""
    try:
        choice.read(material)
        return ""
    except InputError:
        pass
    try:
        number = library.hashes.index(managed.record.reflectance_hash)
        spectral_material.check_editable(material)
    except (ValueError, InputError):
        return ""
    own.filepath = library.paths[number]
    own.column = library.names[number]
    return f"{material.name}: its file was found at {own.filepath}"
