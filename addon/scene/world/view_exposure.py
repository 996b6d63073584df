"""The exposure of the picture under a sky whose levels are known: Blender's own, of the view.

It changes what is seen and what is saved through the view, such as PNG. Skies, lamps, the light
meter and EXR files keep their levels.
"""

from __future__ import annotations

import math

import bpy

from ... import tags
from ..blend_data import kept

WIDEST = 10.0
"""[stops]. As far as Blender's slider goes: by dusk a picture is then darker than by day."""


def expose(scene: bpy.types.Scene, white: float) -> str:
    """Let the brightest white surface, of this radiance, be just white in a scene's view; a line.

    Only where the view's exposure is Blender's 0, or still what this has set: another is a
    person's. The line is empty where nothing changes.
    """
    view = scene.view_settings
    ours = _is_ours(scene)
    if white <= 0.0 or not (ours or view.exposure == 0.0):
        return ""
    wanted = round(min(max(-math.log2(white), -WIDEST), WIDEST), 1)
    before = view.exposure
    view.exposure = wanted
    scene[tags.EXPOSURE] = view.exposure
    if view.exposure == before:
        return ""
    return f"View exposure set to {wanted:+.1f}: the light keeps its level"


def give_back(scene: bpy.types.Scene) -> None:
    """Give a scene's view its exposure of 0 back, where `expose` has set it and nobody since."""
    if _is_ours(scene):
        scene.view_settings.exposure = 0.0
    scene.pop(tags.EXPOSURE, None)


def _is_ours(scene: bpy.types.Scene) -> bool:
    found = scene.get(tags.EXPOSURE)
    return kept.is_number(found) and float(found) == scene.view_settings.exposure
