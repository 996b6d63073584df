"""Letting the sky of the scene move through a day."""

# No postponed annotations here: Blender reads properties from them.
# mypy: disable-error-code="valid-type"

import bpy

from . import give, operator, place, properties


class SKYLIGHT_OT_animate(operator.Long, bpy.types.Operator):
    """Let the sky, and all that it lights, move through a day or a year. Press Esc to stop"""

    bl_idname = "skylight.animate"
    bl_label = "Animate over a Day"
    doing = "Skies"

    span: bpy.props.EnumProperty(
        name="Through",
        items=(
            ("DAY", "A Day", "From one time of the day to another"),
            ("YEAR", "A Year", "The days of the year, each at one time"),
        ),
    )
    start: bpy.props.FloatProperty(
        name="Start",
        description="Local time in hours. Of a year, the time of each day in winter time",
        min=0.0,
        max=24.0,
        step=25,
        precision=2,
        default=6.0,
    )
    end: bpy.props.FloatProperty(
        name="End",
        description="Local time in hours, later than the first",
        min=0.0,
        max=24.0,
        step=25,
        precision=2,
        default=20.0,
    )
    frames: bpy.props.IntProperty(
        name="Frames",
        description="Number of frames from the first of the scene on",
        min=2,
        max=100_000,
        default=240,
    )

    def invoke(self, context, event):
        """Ask first; then work between events."""
        place.take_over(context.scene)
        self.asked = True
        return context.window_manager.invoke_props_dialog(self, width=320)

    def draw(self, context):
        """Where and when, then how long."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "span")
        column = layout.column(align=True)
        column.prop(self, "start")
        if self.span == "DAY":
            column.prop(self, "end")
        column.prop(self, "frames")
        place.draw(layout, context.scene.skylight_place)

    def work(self, context):
        """The generator that animates, as the properties say."""
        from ..scene import use_cases
        from ..scene.day.animate import YEAR, Day

        scene = context.scene
        until = YEAR if self.span == "YEAR" else _text(self.end)
        day = Day(place.sky_place(scene.skylight_place), _text(self.start), until, self.frames)
        return use_cases.animate(scene, day, properties.settings_of(scene.world))

    def finish(self, context, done):
        """Say how many key skies there are, and what they leave."""
        if done is None:
            return [("WARNING", "Stopped: the sky stands still as before")]
        lines = [("INFO", line) for line in done.lines]
        return [*give.warnings(done.skipped), *lines, *operator.of_light(context.scene)]


def _text(hours: float) -> str:
    """Hours as text: 14.5 is 14:30."""
    minutes = round(hours * 60.0)
    return f"{minutes // 60:02}:{minutes % 60:02}"


CLASSES = (SKYLIGHT_OT_animate,)
