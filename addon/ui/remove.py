"""Giving materials back as they were: the active one, the selected, all."""

# mypy: disable-error-code="valid-type"

import bpy

from . import give, operator, targets


class Remove(operator.Thin):
    """What the two operators share. The chosen file stays with the material, to apply again."""

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


class SKYLIGHT_OT_remove_all(operator.Thin, bpy.types.Operator):
    """Restore all materials and Worlds of the file, and remove bakes, lamps and settings of the \
add-on. Files chosen for materials and spectra of lamps stay"""

    bl_idname = "skylight.remove_all"
    bl_label = "Remove from All"

    @classmethod
    def disabled_reason(cls, context):
        from ..scene import clear

        return "" if clear.is_anything_ours() else "No material is spectral yet"

    def run(self, context):
        from ..scene import use_cases

        found = use_cases.remove_all()
        return [*give.warnings(found.skipped), *(("INFO", line) for line in found.lines)]


CLASSES = (SKYLIGHT_OT_remove, SKYLIGHT_OT_remove_selected, SKYLIGHT_OT_remove_all)
