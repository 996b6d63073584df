"""Settings of materials that are ours while they are managed, given back as they were.

Cycles takes every emitting surface for a lamp and sends rays to it. A managed wall is none: its
light reaches others by chance as well, and with less noise, see `tests/scene/test_mixed_scenes.py`.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any

import bpy

from ... import tags
from ..blend_data import kept

UNSET = ""  # it was Blender's default
SURFACE = {"cycles.emission_sampling": "NONE"}
"""What a managed material needs."""
GLASS = {"surface_render_method": "BLENDED", "use_transparent_shadow": True}
"""What a glazing needs: only what is blended shows a colour through it in Eevee."""


def own(material: bpy.types.Material, settings: dict[str, Any] = SURFACE) -> None:
    """Set a material's settings and keep what was there before, once."""
    before = kept.mapping(material, tags.MATERIAL_SETTINGS)
    for path, owner, name in _found(material, settings):
        before.setdefault(path, getattr(owner, name) if owner.is_property_set(name) else UNSET)
        setattr(owner, name, settings[path])
    material[tags.MATERIAL_SETTINGS] = before


def show_colour(material: bpy.types.Material, rgb: Iterable[float]) -> None:
    """Give a material another viewport colour, RGB, which Solid mode shows."""
    before = viewport_colour(material)
    material.diffuse_color = (*rgb, before[3])
    material[tags.VIEWPORT_COLOR] = [*before, *material.diffuse_color]


def viewport_colour(material: bpy.types.Material) -> tuple[float, float, float, float]:
    """The viewport colour, RGBA, that a material has of its own: a user's since, or that before."""
    now = tuple(material.diffuse_color)
    before = kept.numbers(material, tags.VIEWPORT_COLOR, 8)
    return before[:4] if before[4:] == now else now  # type: ignore[return-value]


def give_back(material: bpy.types.Material) -> None:
    """Give a material its settings back; one that a user has changed meanwhile stays.

    What else we keep on a material leaves with that.
    """
    ours = {**SURFACE, **GLASS}
    before = kept.mapping(material, tags.MATERIAL_SETTINGS)
    for path, owner, name in _found(material, {key: before[key] for key in before if key in ours}):
        if getattr(owner, name) == ours[path]:
            owner.property_unset(name)
            if before[path] != UNSET:
                with contextlib.suppress(TypeError, ValueError):  # overwritten by hand
                    setattr(owner, name, before[path])
    material.diffuse_color = viewport_colour(material)
    for key in (
        tags.MATERIAL_SETTINGS,
        tags.METAL,
        tags.VIEWPORT_COLOR,
        tags.COMPARISON,
        tags.SHOWS_RGB,
    ):
        if key in material:
            del material[key]


def _found(
    material: bpy.types.Material, settings: dict[str, Any]
) -> Iterator[tuple[str, Any, str]]:
    """Path, owner and name of the settings that this Blender has (Cycles may be switched off)."""
    for path in settings:
        *owners, name = path.split(".")
        owner = getattr(material, owners[0], None) if owners else material
        if hasattr(owner, name):
            yield path, owner, name
