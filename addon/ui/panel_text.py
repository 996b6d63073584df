"""What the panels say about a sky and its materials; all of it lies in the blend file already."""

from __future__ import annotations

from typing import Any

import bpy

from .. import tags
from ..errors import InputError
from . import staleness_handlers
from .text_width import wrapped
from .translation import translated

MARGINS = 70, 92
"""What a box needs beside a text without and with an icon [pixels at scale 1], the sidebar's tabs
among it."""


def paragraph(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    text: str,
    icon: str = "NONE",
    width: float = 0.0,
) -> None:
    """A sentence over as many lines as a ``width`` [pixels] asks for; 0: the panel's."""
    width = width or (context.region.width if context.region else 600)
    scale = context.preferences.system.ui_scale or 1.0  # 0 without a window
    room = width / scale - MARGINS[icon != "NONE"]
    column = layout.column(align=True)
    for number, line in enumerate(wrapped(translated(text), max(room, 100.0))):
        shown = "BLANK1" if number and icon != "NONE" else icon
        column.label(text=line, icon=shown, translate=False)


LOW, TWILIGHT = 10.0, 0.0
"""[°] of the sun: under the first it is low, under the second it is dusk."""


def of_sky(world: bpy.types.World, seen: Any) -> tuple[str, list[str]]:
    """What a World's sky is, in a few words, and what else a person may want to know of it.

    ``seen``: its `hdri.WorldSky`.
    """
    from ..scene.world import light_group

    found = light_group.record_of(world)
    if found is None or is_other_sky(world, seen):
        return "Not analyzed yet", [seen.line] if seen.line else []
    told = [*([seen.line] if seen.line else []), *found.notes]
    words = _sun(found.rest.get("sun"))
    return f"{words}, see below" if found.notes else f"{words}, good", told


def is_low(world: bpy.types.World | None) -> bool:
    """Whether the sun of a World's sky is low, or under the horizon."""
    from ..scene.world import light_group

    found = light_group.record_of(world)
    sun = found.rest.get("sun") if found is not None else None
    return float(sun["elevation"]) < LOW if sun else False


def _sun(sun: Any) -> str:
    """The hour that a sky's sun tells of."""
    if not sun:
        return "No sun"
    elevation = float(sun["elevation"])
    kind = "Dusk" if elevation < TWILIGHT else "Low sun" if elevation < LOW else "Day"
    return f"{kind}, sun at {elevation:.0f}°"


def is_other_sky(world: bpy.types.World, seen: Any) -> bool:
    """Whether materials were lit by another sky, or in another working space, than there is now."""
    from ..scene.blend_data import working_space
    from ..scene.world import light_group

    found = light_group.record_of(world)
    return found is not None and (found.image, found.space) != (seen.name, working_space.name())


def is_of_other_sky(context: bpy.types.Context) -> bool:
    """Whether what is predicted of materials was so under another sky than the scene's."""
    from ..scene.world import hdri

    world = context.scene.world
    try:
        return world is None or is_other_sky(world, hdri.sky_of(world))
    except InputError:  # the box of the sky says what is wrong with it
        return True


def model(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the sky was modelled with, and how far its light on surfaces is off."""
    from ..scene.world import light_group

    found = light_group.record_of(context.scene.world)
    if found is None:
        return
    if found.model:
        paragraph(layout, context, found.model)
    if len(found.errors) <= found.degree:
        return
    left = found.errors[found.degree]
    paragraph(
        layout,
        context,
        f"Irradiance of degree {found.degree}: largest error {100 * left['worst']:.1f} %, "
        f"mean {100 * left['mean']:.2f} %",
    )


def lights(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What shines on materials beside the sky, and what Eevee cannot keep apart."""
    from ..scene.world import light_group

    found = light_group.record_of(context.scene.world)
    if found is None:
        return
    for lines, icon in ((found.lights, "INFO"), (found.warnings, "ERROR")):
        for line in lines:
            paragraph(layout, context, line, icon)


def material(
    layout: bpy.types.UILayout, context: bpy.types.Context, shown: bpy.types.Material
) -> None:
    """What a material was given, its colour and how far off it would be; nothing if unmanaged."""
    from ..scene.materials import glass_and_metal, spectral_material
    from ..transfer.assignment import BEHIND, ESTIMATED

    managed = spectral_material.managed(shown)
    if managed is None:
        pane = glass_and_metal.pane_node(shown)
        if pane is not None:
            name = glass_and_metal.pane_of(shown).name
            layout.box().label(text=translated(f"As glass: {name}"), icon="CHECKMARK")
        return
    box = layout.box()
    name = managed.record.reflectance
    known = name != ESTIMATED
    if known:
        box.label(text=name, icon="CHECKMARK", translate=False)
    else:
        paragraph(box, context, "Estimated, not measured", "QUESTION")
    if why := staleness_handlers.stale(shown):
        paragraph(box, context, why, "ERROR")
    if tags.SHOWS_RGB in shown:
        paragraph(box, context, "Shows RGB × RGB", "ERROR")
    choice = shown.skylight
    applied = name.partition(BEHIND)[0]
    if choice.column and choice.kind == "REFLECTANCE" and choice.column != applied:
        paragraph(box, context, f"{choice.column} is not applied yet", "ERROR")
    box.prop(choice, "swatch")
    if choice.swatch_scale < 1.0:
        text = f"Brighter than white. The swatch shows {100 * choice.swatch_scale:.2g} % of it"
        paragraph(box, context, text)
    for sentence in managed.details.sentences:
        paragraph(box, context, sentence)
    if managed.world != context.scene.world:
        name = managed.world.name if managed.world else "none"
        paragraph(box, context, f"Lit by World {name}, not by this scene's. Press Update", "ERROR")


def view(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the view transform does to colors, and the button for a neutral white."""
    from ..scene.world import view_transform

    fit, line = view_transform.transform_line(context.scene)
    paragraph(layout, context, line, "CHECKMARK" if fit else "INFO")
    on = tags.VIEW in context.scene
    button = layout.operator(
        "skylight.neutral_white",
        text="Restore White Balance" if on else "Balance View to This Sky",
        depress=on,
    )
    button.on = not on
