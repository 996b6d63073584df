"""The closed panel of all materials: a row each, and those that one click left alone."""

from __future__ import annotations

import math

import bpy

from ..grouping import grouped
from . import staleness_handlers
from .panel_text import paragraph
from .translation import translated

ROWS = 50
"""Materials that the table shows: a panel is drawn anew whenever the mouse moves over it."""


SWATCH = 0.15
"""The part of a row that a material's color has."""


def table(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A row for each spectral material of the file."""
    from ..scene.materials import spectral_material

    found = spectral_material.ours()
    if not found:
        layout.label(text="No material is spectral yet")
        return
    paragraph(layout, context, "Color, material, ΔE of RGB × RGB → spectral")
    column = layout.column(align=True)
    for shown in found[:ROWS]:
        row(column.row(), shown)
    if len(found) > ROWS:
        layout.label(text=translated(f"and {len(found) - ROWS} more"))


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
        line = translated(f"{shown.name}: {text}")
        layout.label(text=line, icon="MATFLUID" if pane else "ERROR", translate=False)
        return
    estimated = managed.record.reflectance == ESTIMATED
    layout = layout.split(factor=SWATCH)
    layout.prop(shown.skylight, "swatch", text="")
    layout = layout.row()
    name = shown.name if estimated else f"{shown.name}: {managed.record.reflectance}"
    layout.label(text=name, icon="QUESTION" if estimated else "NONE", translate=False)
    result = managed.details.result
    if result is None:
        return
    errors = [result.rgb_delta_E, result.matrix_delta_E]
    text = " → ".join("?" if not math.isfinite(e) else f"{e:.1f}" for e in errors)
    if result.out_of_gamut:
        text += translated(", clamped")
    icon = "ERROR" if staleness_handlers.stale(shown) else "NONE"
    layout.label(text=text, icon=icon, translate=False)


def left(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A paragraph for each reason why one click left materials alone."""
    from ..scene import use_cases

    found = use_cases.left_alone(context.scene)
    if not found:
        return
    layout.label(text="Left alone:")
    for line in grouped(found)[:ROWS]:
        paragraph(layout, context, line)
