"""The second box of the panel: what the scene is made of."""

from __future__ import annotations

import bpy

from .. import tags
from ..grouping import grouped
from . import panel_text, staleness_handlers
from .look_box import CLOSE
from .translation import translated

ROWS = 3
"""Reasons why materials need the person."""


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """One click for all, how many are spectral, and what needs the person."""
    box = layout.box()
    column = box.column()
    column.scale_y = 1.4
    column.operator("skylight.make_spectral", icon="MATERIAL")
    box.label(text=translated(summary(context)))
    _unsure(box, context)
    _changed(box, context)


def _unsure(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The material that a measurement would change most, where that is to be seen."""
    from ..scene import portraits

    name, change = portraits.unsure() or ("", 0.0)
    if change >= CLOSE and not panel_text.is_of_other_sky(context):
        row = layout.row()
        row.label(text=translated(f"ΔE {change:.1f} unsure: {name}"))
        button = row.operator("skylight.browse_library", text="", icon="ASSET_MANAGER")
        button.material = name


def summary(context: bpy.types.Context) -> str:
    """How many materials are spectral, in one line."""
    from ..scene import use_cases
    from ..scene.blend_data import kept
    from ..scene.materials import spectral_material
    from ..transfer.assignment import ESTIMATED

    names = [kept.mapping(m, tags.MATERIAL).get("reflectance") for m in spectral_material.ours()]
    if not names:
        return "No material is spectral yet"
    total = len(names) + len(use_cases.left_alone(context.scene))
    guessed = names.count(ESTIMATED)
    return f"{len(names)} of {total}: {len(names) - guessed} measured, {guessed} estimated"


def _changed(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    found = [(m.name, staleness_handlers.stale(m)) for m in staleness_handlers.stale_materials()]
    for line in grouped(found)[:ROWS]:
        panel_text.paragraph(layout, context, line, "ERROR")
    if found:
        layout.label(text="Press Make Everything Spectral again")
