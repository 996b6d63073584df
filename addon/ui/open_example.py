"""A small house to try everything on."""

import bpy

from . import operator, properties


class SKYLIGHT_OT_open_example(operator.Long, bpy.types.Operator):
    """Add a scene with a small house under a low sun, and show it through its camera. Your own \
scenes stay as they are"""

    bl_idname = "skylight.open_example"
    bl_label = "Open Example House"
    doing = "Opening"

    def work(self, context):
        from ..scene import example_house, use_cases

        scene = example_house.build()
        if context.window is not None:
            context.window.scene = scene
        found = yield from use_cases.simulating_sky(
            scene, example_house.PLACE, properties.settings_of(scene.world)
        )
        for area in context.screen.areas if context.screen else ():
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
        return [("INFO", line) for line in found.lines]


CLASSES = (SKYLIGHT_OT_open_example,)
