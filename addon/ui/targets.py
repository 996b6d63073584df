"""Which materials an operator is meant for, and which of them can be changed."""

from __future__ import annotations

import bpy

from ..errors import InputError


def active(context: bpy.types.Context) -> bpy.types.Material | None:
    """The material that the properties editor shows, else the active object's."""
    shown = getattr(context, "material", None)
    return shown or getattr(context.view_layer.objects.active, "active_material", None)


def named(context: bpy.types.Context, name: str) -> bpy.types.Material:
    """The material of this name, the active one where it is empty; InputError without."""
    from ..scene.files import blend_file

    if name:
        return blend_file.material(name)
    material = active(context)
    if material is None:
        raise InputError("the scene", "has no active material", "select an object with a material")
    return material


def selected(context: bpy.types.Context) -> list[bpy.types.Material]:
    """The materials of the selected objects, each once."""
    from ..scene.materials import spectral_material

    return spectral_material.materials_of(context.view_layer.objects.selected)
