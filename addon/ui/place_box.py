"""What the box of the sky offers for a sky that was simulated: its fields, its sun's paths."""

from __future__ import annotations

from functools import partial
from typing import Any

import bpy

from . import panel_text, place, refine_sky


def draw(
    layout: bpy.types.UILayout, context: bpy.types.Context, image: bpy.types.Image | None
) -> None:
    """Two closed panels, where the image of the sky was simulated; a bar while it is refined."""
    from ..scene.day import day_world
    from ..scene.world import simulated_sky

    made = None if image is None else simulated_sky.made_of(image)
    if (work := refine_sky.work()) is not None:
        row = layout.row(align=True)
        row.progress(factor=work.progress.done, text="Refining the sky")
        row.operator("skylight.stop_refining", text="", icon="X")
    elif line := refine_sky.line():
        panel_text.paragraph(layout, context, line, "ERROR")
    if made is None:
        if day_world.is_day(context.scene.world):
            _animate(layout)
        return
    header, body = layout.panel("skylight_place", default_closed=True)
    header.label(text="Date and Place")
    if body is not None:
        place.draw(body, context.scene.skylight_place)
        row = body.row(align=True)
        row.operator_context = "EXEC_DEFAULT"  # the fields are here: no dialog asks for them
        row.operator("skylight.make_sky", text="Simulate")
        part = row.row(align=True)
        part.operator_context = "INVOKE_DEFAULT"
        part.operator("skylight.refine_sky", text="Refine")
        _animate(body)
    header, body = layout.panel("skylight_sun_paths", default_closed=True)
    header.label(text="Sun Paths")
    if body is not None:
        _sun_paths(body, context)


def _animate(layout: bpy.types.UILayout) -> None:
    row = layout.row()
    row.operator_context = "INVOKE_DEFAULT"  # from when to when is asked for
    row.operator("skylight.animate")


def _sun_paths(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The sun's paths over the place of the fields, which may move."""
    from . import pictures

    chosen = context.scene.skylight_place
    theme = pictures.theme_name()
    key = (place.sky_place(chosen), chosen.city, theme)
    pictures.picture(layout, context, key, partial(_draw, *key))


def _draw(where: Any, title: str, theme: str) -> Any:
    """Draw a place's heliodon; raises InputError for what is no time or zone."""
    from ..pictures.heliodon import Heliodon, heliodon
    from ..pictures.theme import THEMES
    from ..sky.sun_position import local_moment

    moment = local_moment(where.date, where.time, where.timezone)
    shown = Heliodon(moment, where.latitude, where.longitude, where.north)
    return heliodon(shown, title, theme=THEMES[theme])
