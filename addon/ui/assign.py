"""Giving materials the reflectance that is chosen in the library."""

# mypy: disable-error-code="valid-type"

import bpy

from . import choice, give, library_state, operator, targets


class Assign(choice.Fields, operator.Long):
    """What the operators share; without a sky it is kept ready with the material."""

    doing = "Assigning"

    @classmethod
    def disabled_reason(cls, context):
        if library_state.seen(context) is None:
            return "Show the library and choose a row of its list first"
        return cls.nothing_to_do(context)

    @classmethod
    def nothing_to_do(cls, context):
        return ""

    def work(self, context):
        from ..scene import use_cases

        number = library_state.seen(context)
        library = library_state.library
        chosen = choice.Chosen(
            library.paths[number],
            library.names[number],
            kind(library.classes[number]),
            self.unit,
            self.pane,
            self.behind,
            self.behind_column,
        )
        found, skipped = use_cases.editable(self.targets(context))
        return [
            *give.warnings(skipped),
            *(yield from give.giving(context, dict.fromkeys(found, chosen))),
        ]


def kind(of: str) -> str:
    """What a material is made of by the class of its curve."""
    return "GLASS" if of.endswith("transmittance") else "REFLECTANCE"


class SKYLIGHT_OT_assign_to_active(Assign, bpy.types.Operator):
    """Assign the reflectance chosen in the library to the active material"""

    bl_idname = "skylight.assign_to_active"
    bl_label = "Assign to Active"

    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )

    @classmethod
    def nothing_to_do(cls, context):
        return "" if targets.active(context) else "Select an object with a material"

    def targets(self, context):
        return [targets.named(context, self.material)]


class SKYLIGHT_OT_assign_to_selected(Assign, bpy.types.Operator):
    """Assign the reflectance chosen in the library to the materials of all selected objects"""

    bl_idname = "skylight.assign_to_selected"
    bl_label = "To Selection"

    @classmethod
    def nothing_to_do(cls, context):
        return "" if targets.selected(context) else "Select objects with materials"

    def targets(self, context):
        return targets.selected(context)


CLASSES = (SKYLIGHT_OT_assign_to_active, SKYLIGHT_OT_assign_to_selected)
