"""RGB × RGB beside spectral colors in one 3D view, left and right of a line that is dragged.

The right side is the view itself. The left side is a picture of the same view, drawn once it stands
still, while the materials show RGB × RGB for that moment: nothing of it lies in the blend file, and
no render shows it. A split inside the shader would be alive while one turns the view, too, but
every render would pay for it, in each of its pixels.
"""

# mypy: disable-error-code="valid-type"

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import split_drawing, staleness_handlers, view
from .last_guard import handler as guarded
from .last_guard import line
from .translation import translated

PAUSE = 0.3
"""[s] without a change before the picture is drawn."""

BUDGET = 0.15
"""[s] for samples of the picture beyond the first: Blender waits meanwhile."""

REACH = 8
"""[pixels at scale 1] from the line, within which the mouse takes it."""

SHADINGS = ("MATERIAL", "RENDERED")


@dataclass
class Split:
    """A view that is split: its region by its address, for no reference may be kept to it.

    ``place``: the line's, 0 to 1 of the width; ``of``: what the ``picture`` shows, None before.
    """

    region: int
    place: float = 0.5
    picture: Any = None
    of: Any = None
    changes: int = 0
    seen: Any = None
    since: float = field(default_factory=time.monotonic)


_split: Split | None = None
_handler: Any = None
_drawing = False


def is_on() -> bool:
    """Whether a view is split."""
    return _split is not None


def off() -> None:
    """Let the view be whole again."""
    global _split, _handler
    if _split is None:
        return
    if _split.picture is not None:
        _split.picture.free()
    bpy.types.SpaceView3D.draw_handler_remove(_handler, "WINDOW")
    _split = _handler = None
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    bpy.app.handlers.depsgraph_update_post.remove(_changed)
    _redraw()


def _on(region: bpy.types.Region) -> None:
    global _split, _handler
    _split = Split(region.as_pointer())
    _handler = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
    bpy.app.handlers.depsgraph_update_post.append(_changed)
    bpy.app.timers.register(_tick, first_interval=PAUSE, persistent=True)
    _redraw()


def _redraw() -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _of_view(region: bpy.types.Region, space: bpy.types.SpaceView3D, changes: int) -> Any:
    """All that the picture of a view depends on."""
    camera = tuple(tuple(row) for row in space.region_3d.perspective_matrix)
    return camera, region.width, region.height, space.shading.type, changes


@guarded
def _draw() -> None:
    """Draw the picture left of the line, and the line: the last of what a redraw draws."""
    context = bpy.context
    if _split is None or _drawing or context.region.as_pointer() != _split.region:
        return
    now = _of_view(context.region, context.space_data, _split.changes)
    if now != _split.seen:
        _split.seen, _split.since = now, time.monotonic()
    width, height = context.region.width, context.region.height
    place = round(_split.place * width)
    if _split.of == now:
        split_drawing.picture(context, _split.picture.texture_color, place)
        split_drawing.words(context, place, "RGB")
    else:
        split_drawing.words(context, place, "RGB: hold still")
    split_drawing.line(place, height)


def _tick() -> float | None:
    """Draw the picture anew once the view has stood still: a timer's turn."""
    if _split is None:
        return None
    found = _view_of(_split.region)
    if found is None:  # the editor was closed, or another file opened
        off()
        return None
    window, area, region = found
    space = area.spaces.active
    if space.shading.type not in SHADINGS or not _is_spectral():
        off()
        return None
    now = _of_view(region, space, _split.changes)
    rests = now == _split.seen and time.monotonic() - _split.since > PAUSE
    busy = window.screen.is_animation_playing or bpy.app.is_job_running("RENDER")
    if rests and not busy and now != _split.of:
        try:
            with bpy.context.temp_override(window=window, area=area, region=region):
                _take(bpy.context, region, space)
        except Exception as error:  # a timer that fails is not called again
            line(error)
            off()
            return None
        _split.of = now
        area.tag_redraw()
    return 0.1


def _take(context: bpy.types.Context, region: bpy.types.Region, space: Any) -> None:
    """Draw the view with RGB × RGB into the picture, as many samples as there is time for."""
    import gpu

    from ..scene.materials import rgb_comparison

    global _drawing
    assert _split is not None
    picture = _split.picture
    if picture is None or (picture.width, picture.height) != (region.width, region.height):
        if picture is not None:
            picture.free()
        picture = _split.picture = gpu.types.GPUOffScreen(region.width, region.height)
    own = space.region_3d
    _drawing = True
    try:
        with staleness_handlers.ours(context):
            rgb_comparison.show(rgb_comparison.RGB)
        until = None
        for _ in range(max(context.scene.eevee.taa_samples, 1)):
            picture.draw_view3d(
                context.scene,
                context.view_layer,
                space,
                region,
                own.view_matrix,
                own.window_matrix,
                do_color_management=True,
            )
            until = until or time.monotonic() + BUDGET  # the first may compile shaders
            if time.monotonic() > until:
                break
    finally:
        with staleness_handlers.ours(context):
            rgb_comparison.show(rgb_comparison.SPECTRAL)
        _drawing = False


