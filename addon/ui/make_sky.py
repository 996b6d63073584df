"""Lighting the scene by the sky of a date and a place."""

import bpy

from . import follow, give, operator, place, properties


class SKYLIGHT_OT_make_sky(operator.Long, bpy.types.Operator):
    """Simulate the sky of a date, a place and a weather, light the scene with it, and update the \
spectral materials"""

    bl_idname = "skylight.make_sky"
    bl_label = "Sky from Date and Place"
    doing = "Simulating"

    def invoke(self, context, event):
        self.asked = True
        place.take_over(context.scene)
        manager = context.window_manager
        return manager.invoke_props_dialog(self, width=320, confirm_text="Simulate")

    def draw(self, context):
        chosen = context.scene.skylight_place
        place.draw(self.layout, chosen, asks=not place.is_chosen(chosen))

    def work(self, context):
        from ..scene import use_cases

        scene = context.scene
        settings = properties.settings_of(scene.world)
        chosen, relight = place.sky_place(scene.skylight_place), not follow.follows(settings)
        found = yield from use_cases.simulating_sky(scene, chosen, settings, relight)
        return report(scene, found)


def report(scene: bpy.types.Scene, found) -> list[tuple[str, str]]:
    """What came of a simulated sky, an `Outcome`, as lines for the person."""
    count = f", {len(found.results)} material(s) updated" if found.results else ""
    first, *others = found.lines
    lines = [("INFO", line) for line in (f"{first}{count}", *others)]
    return [*give.warnings(found.skipped), *lines, *operator.of_light(scene)]


CLASSES = (SKYLIGHT_OT_make_sky,)
