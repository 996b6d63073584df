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
    """Give the material back as it was before the reflectance was applied, all links and values"""

    bl_idname = "skylight.remove"
    bl_label = "Remove"

    material: bpy.props.StringProperty(name="Material", description="Empty: the active one")

    def targets(self, context):
        return [targets.named(context, self.material)]


class SKYLIGHT_OT_remove_selected(Remove, bpy.types.Operator):
    """Give the materials of all selected objects back as they were before"""

    bl_idname = "skylight.remove_selected"
    bl_label = "Remove from Selection"

    @classmethod
    def hindrance(cls, context):
        from ..scene.materials import spectral_material

        found = set(spectral_material.ours()) & set(targets.selected(context))
        return "" if found else "No selected object has a spectral material"

    def targets(self, context):
        return targets.selected(context)


class SKYLIGHT_OT_remove_all(Remove, bpy.types.Operator):
    """Give all materials of the file back as they were before, also those of other scenes"""

    bl_idname = "skylight.remove_all"
    bl_label = "Remove from All"

    @classmethod
    def hindrance(cls, context):
        from ..scene.materials import spectral_material

        return "" if spectral_material.ours() else "No material of the file is spectral"

    def targets(self, context):
        from ..scene.materials import spectral_material

        return spectral_material.ours()


CLASSES = (SKYLIGHT_OT_remove, SKYLIGHT_OT_remove_selected, SKYLIGHT_OT_remove_all)
