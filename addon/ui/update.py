"""Bringing the spectral materials up to date with the sky."""

import bpy

from . import choice, operator, properties, staleness_handlers, targets


class SKYLIGHT_OT_update(operator.Thin, bpy.types.Operator):
    """Let spectral materials follow another HDRI, other settings or lamps, and tell which files, \
bakes and base colors have changed since"""

    bl_idname = "skylight.update"
    bl_label = "Update"

    @classmethod
    def hindrance(cls, context):
        from ..scene.materials import spectral_material

        nothing = "No material is spectral yet: make some so first"
        return operator.no_sky(context) or ("" if spectral_material.ours() else nothing)

    def run(self, context):
        from ..scene import out_of_date, spectral

        world = context.scene.world
        kept, lines = targets.editable(spectral.in_scene(context.scene))
        settings = properties.settings_of(world)
        world = spectral.develop(context.scene, settings)
        light, results = spectral.update(world, settings, kept)
        lines += [("WARNING", r.line) for r in results if r.out_of_gamut]
        changed, gone = choice.changed_files(kept)
        staleness_handlers.found_files(changed)
        lines += [("WARNING", f"{material.name}: {line}") for material, line in changed.items()]
        lines += [("INFO", line) for line in gone]
        if names := out_of_date.look_at_bakes(context.scene):
            lines.append(("WARNING", f"not baked, or changed since: {', '.join(names)}"))
        staleness_handlers.found_bakes()
        count = f"{len(results)} material(s) follow {light.name}"
        return [*lines, ("INFO", count), ("INFO", operator.caption(world))]


CLASSES = (SKYLIGHT_OT_update,)
