"""Hours of sun and sky view factors, in colors over the 3D views."""

# No postponed annotations here: Blender reads properties from them.
# mypy: disable-error-code="valid-type"

import bpy

from . import false_colour, operator, place


class SKYLIGHT_OT_sunlight(operator.Long, bpy.types.Operator):
    """Show how many hours of sun surfaces have on a day, or how much of the sky they see, in \
colors over the 3D views. The file does not change. Press Esc to stop"""

    bl_idname = "skylight.sunlight"
    bl_label = "Sun Hours and Sky View"
    bl_options = {"REGISTER"}  # nothing of the file changes
    doing = "Sunlight"

    show: bpy.props.EnumProperty(
        name="Show",
        items=(
            ("sun_hours", "Sun Hours", "Hours of sun on the day of Date and Place"),
            ("sky_view", "Sky View Factor", "Part of an even sky's light that nothing hides"),
        ),
    )
    filepath: bpy.props.StringProperty(
        name="CSV", description="Table of both for each object. Empty: none", subtype="FILE_PATH"
    )

    def work(self, context):
        """Cast rays from all surfaces."""
        from ..scene import use_cases
        from ..scene.meter.exposure import SunTimes

        where = place.sky_place(context.scene.skylight_place)
        times = SunTimes(
            where.date,
            "00:00",
            "24:00",
            where.timezone,
            where.latitude,
            where.longitude,
            where.north,
        )
        return use_cases.exposure(times)

    def finish(self, context, done):
        """Show what was found, and write the table."""
        from pathlib import Path

        from ..scene.meter.exposure import Drawing
        from ..whole_files import write_text

        if done is None:
            return [("WARNING", "Stopped: nothing is shown")]
        false_colour.show(Drawing(done), self.show)
        if self.filepath:
            write_text(Path(bpy.path.abspath(self.filepath)), done.table())
        return [("INFO", line) for line in done.lines]


CLASSES = (SKYLIGHT_OT_sunlight,)
