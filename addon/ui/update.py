"""Bringing the spectral materials up to date with the sky."""

import bpy

from . import operator, properties, targets


class SKYLIGHT_OT_update(operator.Thin, bpy.types.Operator):
    """Compute spectral materials anew, for they follow neither another HDRI nor working space"""

    bl_idname = "skylight.update"
    bl_label = "Update"

    @classmethod
    def hindrance(cls, context):
        from ..scene import materials

        nothing = "No material is spectral yet: apply a reflectance first"
        return operator.no_sky(context) or ("" if materials.managed_materials() else nothing)

    def run(self, context):
        from ..scene import spectral

        world = context.scene.world
        kept, lines = targets.editable(spectral.in_scene(context.scene))
        settings = properties.settings_of(world)
        world = spectral.develop(context.scene, settings)
        light, results = spectral.update(world, settings, kept)
        lines += [("WARNING", r.line) for r in results if r.out_of_gamut]
        count = f"{len(results)} material(s) follow {light.name}"
        return [*lines, ("INFO", count), ("INFO", operator.caption(world))]


CLASSES = (SKYLIGHT_OT_update,)
