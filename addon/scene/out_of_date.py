"""Whether what was made spectral still is what the scene shows."""

from __future__ import annotations

import json

import bpy

from .. import tags
from ..choices import BAKED
from ..transfer.assignment import ESTIMATED
from .bake import scene_bake
from .blend_data import kept
from .lights import lighting
from .materials import base_color, spectral_material
from .world import light_group
from .world.settings import Settings, stored

NOT_BAKED = "no light is baked yet: the open sky lights every face"


def colour(material: bpy.types.Material) -> str:
    """Why a material's reflectance no longer fits its base colour, empty where it does.

    Only for a reflectance that came from there: an estimate, or one that a texture varies.
    """
    managed = spectral_material.managed(material)
    source = None if managed is None else managed.details.source
    if managed is None or source is None or source == tuple(base_color.source(material)):
        return ""
    if managed.record.reflectance == ESTIMATED:
        return "its base color has changed since it was estimated"
    return "its texture has changed since it was measured against"


def look_at_bakes(scene: bpy.types.Scene) -> list[str]:
    """Keep with the active scene which objects have no bake or an old one, where bakes show.

    It evaluates the scene: for a button, not for a panel's drawing.
    """
    names = [obj.name for obj in scene_bake.stale()] if are_shown(scene) else []
    scene[tags.UNBAKED] = json.dumps(names)
    return names


def all_baked(scene: bpy.types.Scene) -> None:
    """Keep that every bake of a scene is new, as after a bake of all."""
    scene[tags.UNBAKED] = "[]"


def are_shown(scene: bpy.types.Scene) -> bool:
    """Whether a scene's materials show bakes."""
    return scene.world is not None and (stored(scene.world) or Settings()).shadows == BAKED


def unbaked(scene: bpy.types.Scene) -> list[str]:
    """What `look_at_bakes` kept; none where materials show no bakes."""
    if not are_shown(scene):
        return []
    found: list[str] = kept.plain(scene, tags.UNBAKED, [])
    return found if kept.are_texts(found) else []


def caption(scene: bpy.types.Scene) -> str:
    """What a picture of a scene must say of its light; empty before any material is spectral."""
    found = light_group.record_of(scene.world)
    return "" if found is None else as_it_is(found.caption, scene.world)


def as_it_is(caption: str, world: bpy.types.World) -> str:
    """Return the caption of a World's light with what materials show until that is baked."""
    if scene_bake.baked():
        return caption
    until = lighting.TRACED_LIGHT if lighting.is_traced(world) else NOT_BAKED
    return caption.replace(lighting.BAKED_LIGHT, until)
