"""What the viewport shows: the right shading, RGB times RGB for comparison, a neutral white."""

# mypy: disable-error-code="valid-type"

from collections.abc import Iterator

import bpy

from .. import tags
from ..choices import TRACED
from . import operator
from .translation import translated

SHADINGS = (
    (
        "AUTO",
        "Automatic",
        "Rendered if the scene renders with Eevee, else Material Preview",
    ),
    ("RENDERED", "Rendered", "The render engine of the scene"),
    ("MATERIAL", "Material Preview", "Eevee with the World and the lamps of the scene"),
)
SHOWN = (
    ("TOGGLE", "Toggle", "Switch between RGB × RGB and spectral"),
    ("BEFORE", "RGB × RGB", "Before: RGB light times RGB base color, as Blender computes"),
    ("AFTER", "Spectral", "After: spectral shading"),
    (
        "DIFFERENCE",
        "Difference × 8",
        "RGB × RGB, and eight times what spectral shading changes of it",
    ),
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
    """Show the sky and the lamps of the scene in the 3D views. Material Preview otherwise uses \
Blender's studio light, and Solid shading shows only each material's color under this sky"""

    bl_idname = "skylight.show_in_viewport"
    bl_label = "Show in Viewport"
    bl_options = {"REGISTER"}  # views are no part of what Blender undoes

    shading: bpy.props.EnumProperty(
        name="Shading", description="Shading of the 3D views", items=SHADINGS
    )
    everywhere: bpy.props.BoolProperty(
        name="All Views", description="Change all 3D views, not only this one", default=True
    )

    @classmethod
    def poll(cls, context):
        why = "" if any(True for _ in _views(context, True)) else "No 3D view is open"
        if context.scene.render.engine == "BLENDER_WORKBENCH":
            why = "Workbench does not show shaders: set the render engine to Eevee or Cycles"
        if why:
            cls.poll_message_set(translated(why))
        return not why

    def execute(self, context):
        """Switch the shading of the views."""
        show(context, self.shading, self.everywhere)
        return {"FINISHED"}


def show(context: bpy.types.Context, shading: str = "AUTO", everywhere: bool = True) -> None:
    """Let 3D views show the sky and the lamps of the scene; Solid and Wireframe do not."""
    if shading == "AUTO":
        eevee = context.scene.render.engine.startswith("BLENDER_EEVEE")
        world = context.scene.world
        traced = world is not None and world.skylight.occlusion == TRACED  # which Eevee cannot show
        shading = "RENDERED" if eevee or traced else "MATERIAL"
    for view in _views(context, everywhere):
        view.shading.type = shading
        for name in ("world", "lights"):
            setattr(view.shading, f"use_scene_{name}", True)
            setattr(view.shading, f"use_scene_{name}_render", True)


def nothing_to_compare() -> str:
    """Why there is no RGB × RGB to compare with; empty where there is."""
    from ..scene.materials import spectral_material

    found = spectral_material.ours()
    if not found:
        return "No material is spectral yet"
    if any(tags.DAY in world for world in bpy.data.worlds if world.users):
        return "Not while the sky moves: load one sky to compare"
    known = any(tags.COMPARISON in material for material in found)
    return "" if known else "Made with an earlier version: press Update first"


class SKYLIGHT_OT_before_after(operator.Thin, bpy.types.Operator):
    """Switch spectral materials between RGB × RGB, as Blender shades, and spectral colors, in \
renders too. Shaders are not compiled again"""

    bl_idname = "skylight.before_after"
    bl_label = "Before / After"

    show: bpy.props.EnumProperty(name="Show", description="Colors to show", items=SHOWN)

    @classmethod
    def disabled_reason(cls, context):
        return nothing_to_compare()

    def run(self, context):
        from ..scene.materials import rgb_comparison
        from . import split_view

        split_view.off()
        wanted = self.show
        if wanted == "TOGGLE":
            wanted = "AFTER" if rgb_comparison.shown_now() else "BEFORE"
        what, name = {
            "BEFORE": (rgb_comparison.RGB, "RGB × RGB"),
            "AFTER": (rgb_comparison.SPECTRAL, "spectral colors"),
            "DIFFERENCE": (rgb_comparison.DIFFERENCE, "the difference eight times"),
        }[wanted]
        count = rgb_comparison.show(what)
        if what == rgb_comparison.SPECTRAL:
            return [("INFO", f"{count} material(s) show {name}")]
        return [("WARNING", f"{count} material(s) show {name}, also in renders")]


class SKYLIGHT_OT_neutral_white(operator.Thin, bpy.types.Operator):
    """Set the view's White Balance so that white under this sky looks white, or restore it. \
Scene-linear values, as in EXR files, do not change"""

    bl_idname = "skylight.neutral_white"
    bl_label = "Neutral White"

    on: bpy.props.BoolProperty(
        name="On", description="Balance the view. Off: restore it", default=True
    )

    @classmethod
    def disabled_reason(cls, context):
        from ..scene.world import view_transform

        return (
            ""
            if tags.VIEW in context.scene
            else view_transform.disabled_reason(context.scene, _level(context))
        )

    def run(self, context):
        from ..scene.world import view_transform

        if self.on:
            return [("INFO", view_transform.neutral(context.scene, _level(context)))]
        view_transform.give_back(context.scene)
        return [("INFO", "White Balance of the view restored")]


class SKYLIGHT_OT_view_as(operator.Thin, bpy.types.Operator):
    """Set the view transform: Standard shows colors as computed, to judge them. A picture has the \
transform, look and curves that the scene had before"""

    bl_idname = "skylight.view_as"
    bl_label = "View As"

    judge: bpy.props.BoolProperty(
        name="Judge Colors", description="Show colors as computed. Off: as before", default=True
    )

    def run(self, context):
        from ..scene.world import view_transform

        view_transform.judge(context.scene, self.judge)
        return [("INFO", view_transform.transform_line(context.scene)[1].capitalize())]


def _level(context):
    from ..scene.world import light_group

    record = light_group.record_of(context.scene.world)
    return None if record is None else record.level or None


CLASSES = (
    SKYLIGHT_OT_show_in_viewport,
    SKYLIGHT_OT_before_after,
    SKYLIGHT_OT_view_as,
    SKYLIGHT_OT_neutral_white,
)
