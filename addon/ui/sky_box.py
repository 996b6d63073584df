"""The first box of the panel: what lights the scene."""

from __future__ import annotations

import bpy

from .. import tags
from ..errors import InputError
from . import panel_text, place_box, under_way
from .labels import told
from .translation import translated


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The sky's picture and name, its turn and its brightness; before that, where to get one."""
    from ..scene.world import hdri

    box = layout.box()
    world = context.scene.world
    if not is_chosen(world):
        box.label(text=translated("Sky"), icon="WORLD", translate=False)
        column = box.column(align=True)
        column.operator("skylight.load_sky", text="Load Sky HDRI...", icon="FILEBROWSER")
        column.operator("skylight.use_world", text="Use My World")
        column.operator("skylight.make_sky", text="From Date and Place...", icon="LIGHT_SUN")
        box.operator("skylight.open_example", icon="HOME")
        under_way.draw(box)
        return
    try:
        seen = hdri.sky_of(world)
    except InputError as error:
        panel_text.paragraph(box, context, told(error), "ERROR")
        return
    row = box.row()
    picture = 0 if seen.image is None else seen.image.preview_ensure().icon_id
    if picture:
        row.template_icon(icon_value=picture, scale=2.4)
    column = row.column(align=True)
    column.label(
        text=translated(f"Sky: {seen.name.removeprefix('Sky ')}"),
        icon="NONE" if picture else "WORLD",
    )
    line, details = panel_text.of_sky(world, seen)
    column.label(text=translated(line))
    if panel_text.is_other_sky(world, seen):
        row = box.row(align=True)
        row.label(text="The sky has changed", icon="ERROR")
        row.operator("skylight.update", text="", icon="FILE_REFRESH")
    column = box.column(align=True)
    row = column.row(align=True)
    part = row.row(align=True)
    moves = tags.DAY in world  # keyframes and drivers would take back whatever is set here
    part.enabled = seen.mapping is not None and not moves
    part.prop(world.skylight, "rotation")
    row.operator("skylight.load_sky", text="", icon="FILEBROWSER")
    row = column.row(align=True)
    part = row.row(align=True)
    part.enabled = seen.background is not None and not moves
    part.prop(world.skylight, "exposure")
    row.operator("skylight.make_sky", text="", icon="LIGHT_SUN")
    place_box.draw(box, context, seen.image)
    if details:
        header, body = box.panel("skylight_about_sky", default_closed=True)
        header.label(text="About This Sky")
        if body is not None:
            for line in details:
                panel_text.paragraph(body, context, line, "INFO")


def is_chosen(world: bpy.types.World | None) -> bool:
    """Whether a person has said that a World is the sky: by its HDRI, or by a button."""
    from ..scene.world import hdri, settings

    if world is None:
        return False
    return settings.stored(world) is not None or hdri.sky_of(world).image is not None
