"""Giving materials the reflectance that is chosen in the library."""

# mypy: disable-error-code="valid-type"

from typing import Any

import bpy

from . import apply, choice, library_state, operator, targets


class Assign(apply.Apply):
    """Gives materials the reflectance that is chosen in the list; without a sky it is kept ready.

    A script names file and column, or searches the library by them.
    """

    @classmethod
    def hindrance(cls, context):
        if library_state.chosen(context) is None:
            return "Show the library and choose a reflectance first"
        return cls.nothing_to_do(context)

    def run(self, context):
        number = library_state.chosen(context)
        found = library_state.library
        self.filepath, self.column = found.paths[number], found.names[number]
        self.kind = kind(found.classes[number])
        return give(self, context)


def kind(of: str) -> str:
    """What a material is made of by the class of its curve."""
    return "GLASS" if of.endswith("transmittance") else "REFLECTANCE"


def give(self: Any, context: bpy.types.Context) -> list[tuple[str, str]]:
    """Apply an operator's file to its targets, or where there is no sky keep it with them."""
    if not operator.no_sky(context):
        return apply.Apply.run(self, context)
    found, lines = targets.editable(self.targets(context))
    read = {material: choice.read(self, material) for material in found}
    for material, one in read.items():
        choice.keep(material.skylight, self, one.column)
    said = "chosen; it shows once the World has a sky and it is applied"
    return [*lines, *(("INFO", f"{m.name}: {one.column} is {said}") for m, one in read.items())]


class SKYLIGHT_OT_assign_to_active(Assign, bpy.types.Operator):
    """Give the active material the reflectance that is chosen in the library"""

    bl_idname = "skylight.assign_to_active"
    bl_label = "Assign to Active"

    material: bpy.props.StringProperty(name="Material", description="Empty: the active one")

    @classmethod
    def nothing_to_do(cls, context):
        return "" if targets.active(context) else "Select an object with a material"

    def targets(self, context):
        return [targets.named(context, self.material)]


class SKYLIGHT_OT_assign_to_selected(Assign, bpy.types.Operator):
    """Give the materials of all selected objects the reflectance that is chosen in the library"""

    bl_idname = "skylight.assign_to_selected"
    bl_label = "To Selection"

    @classmethod
    def nothing_to_do(cls, context):
        return "" if targets.selected(context) else "Select objects with materials"

    def targets(self, context):
        return targets.selected(context)


CLASSES = (SKYLIGHT_OT_assign_to_active, SKYLIGHT_OT_assign_to_selected)
