"""What the viewport shows: the right shading, RGB times RGB for comparison, a neutral white."""

# mypy: disable-error-code="valid-type"

from collections.abc import Iterator

import bpy

from .. import tags
from . import operator

SHADINGS = (
    (
        "AUTO",
        "What Fits",
        "Rendered in Eevee; Material Preview of the scene's light where the "
        "scene renders with another engine",
    ),
    ("RENDERED", "Rendered", "As the scene's render engine shows it"),
    ("MATERIAL", "Material Preview", "Eevee, with the scene's own World and lamps"),
)
SHOWN = (
    ("TOGGLE", "The Other", "What does not show now"),
    ("BEFORE", "RGB × RGB", "Before: as Blender multiplies colors"),
    ("AFTER", "Spectral", "After: our numbers"),
)


def _views(context, everywhere: bool) -> Iterator[bpy.types.SpaceView3D]:
    """The 3D views of all windows, or the one that the mouse is in."""
    if not everywhere and getattr(context.space_data, "type", "") == "VIEW_3D":
        yield context.space_data
        return
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                yield area.spaces.active


class SKYLIGHT_OT_show_in_viewport(bpy.types.Operator):
    """Let 3D views show the scene's own sky and lamps: Material Preview starts with Blender's \
studio light, and Solid mode knows no shader, only each material's color under this sky"""

    bl_idname = "skylight.show_in_viewport"
    bl_label = "Show in Viewport"
    bl_options = {"REGISTER"}  # views are no part of what Blender undoes

    shading: bpy.props.EnumProperty(name="Shading", items=SHADINGS)
    everywhere: bpy.props.BoolProperty(
        name="All Views", description="In all 3D views, not this one alone", default=True
    )

    @classmethod
    def poll(cls, context):
        why = "" if any(True for _ in _views(context, True)) else "No 3D view is open"
        if context.scene.render.engine == "BLENDER_WORKBENCH":
            why = "Workbench knows no shaders: choose Eevee or Cycles as the render engine"
        if why:
            cls.poll_message_set(why)
        return not why

    def execute(self, context):
        """Switch the shading of the views."""
        kind = self.shading
        if kind == "AUTO":
            eevee = context.scene.render.engine.startswith("BLENDER_EEVEE")
            kind = "RENDERED" if eevee else "MATERIAL"
        for view in _views(context, self.everywhere):
            view.shading.type = kind
            for name in ("world", "lights"):
                setattr(view.shading, f"use_scene_{name}", True)
                setattr(view.shading, f"use_scene_{name}_render", True)
        return {"FINISHED"}


class SKYLIGHT_OT_before_after(operator.Thin, bpy.types.Operator):
    """Let materials show RGB × RGB, as Blender has it, or the spectral colors again. Only numbers \
change, so that the view follows at once"""

    bl_idname = "skylight.before_after"
    bl_label = "Before / After"

    show: bpy.props.EnumProperty(name="Show", items=SHOWN)

    @classmethod
    def hindrance(cls, context):
        from ..scene.materials import spectral_material

        found = spectral_material.ours()
        if not found:
            return "No material is spectral yet"
        known = any(tags.COMPARISON in material for material in found)
        return "" if known else "An earlier version kept no RGB × RGB: press Update first"

    def run(self, context):
        from ..scene.materials import rgb_comparison

        rgb = not rgb_comparison.shown_now() if self.show == "TOGGLE" else self.show == "BEFORE"
        count = rgb_comparison.show(rgb)
        if rgb:
            return [("WARNING", f"{count} material(s) show RGB × RGB: renders would too")]
        return [("INFO", f"{count} material(s) show spectral colors again")]


class SKYLIGHT_OT_neutral_white(operator.Thin, bpy.types.Operator):
    """Let white in the sky's light look white, by the View's own White Balance, or give that back \
as it was. Scene-linear values, as in EXR, stay as they are"""

    bl_idname = "skylight.neutral_white"
    bl_label = "Neutral White"

    on: bpy.props.BoolProperty(name="On", default=True)

    @classmethod
    def hindrance(cls, context):
        from ..scene.world import view_transform

        return (
            ""
            if tags.VIEW in context.scene
            else view_transform.hindrance(context.scene, _level(context))
        )

    def run(self, context):
        from ..scene.world import view_transform

        if self.on:
            return [("INFO", view_transform.neutral(context.scene, _level(context)))]
        view_transform.give_back(context.scene)
        return [("INFO", "the view's white is as it was")]


def _level(context):
    from ..scene.world import light_group

    record = light_group.record_of(context.scene.world)
    return None if record is None else record.level or None


CLASSES = (SKYLIGHT_OT_show_in_viewport, SKYLIGHT_OT_before_after, SKYLIGHT_OT_neutral_white)
