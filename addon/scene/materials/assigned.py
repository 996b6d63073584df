"""What a material was given, read back from what it keeps."""

from __future__ import annotations

import bpy

from ... import tags
from ...transfer.assignment import Assignment
from . import glass_and_metal, spectral_material


def assigned(material: bpy.types.Material) -> Assignment | None:
    """Return what a material was given, an estimate too; None for one that is not ours.

    A file of the first version holds no values: None.
    """
    if glass_and_metal.pane_node(material) is not None:
        return glass_and_metal.pane_of(material)
    managed = spectral_material.managed(material)
    if managed is None or not managed.details.values:
        return None
    details = managed.details
    return Assignment(
        managed.record.reflectance,
        managed.values,
        metal=glass_and_metal.metal_of(material),
        unit=details.unit,
        measured=details.measured,
        source=details.file,
        behind=details.behind,
    )


def in_file() -> dict[str, Assignment]:
    """Return what the materials of the file were given, by name; linked ones are left out."""
    ours = [m for m in bpy.data.materials if tags.MATERIAL in m and m.library is None]
    found = {material.name: assigned(material) for material in ours}
    return {name: one for name, one in found.items() if one is not None}
