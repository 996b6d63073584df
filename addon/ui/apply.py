"""Giving materials their measured reflectances: the active one, the selected, all with a file."""

# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError
from . import choice, follow, give, operator, properties, targets


class Apply(choice.Fields, operator.Long):
    """What the three operators share: one file for all of them, or each material its own."""

    doing = "Applying"

    filepath: bpy.props.StringProperty(
        name="File", description="Leave empty to use the file chosen for each material"
    )
    kind: bpy.props.EnumProperty(
        name="Measured", description="What the file holds", items=choice.KINDS
    )

    @classmethod
    def disabled_reason(cls, context):
        return operator.no_sky(context) or cls.nothing_to_do(context)

    @classmethod
    def nothing_to_do(cls, context):
        return ""

    def work(self, context):
        from ..scene import use_cases

        found, skipped = use_cases.editable(self.targets(context))
        chosen = {}
        lines = give.warnings(skipped)
        for material in found:
            source = self if self.filepath else material.skylight
            if source.filepath:
                column = self.column or source.column
                chosen[material] = choice.Chosen.of(source, column=column)
            else:
                lines.append(("WARNING", f"skipped: {material.name} has no reflectance file"))
        if not chosen:
            raise InputError(
                " and ".join(f'material "{m.name}"' for m in found[:3]) or "the selection",
                "has no reflectance file",
                "choose a CSV for it first",
            )
        return [*lines, *(yield from give.giving(context, chosen))]


class SKYLIGHT_OT_apply(Apply, bpy.types.Operator):
    """Make this material spectral with its measured reflectance, under the World's sky. Remove \
restores it"""

    bl_idname = "skylight.apply"
    bl_label = "Apply"

    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )

    def targets(self, context):
        return [targets.named(context, self.material)]


class SKYLIGHT_OT_apply_selected(Apply, bpy.types.Operator):
    """Apply its chosen file to each material of the selected objects"""

    bl_idname = "skylight.apply_selected"
    bl_label = "Apply to Selection"

    @classmethod
    def nothing_to_do(cls, context):
        selected = context.view_layer.objects.selected
        found = any(obj.material_slots for obj in selected)
        return "" if found else "Select objects with materials"

    def targets(self, context):
        return targets.selected(context)


class SKYLIGHT_OT_apply_all(Apply, bpy.types.Operator):
    """Apply its chosen file to every material that has one. Edited files are read again"""

    bl_idname = "skylight.apply_all"
    bl_label = "Apply to All"

    @classmethod
    def nothing_to_do(cls, context):
        found = any(material.skylight.filepath for material in bpy.data.materials)
        return "" if found else "Choose a reflectance CSV for a material first"

    def targets(self, context):
        return [material for material in bpy.data.materials if material.skylight.filepath]


class SKYLIGHT_OT_estimate(operator.Long, bpy.types.Operator):
    """Estimate a reflectance from the material's base color or texture and shade it \
spectrally, as long as none is measured"""

    bl_idname = "skylight.estimate"
    bl_label = "Estimate from Base Color"
    doing = "Estimating"

    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )

    @classmethod
    def disabled_reason(cls, context):
        return operator.no_sky(context)

    def work(self, context):
        from ..scene import use_cases

        material = targets.named(context, self.material)
        settings = properties.settings_of(context.scene.world)
        given, relight = use_cases.resolved({material: None}), not follow.follows(settings)
        found = yield from use_cases.making_spectral(context.scene, given, settings, relight)
        return [("INFO", result.line) for result in found.results]


CLASSES = (
    SKYLIGHT_OT_apply,
    SKYLIGHT_OT_apply_selected,
    SKYLIGHT_OT_apply_all,
    SKYLIGHT_OT_estimate,
)
