"""What the numbers of a World's HDRI mean, kept with the World for whoever comes next."""

from __future__ import annotations

import json
from typing import Any

import bpy

SETTINGS = "spectral_skylight_settings"


def stored(world: bpy.types.World | None) -> dict[str, Any]:
    """The settings that a World's materials were made with, or are to be; empty before any."""
    return {} if world is None else json.loads(world.get(SETTINGS, "{}"))


def store(world: bpy.types.World, settings: dict[str, Any]) -> None:
    """Keep settings with a World: names, numbers and lists; None is left out."""
    given = {name: value for name, value in settings.items() if value is not None}
    world[SETTINGS] = json.dumps(given)
