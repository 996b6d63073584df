"""Lighting the scene by an HDRI file."""

# mypy: disable-error-code="valid-type"

import bpy

from . import operator, properties


class SKYLIGHT_OT_load_sky(operator.Thin, bpy.types.Operator):
    """Light the scene by a sky HDRI; spectral materials follow, for they need its light"""

    bl_idname = "skylight.load_sky"
    bl_label = "Load Sky HDRI"

    filepath: bpy.props.StringProperty(
        name="Sky HDRI", description="OpenEXR or Radiance, lat-long (2:1)", subtype="FILE_PATH"
    )
    filter_glob: bpy.props.StringProperty(default="*.exr;*.hdr", options={"HIDDEN"})

    def invoke(self, context, event):
        return operator.browse(self, context)

    def run(self, context):
        from ..scene import spectral
        from . import targets

        scene = context.scene
        before = scene.world
        settings = properties.settings_of(before)
        settings.transfer()  # wrong settings are found before the scene has another World
        kept, skipped = targets.editable(spectral.in_scene(scene))
        world = spectral.set_sky(scene, bpy.path.abspath(self.filepath), settings)
        light, results = spectral.update(world, settings, kept)
        count = f"; {len(results)} materials follow" if results else ""
        said = f"sky: {light.name}{count}"
        return [*skipped, ("INFO", said), ("INFO", operator.caption(world))]


CLASSES = (SKYLIGHT_OT_load_sky,)
