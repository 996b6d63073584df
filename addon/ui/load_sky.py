"""Lighting the scene by an HDRI file."""

# mypy: disable-error-code="valid-type"

import bpy

from . import follow, give, operator, properties


class SKYLIGHT_OT_load_sky(operator.Long, bpy.types.Operator):
    """Light the scene with a sky HDRI, in a new World, and update the spectral materials. Your \
World stays in the file"""

    bl_idname = "skylight.load_sky"
    bl_label = "Load Sky HDRI"
    doing = "Loading"

    filepath: bpy.props.StringProperty(
        name="Sky HDRI", description="OpenEXR or Radiance, lat-long (2:1)", subtype="FILE_PATH"
    )
    filter_glob: bpy.props.StringProperty(default="*.exr;*.hdr;*.hsr", options={"HIDDEN"})
    display_type: operator.thumbnails()

    def invoke(self, context, event):
        self.filepath, self.asked = operator.folder(), True
        return operator.browse(self, context)

    def work(self, context):
        from ..scene import use_cases

        scene = context.scene
        settings = properties.settings_of(scene.world)
        path, relight = bpy.path.abspath(self.filepath), not follow.follows(settings)
        found = yield from use_cases.loading_sky(scene, path, settings, relight)
        count = f", {len(found.results)} material(s) updated" if found.results else ""
        name = "" if found.light is None else found.light.name
        lines = [*give.warnings(found.skipped), ("INFO", f"Sky: {name}{count}")]
        return [*lines, *operator.of_light(scene)]


class SKYLIGHT_OT_use_world(operator.Thin, bpy.types.Operator):
    """Take the World as it is for the sky, whatever its nodes are. A World with an HDRI is taken \
without this button"""

    bl_idname = "skylight.use_world"
    bl_label = "Use My World"

    @classmethod
    def disabled_reason(cls, context):
        return operator.no_sky(context)

    def run(self, context):
        from ..scene.world import settings

        world = context.scene.world
        settings.store(world, properties.settings_of(world))
        return [("INFO", f"Sky: {world.name}")]


CLASSES = (SKYLIGHT_OT_load_sky, SKYLIGHT_OT_use_world)
