"""Baking all light when a person asks for it, with Esc to end it, and taking bakes away."""

# mypy: disable-error-code="valid-type"

import bpy

from ..choices import AUTO, BAKED
from . import operator, properties, update

STOPPED = "Baking stopped before it was complete"


class SKYLIGHT_OT_bake(operator.Long, bpy.types.Operator):
    """Compute direct and reflected light on each vertex of spectral materials. It takes seconds \
to minutes once, and no time in renders. Press Esc to stop"""

    bl_idname = "skylight.bake"
    bl_label = "Bake Light"
    doing = "Baking"

    selected: bpy.props.BoolProperty(name="Selected Only", description="Bake only selected objects")
    changed: bpy.props.BoolProperty(
        name="Changed Only",
        description="Bake only objects that changed or whose surroundings changed",
        default=True,
    )
    rays: bpy.props.IntProperty(
        name="Rays",
        description="Rays per point. 0: chosen automatically",
        min=0,
        max=8192,
        step=32,
    )

    @classmethod
    def disabled_reason(cls, context):
        return update.nothing_to_update(context)

    def work(self, context):
        """The generator that bakes, as the properties say."""
        from ..scene import use_cases
        from ..scene.bake import scene_bake

        world = context.scene.world
        rays = max(32, self.rays // 32 * 32) if self.rays else None
        chosen = scene_bake.targets(self.selected)
        settings = properties.settings_of(world)
        lines = yield from use_cases.bake(
            context.scene, settings, chosen, rays=rays, changed_only=self.changed
        )
        return [*(("INFO", line) for line in lines), *(yield from _shown(context))]

    def rest(self, context):
        """Also of a bake that was ended show what there is."""
        return [("WARNING", STOPPED), *(yield from _shown(context))]

    def finish(self, context, done):
        return [("WARNING", STOPPED)] if done is None else done


def _shown(context):
    """Show bakes in the World, and light them by its sky."""
    from ..scene.bake import scene_bake
    from ..scene.day import day_world

    if not scene_bake.baked():
        return []
    numbers = context.scene.world.skylight
    settings = properties.settings_of(context.scene.world)
    is_auto = numbers.occlusion == AUTO and settings.least is None
    if is_auto or day_world.is_day(context.scene.world):
        return update.unbaked(context)
    numbers.occlusion = BAKED
    return (yield from update.updating(context))


class SKYLIGHT_OT_remove_bakes(operator.Thin, bpy.types.Operator):
    """Remove the baked light from all objects or from the selected ones. Until you press Bake \
Light, the open sky lights them"""

    bl_idname = "skylight.remove_bakes"
    bl_label = "Remove Bakes"

    selected: bpy.props.BoolProperty(
        name="Selected Only", description="Remove only the bakes of selected objects"
    )

    @classmethod
    def disabled_reason(cls, context):
        from ..scene.bake import scene_bake

        return "" if scene_bake.baked() else "No object is baked"

    def run(self, context):
        from ..scene.bake import scene_bake

        numbers = context.scene.world.skylight if context.scene.world else None
        if numbers is not None and numbers.occlusion == AUTO:
            numbers.occlusion = BAKED  # else the light came back by itself
        chosen = list(context.view_layer.objects.selected) if self.selected else None
        return [("INFO", f"Removed {scene_bake.remove(chosen)} bake(s)")]


CLASSES = (SKYLIGHT_OT_bake, SKYLIGHT_OT_remove_bakes)
