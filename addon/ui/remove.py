"""Giving materials back as they were: the active one, the selected, all."""

# mypy: disable-error-code="valid-type"

import bpy

from . import give, operator, targets


class Remove(operator.Thin):
    """What the three operators share. The chosen file stays with the material, to apply again."""

    def run(self, context):
        from ..scene import use_cases

        found = use_cases.remove(self.targets(context))
        return [*give.warnings(found.skipped), *(("INFO", line) for line in found.lines)]


class SKYLIGHT_OT_remove(Remove, bpy.types.Operator):
    """Restore the material as it was before Apply, with all links and values"""

    bl_idname = "skylight.remove"
    bl_label = "Remove"

    material: bpy.props.StringProperty(
        name="Material", description="Leave empty for the active material"
    )

    def targets(self, context):
        return [targets.named(context, self.material)]


class SKYLIGHT_OT_remove_selected(Remove, bpy.types.Operator):
    """Restore the materials of all selected objects as they were before"""

    bl_idname = "skylight.remove_selected"
    bl_label = "Remove from Selection"

    @classmethod
    def disabled_reason(cls, context):
        from ..scene.materials import spectral_material

        found = set(spectral_material.ours()) & set(targets.selected(context))
        return "" if found else "No selected object has a spectral material"

    def targets(self, context):
        return targets.selected(context)


class SKYLIGHT_OT_remove_all(Remove, bpy.types.Operator):
    """Restore all materials of the file as they were before, in all scenes"""

    bl_idname = "skylight.remove_all"
    bl_label = "Remove from All"

    @classmethod
    def disabled_reason(cls, context):
        from ..scene.materials import spectral_material

        return "" if spectral_material.ours() else "No material is spectral yet"

    def targets(self, context):
        from ..scene.materials import spectral_material

        return spectral_material.ours()


CLASSES = (SKYLIGHT_OT_remove, SKYLIGHT_OT_remove_selected, SKYLIGHT_OT_remove_all)