def _view_of(region: int) -> tuple[Any, Any, Any] | None:
    """The window, the area and the region of a region's address."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            for each in area.regions if area.type == "VIEW_3D" else ():
                if each.as_pointer() == region:
                    return window, area, each
    return None


def _is_spectral() -> bool:
    """Whether there is something to compare, and the view itself shows spectral colors."""
    from ..scene.materials import rgb_comparison, spectral_material

    return bool(spectral_material.ours()) and not rgb_comparison.shown_now()


@persistent
@guarded
def _changed(*_: Any) -> None:
    if _split is not None and not _drawing:
        _split.changes += 1


class SKYLIGHT_OT_split_view(bpy.types.Operator):
    """Show RGB × RGB left of a line in this 3D view, spectral colors right of it. Drag the line. \
Renders do not show it. Each time the view comes to rest, Blender draws it once more"""

    bl_idname = "skylight.split_view"
    bl_label = "Split"
    bl_options = {"REGISTER"}  # a view is no part of what Blender undoes

    @classmethod
    def poll(cls, context):
        """Whether there is something to split, and a view that shows it."""
        why = cls.disabled_reason(context)
        if why:
            cls.poll_message_set(translated(why))
        return not why

    @classmethod
    def disabled_reason(cls, context):
        """Why nothing can be split here, empty where it can."""
        if why := view.nothing_to_compare():
            return why
        area = context.area
        if bpy.app.background or area is None or area.type != "VIEW_3D":
            return "Press it in the sidebar of a 3D view"
        if context.scene.render.engine == "BLENDER_WORKBENCH":
            return "Workbench does not show shaders: set the render engine to Eevee or Cycles"
        return ""

    def execute(self, context):
        """Split the view, or let it be whole."""
        from ..scene.materials import rgb_comparison

        if is_on():
            off()
            return {"FINISHED"}
        rgb_comparison.show(rgb_comparison.SPECTRAL)
        space = context.space_data
        eevee = context.scene.render.engine.startswith("BLENDER_EEVEE")
        if space.shading.type not in SHADINGS or (space.shading.type == "RENDERED" and not eevee):
            view.show(context, everywhere=False)  # Cycles draws no picture of a view beside it
        _on(next(region for region in context.area.regions if region.type == "WINDOW"))
        return {"FINISHED"}


class SKYLIGHT_GT_line(bpy.types.Gizmo):
    """The line, as the mouse takes it."""

    bl_idname = "SKYLIGHT_GT_line"

    def draw(self, context):
        """Nothing: the picture's end is drawn with the picture."""

    def test_select(self, context, location):
        """0 where the mouse is at the line."""
        scale = context.preferences.system.ui_scale or 1.0
        if _split is None:
            return -1
        return 0 if abs(location[0] - _split.place * context.region.width) < REACH * scale else -1

    def invoke(self, context, event):
        """Take it."""
        self.before = _split.place if _split is not None else 0.5
        return {"RUNNING_MODAL"}

    def modal(self, context, event, tweak):
        """Move it with the mouse, within the view."""
        if _split is not None:
            _split.place = min(max(event.mouse_region_x / context.region.width, 0.02), 0.98)
            context.area.tag_redraw()
        return {"RUNNING_MODAL"}

    def exit(self, context, cancel):
        """Leave it there, or where it was."""
        if cancel and _split is not None:
            _split.place = self.before
            context.area.tag_redraw()


class SKYLIGHT_GGT_split(bpy.types.GizmoGroup):
    """The gizmos of a split view."""

    bl_idname = "SKYLIGHT_GGT_split"
    bl_label = "Split"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context):
        """Whether this view is split."""
        return _split is not None and context.region.as_pointer() == _split.region

    def setup(self, context):
        """One line."""
        self.gizmos.new(SKYLIGHT_GT_line.bl_idname).use_draw_modal = True


CLASSES = (SKYLIGHT_OT_split_view, SKYLIGHT_GT_line, SKYLIGHT_GGT_split)


def attach() -> None:
    """Nothing is split before anyone asks."""


def detach() -> None:
    """Let no view be split."""
    off()
