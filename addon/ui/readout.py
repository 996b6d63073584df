"""What the panels say about a sky and its materials; all of it lies in the blend file already."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import bpy

from ..errors import InputError

ROWS = 50
"""Materials that the table shows: a panel is drawn anew whenever the mouse moves over it."""

CHARACTER = 5.6
"""Mean width of a character [pixels at scale 1]: Blender does not wrap text by itself."""


def paragraph(
    layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str = "NONE"
) -> None:
    """A sentence over as many lines as the panel's width asks for."""
    width = context.region.width if context.region else 600
    scale = context.preferences.system.ui_scale or 1.0  # 0 without a window
    characters = max(20, int((width / scale - 45) / CHARACTER))
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, characters)):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def sky(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The World's HDRI, and what of it reaches materials."""
    from ..scene import sky_light, working_space
    from ..scene import world as worlds

    world = context.scene.world
    try:
        image = worlds.sky_of(world).image
    except InputError as error:
        paragraph(layout, context, str(error), "ERROR")
        return
    layout.label(text=f"Sky: {image.name}", icon="IMAGE_DATA")
    found = sky_light.description_of(world)
    if found is None:
        return
    for note in found.get("notes", ()):
        paragraph(layout, context, note, "INFO")
    if found.get("image") != image.name or found.get("space") != working_space.name():
        paragraph(layout, context, "HDRI or working space have changed: press Update", "ERROR")


def model(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the sky was modelled with, and how far its light on surfaces is off."""
    from ..scene import sky_light

    found = sky_light.description_of(context.scene.world)
    if found is None:
        return
    if "model" in found:
        paragraph(layout, context, found["model"])
    left = found["errors"][found["degree"]]
    paragraph(
        layout,
        context,
        f"irradiance of degree {found['degree']}: off by {100 * left['worst']:.1f} % at worst, "
        f"{100 * left['mean']:.2f} % in the mean",
    )


def lights(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What shines on materials beside the sky, and what Eevee cannot keep apart."""
    from ..scene import sky_light

    found = sky_light.description_of(context.scene.world) or {}
    for line in found.get("lights", ()):
        paragraph(layout, context, line, "INFO")


def material(
    layout: bpy.types.UILayout, context: bpy.types.Context, shown: bpy.types.Material
) -> None:
    """What a material was given, its colour and how far off it would be; nothing if unmanaged."""
    from ..scene import materials

    managed = materials.managed(shown)
    if managed is None:
        return
    box = layout.box()
    box.label(text=managed.reflectance_name, icon="CHECKMARK")
    choice = shown.skylight
    if choice.column and choice.column != managed.reflectance_name:
        paragraph(box, context, f"{choice.column} is chosen but not applied yet", "ERROR")
    box.prop(choice, "swatch")
    if choice.swatch_scale < 1.0:
        text = f"brighter than white: shown at {100 * choice.swatch_scale:.2g} % of its brightness"
        paragraph(box, context, text)
    for sentence in sentences(managed.extra):
        paragraph(box, context, sentence)
    if managed.world != context.scene.world:
        name = managed.world.name if managed.world else "none"
        paragraph(box, context, f"lit by World {name}, not this scene's: press Update", "ERROR")


def sentences(found: dict[str, Any]) -> list[str]:
    """What is kept with a material about its errors, in words."""
    if not math.isfinite(found["rgb_delta_E"]):
        lines = [f"its error is unknown: {found.get('unknown') or 'the sky is dark'}"]
    else:
        rgb, spectral = found["rgb_delta_E"], found["matrix_delta_E"]
        lines = [f"RGB is off by ΔE {rgb:.1f}, spectral by {spectral:.1f}"]
        if "bound" in found:
            lines.append(f"{found['model']} model, ΔE at most {found['bound']:.1f}")
    if found["out_of_gamut"]:
        lines.append("out of gamut: Blender clamps it")
    return lines


def summary(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How many materials are spectral, in one line."""
    from ..scene import materials, textures

    found = [materials.managed(material) for material in materials.managed_materials()]
    if not found:
        layout.label(text="No material is spectral yet", icon="INFO")
        return
    guessed = sum(m is not None and m.reflectance_name == textures.ESTIMATED for m in found)
    layout.label(
        text=f"{len(found)} spectral: {len(found) - guessed} measured, {guessed} estimated"
    )


def problems(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What needs the person: nothing where all is well."""


def left_alone(context: bpy.types.Context) -> list[tuple[str, str]]:
    """Names of the scene's materials that one click left alone, and why."""
    from ..scene import everything

    return everything.left_alone(context.scene)


def left(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A row for each material that one click left alone."""
    found = left_alone(context)
    for name, why in found[:ROWS]:
        paragraph(layout, context, f"{name}: {why}")
    if len(found) > ROWS:
        layout.label(text=f"and {len(found) - ROWS} more")


def result(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What light is in the picture."""
    from ..scene import sky_light

    found = sky_light.description_of(context.scene.world)
    if found is None:
        layout.label(text="Nothing is spectral under this sky yet")
        return
    for sentence in found["caption"].split("; "):
        paragraph(layout, context, sentence, "INFO")


def table(layout: bpy.types.UILayout) -> None:
    """A row for each spectral material of the file."""
    from ..scene import materials

    found = materials.managed_materials()
    if not found:
        layout.label(text="No material is spectral yet")
    column = layout.column(align=True)
    for shown in found[:ROWS]:
        managed = materials.managed(shown)
        assert managed is not None
        row = column.row()
        row.prop(shown.skylight, "swatch", text="")
        row.label(text=f"{shown.name}: {managed.reflectance_name}")
        clamped = ", clamped" if managed.extra["out_of_gamut"] else ""
        row.label(text=f"ΔE {managed.extra['rgb_delta_E']:.1f}{clamped}")
    if len(found) > ROWS:
        layout.label(text=f"and {len(found) - ROWS} more")
