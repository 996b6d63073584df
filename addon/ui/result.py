"""What came of it, in the steps Materials and Result: what needs the person, what is seen."""

from __future__ import annotations

import math

import bpy

from .. import tags
from ..choices import BAKED
from ..grouping import grouped, some
from . import follow, staleness_handlers
from .panel_text import paragraph

ROWS = 50
"""Materials that the table shows: a panel is drawn anew whenever the mouse moves over it."""


def summary(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """How many materials are spectral, in one line."""
    from ..scene.materials import spectral_material
    from ..transfer.assignment import ESTIMATED

    names = [m[tags.MATERIAL].get("reflectance") for m in spectral_material.ours()]
    if not names:
        layout.label(text="No material is spectral yet", icon="INFO")
        return
    guessed = names.count(ESTIMATED)
    layout.label(
        text=f"{len(names)} spectral: {len(names) - guessed} measured, {guessed} estimated"
    )


def problems(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What needs the person: nothing where all is well."""
    from ..scene import out_of_date

    found = [(m.name, staleness_handlers.stale(m)) for m in staleness_handlers.stale_materials()]
    for line in grouped(found)[:ROWS]:
        paragraph(layout, context, line, "ERROR")
    if found:
        paragraph(layout, context, "Press Make Everything Spectral to update it")
    if light(layout):
        return
    if names := out_of_date.unbaked(context.scene):
        text = f"Not baked, or changed since: {some(names, 'object')}"
        paragraph(layout, context, text, "ERROR")
        layout.operator("skylight.bake")
    elif staleness_handlers.moved() and _is_by_hand(context):
        paragraph(
            layout, context, "Objects have changed. Press Update to find outdated bakes", "INFO"
        )


def light(layout: bpy.types.UILayout) -> bool:
    """How far the light is, with a button that ends it; False where none is being computed."""
    current = follow.work()
    if current is None and not follow.waiting():
        for line in follow.lines():
            layout.label(text=line)
        return False
    row = layout.row(align=True)
    if current is None:
        row.progress(factor=0.0, text="All light: waiting for you to pause")
    else:
        left = f", {current.left:.0f} s left" if current.left >= 1.0 else ""
        done = current.progress.done
        row.progress(factor=done, text=f"All light: {100 * done:.0f} %{left}")
    row.operator("skylight.stop_light", text="", icon="CANCEL")
    return True


def left_alone(context: bpy.types.Context) -> list[tuple[str, str]]:
    """Names of the scene's materials that one click left alone, and why."""
    from ..scene import use_cases

    return use_cases.left_alone(context.scene)


def left(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A paragraph for each reason why one click left materials alone."""
    for line in grouped(left_alone(context))[:ROWS]:
        paragraph(layout, context, line)


def before_after(layout: bpy.types.UILayout) -> None:
    """The button that shows RGB times RGB; red as long as that shows."""
    from ..scene.materials import rgb_comparison

    shown = bool(rgb_comparison.shown_now())
    row = layout.row()
    row.alert = shown
    text = "Back to Spectral" if shown else "Compare: RGB × RGB"
    row.operator("skylight.before_after", text=text, icon="ARROW_LEFTRIGHT", depress=shown)
    if shown:
        row = layout.row()
        row.alert = True
        row.label(text="Viewport and renders show RGB × RGB", icon="ERROR")


def view(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Which view transform is on, whether it is fit to judge colours, and the white."""
    from ..scene.world import view_transform

    fit, line = view_transform.transform_line(context.scene)
    paragraph(layout, context, line, "CHECKMARK" if fit else "INFO")
    if not fit:
        paragraph(layout, context, "To judge colors, set Standard in Render › Color Management")
    on = tags.VIEW in context.scene
    text = "Restore White Balance" if on else "Balance View to This Sky"
    button = layout.operator("skylight.neutral_white", text=text, depress=on)
    button.on = not on


def caption(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What light is in the picture."""
    from ..scene import out_of_date

    found = out_of_date.caption(context.scene)
    if not found:
        layout.label(text="No material is spectral under this sky yet")
        return
    for sentence in found.split("; "):
        paragraph(layout, context, sentence, "INFO")


def table(layout: bpy.types.UILayout) -> None:
    """A row for each spectral material of the file."""
    from ..scene.materials import spectral_material

    found = spectral_material.ours()
    if not found:
        layout.label(text="No material is spectral yet")
        return
    layout.label(text="Color, material, ΔE of RGB × RGB → spectral")
    column = layout.column(align=True)
    for shown in found[:ROWS]:
        row(column.row(), shown)
    if len(found) > ROWS:
        layout.label(text=f"and {len(found) - ROWS} more")


def row(layout: bpy.types.UILayout, shown: bpy.types.Material) -> None:
    """One material: its colour under the sky, what it is, its errors, and what is to be known."""
    from ..scene.materials import glass_and_metal, spectral_material
    from ..transfer.assignment import ESTIMATED

    managed = spectral_material.managed(shown)
    if managed is None:
        pane = glass_and_metal.pane_node(shown) is not None
        text = (
            glass_and_metal.pane_of(shown).name
            if pane
            else "its nodes are missing. Press Remove, then Apply"
        )
        layout.label(text=f"{shown.name}: {text}", icon="MATFLUID" if pane else "ERROR")
        return
    estimated = managed.record.reflectance == ESTIMATED
    layout.prop(shown.skylight, "swatch", text="")
    name = "estimated" if estimated else managed.record.reflectance
    layout.label(text=f"{shown.name}: {name}", icon="QUESTION" if estimated else "NONE")
    result = managed.details.result
    if result is None:
        return
    errors = [result.rgb_delta_E, result.matrix_delta_E]
    text = " → ".join("?" if not math.isfinite(e) else f"{e:.1f}" for e in errors)
    if result.out_of_gamut:
        text += ", clamped"
    layout.label(text=f"ΔE {text}", icon="ERROR" if staleness_handlers.stale(shown) else "NONE")


def _is_by_hand(context: bpy.types.Context) -> bool:
    """Whether materials show bakes that no one but a person makes."""
    world = context.scene.world
    return world is not None and world.skylight.occlusion == BAKED
