"""Panels for those who look rather than read: reflectance and matrix, the sky's map, errors."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import bpy

from ..errors import InputError
from . import material_panel, panel_text, panels, preview_cache, properties, targets
from .translation import translated

ROWS = 30
"""Materials whose errors are shown as bars."""


class OfMaterial:
    """Pictures of the material that is shown; there are none before it is spectral."""

    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        from ..scene.materials import spectral_material

        return spectral_material.is_managed(targets.active(context))


class Curve(OfMaterial):
    """The reflectance over the wavelengths, in the light of the sky."""

    bl_label = "Reflectance and Sky"

    def draw(self, context):
        from ..scene import portraits

        found = portraits.portrait(targets.active(context))
        if found is None:
            return
        _show(self.layout, context, found, "draw_curve")
        if found.estimated:
            panel_text.paragraph(self.layout, context, "Estimated, not measured", "INFO")
        elif found.measured is not None:
            low, high = found.measured
            panel_text.paragraph(self.layout, context, f"Measured from {low:g} to {high:g} nm")
        if found.spectrum is None:
            panel_text.paragraph(
                self.layout, context, "Press Update to show the spectrum of the sky"
            )


class Matrix(OfMaterial):
    """How much of each of the sky's channels goes to each of the material's."""

    bl_label = "Matrix"

    def draw(self, context):
        from ..scene import portraits

        found = portraits.portrait(targets.active(context))
        if found is None:
            return
        _show(self.layout, context, found, "draw_matrix")
        panel_text.paragraph(self.layout, context, "RGB × RGB uses only the outlined diagonal")


class SKYLIGHT_PT_curve(Curve, panels.Sidebar, bpy.types.Panel):
    """In the sidebar, under the active material."""

    bl_parent_id = "SKYLIGHT_PT_material"


class SKYLIGHT_PT_matrix(Matrix, panels.Sidebar, bpy.types.Panel):
    """In the sidebar, under the active material."""

    bl_parent_id = "SKYLIGHT_PT_material"


class SKYLIGHT_PT_curve_properties(Curve, material_panel.Properties, bpy.types.Panel):
    """In the material's properties."""

    bl_context = "material"
    bl_parent_id = "SKYLIGHT_PT_material_properties"


class SKYLIGHT_PT_matrix_properties(Matrix, material_panel.Properties, bpy.types.Panel):
    """In the material's properties."""

    bl_context = "material"
    bl_parent_id = "SKYLIGHT_PT_material_properties"


class SKYLIGHT_PT_sky_map(panels.OfWorld, bpy.types.Panel):
    """Where the HDRI's pixels are no skylight."""

    bl_label = "Map of the Sky"
    bl_order = 13

    def draw(self, context):
        from ..scene import portraits

        world, theme = context.scene.world, theme_name()
        sky = portraits.sky_key(world)
        if sky is None:
            panel_text.paragraph(self.layout, context, "Make a material spectral to show the map")
            return
        picture(self.layout, context, (sky, theme), partial(_draw_sky, world.session_uid, theme))
        text = "Magenta marks light that is not from sun or sky: leaves, walls, lamps, a tint"
        panel_text.paragraph(self.layout, context, text)


class SKYLIGHT_PT_errors(panels.OfWorld, bpy.types.Panel):
    """What is expected of each material: RGB × RGB and the spectral matrix."""

    bl_label = "Expected Errors"
    bl_order = 15

    def draw(self, context):
        from ..scene import portraits

        rows = portraits.expected()
        if not rows:
            self.layout.label(text="No material is spectral yet")
            return
        known = [value for _, *row in rows for value in row if math.isfinite(value)]
        longest = max([1.0, *known])
        text = "ΔE (CIEDE2000, 1 is just noticeable) of RGB × RGB, then of spectral"
        panel_text.paragraph(self.layout, context, text)
        for name, today, ours in rows[:ROWS]:
            split = self.layout.split(factor=0.4)
            split.label(text=name, translate=False)
            column = split.column(align=True)
            column.scale_y = 0.75
            for value in (today, ours):
                if math.isfinite(value):
                    column.progress(factor=value / longest, text=f"{value:.2f}", translate=False)
                else:
                    column.progress(factor=0.0, text="unknown")
        if len(rows) > ROWS:
            self.layout.label(text=translated(f"and {len(rows) - ROWS} more"))


def _draw_sky(uid: int, theme: str) -> Any:
    """Draw the map of the World of a session's id."""
    from ..pictures.sky_map import sky_map
    from ..pictures.theme import THEMES
    from ..scene import use_cases

    world = next((each for each in bpy.data.worlds if each.session_uid == uid), None)
    if world is None:
        raise InputError("the World", "no longer exists", "choose another")
    light = use_cases.analyzed(world, properties.settings_of(world))
    return sky_map(light.outside, light.sky, light.sun, theme=THEMES[theme])


def _draw_material(portrait: Any, method: str, theme: str) -> Any:
    """Draw one of a portrait's pictures."""
    from ..pictures.theme import THEMES

    return getattr(portrait, method)(theme=THEMES[theme])


def _show(layout, context, portrait, method: str) -> None:
    """Show one of a portrait's pictures."""
    key = (portrait, method, theme_name())
    picture(layout, context, key, partial(_draw_material, *key))


def picture(layout, context, key, draw) -> None:
    """Show a picture as wide as the panel; a word where there is none yet."""
    found = preview_cache.icon(key, draw)
    if found:
        layout.template_icon(icon_value=found, scale=_scale(context))
    elif preview_cache.problem(key):
        panel_text.paragraph(layout, context, preview_cache.problem(key), "ERROR")
    else:
        layout.label(text="Drawing...", icon="TIME")


def _scale(context) -> float:
    """How many icons wide the panel is."""
    width = context.region.width if context.region else 300
    unit = 20.0 * (context.preferences.system.ui_scale or 1.0)  # 0 without a window
    return min(max(width / unit - 2.5, 6.0), 18.0)


def theme_name() -> str:
    """Which of the pictures' themes goes with Blender's."""
    text = bpy.context.preferences.themes[0].user_interface.wcol_regular.text
    return "dark" if sum(text[:3]) > 1.5 else "light"


CLASSES = (
    SKYLIGHT_PT_curve,
    SKYLIGHT_PT_matrix,
    SKYLIGHT_PT_curve_properties,
    SKYLIGHT_PT_matrix_properties,
    SKYLIGHT_PT_sky_map,
    SKYLIGHT_PT_errors,
)
