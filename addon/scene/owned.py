"""Settings of materials that are ours while they are managed, given back as they were.

Cycles takes every emitting surface for a lamp and sends rays to it. A managed wall is none: its
light reaches others by chance as well, and with less noise, see `tests/scene/test_mixed_scenes.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

KEPT = "spectral_skylight_kept"  # on the material: what its settings were
UNSET = ""  # it was Blender's default
METAL = "spectral_skylight_metal"  # on the material: n and k of its metal
SURFACE = {"cycles.emission_sampling": "NONE"}
"""What a managed material needs."""
GLASS = {"surface_render_method": "BLENDED", "use_transparent_shadow": True}
"""What a glazing needs: only what is blended shows a colour through it in Eevee."""


def own(material: bpy.types.Material, settings: dict[str, Any] = SURFACE) -> None:
    """Set a material's settings and keep what was there before, once."""
    kept = dict(material.get(KEPT, {}))
    for path, owner, name in _found(material, settings):
        kept.setdefault(path, getattr(owner, name) if owner.is_property_set(name) else UNSET)
        setattr(owner, name, settings[path])
    material[KEPT] = kept


def give_back(material: bpy.types.Material) -> None:
    """Give a material its settings back; one that a user has changed meanwhile stays.

    What else we keep on a material leaves with that.
    """
    kept = dict(material.get(KEPT, {}))
    for path, owner, name in _found(material, kept):
        if getattr(owner, name) == {**SURFACE, **GLASS}[path]:
            owner.property_unset(name)
            if kept[path] != UNSET:
                setattr(owner, name, kept[path])
    for key in (KEPT, METAL):
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
