"""What a split view draws over the view: the picture, the line and the words beside it."""

from __future__ import annotations

from typing import Any

import bpy

from .translation import translated

BELOW = 80.0
"""[pixels at scale 1] under the view's top, where its header ends."""


def picture(context: bpy.types.Context, texture: Any, place: int) -> None:
    """Draw a texture as large as the view, as far as the line [pixels from the left]."""
    import gpu
    from gpu_extras.presets import draw_texture_2d

    width, height = context.region.width, context.region.height
    left, below, right, above = _frame(context) or (0, 0, width, height)
    if place <= left:
        return
    before = gpu.state.scissor_get()
    gpu.state.scissor_test_set(True)
    gpu.state.scissor_set(left, below, min(place, right) - left, above - below)
    gpu.state.blend_set("NONE")
    draw_texture_2d(texture, (0, 0), width, height)
    gpu.state.scissor_set(*before)


def _frame(context: bpy.types.Context) -> tuple[int, int, int, int] | None:
    """The camera's frame in its own view [pixels], None in others: the picture has no dark around
    it. Left, below, right, above, within the view."""
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    region, own, camera = context.region, context.region_data, context.space_data.camera
    if own.view_perspective != "CAMERA" or camera is None or camera.type != "CAMERA":
        return None
    corners = [
        location_3d_to_region_2d(region, own, camera.matrix_world.normalized() @ corner)
        for corner in camera.data.view_frame(scene=context.scene)
    ]
    if any(corner is None for corner in corners):
        return None
    across, up = ([round(corner[k]) for corner in corners] for k in (0, 1))
    left, right = max(min(across), 0), min(max(across), region.width)
    below, above = max(min(up), 0), min(max(up), region.height)
    return (left, below, right, above) if left < right and below < above else None


def line(place: int, height: int) -> None:
    """Draw the line, white with a dark rim."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    for half, color in ((1.5, (0.0, 0.0, 0.0, 0.6)), (0.5, (1.0, 1.0, 1.0, 1.0))):
        left, right = place - half, place + half
        corners = [(left, 0), (right, 0), (left, height), (right, height)]
        gpu.state.blend_set("ALPHA")
        shader.uniform_float("color", color)
        batch_for_shader(shader, "TRI_STRIP", {"pos": corners}).draw(shader)
    gpu.state.blend_set("NONE")


def words(context: bpy.types.Context, place: int, left: str) -> None:
    """Draw what the two sides are, ``left`` of the line and right of it."""
    import blf

    scale = context.preferences.system.ui_scale or 1.0
    blf.size(0, 13.0 * scale)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 3, 0.0, 0.0, 0.0, 0.9)
    for text, before in ((translated(left), True), (translated("Spectral"), False)):
        width = blf.dimensions(0, text)[0] + 8.0 * scale
        left_end = place - width if before else place + 8.0 * scale
        blf.position(0, left_end, context.region.height - BELOW * scale, 0)
        blf.draw(0, text)
    blf.disable(0, blf.SHADOW)
