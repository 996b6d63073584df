"""How finely Cycles looks for what is bright in a World's sky: ours while it traces the light.

Left to itself Cycles draws a map of 4096 columns or more before each render, which takes over a
second of a processor. A disc of the sun needs no more than three columns to be found.
"""

from __future__ import annotations

import bpy

from ... import tags
from ..blend_data import kept

SUNNY, SUNLESS = 2048, 256
"""Columns of the map: the sun is 0.53 degrees wide."""


def own(world: bpy.types.World, sunny: bool) -> None:
    """Let Cycles draw no larger a map of a World's sky than it needs; a user's own choice stays."""
    cycles = getattr(world, "cycles", None)  # none where that add-on is off
    if cycles is None or not (tags.SKY_MAP in world or cycles.sampling_method == "AUTOMATIC"):
        return
    if tags.SKY_MAP not in world:
        world[tags.SKY_MAP] = cycles.sample_map_resolution
    cycles.sampling_method = "MANUAL"
    cycles.sample_map_resolution = SUNNY if sunny else SUNLESS


def release(world: bpy.types.World) -> None:
    """Give a World its own sampling back."""
    cycles = getattr(world, "cycles", None)
    if cycles is None or tags.SKY_MAP not in world:
        return
    before = world[tags.SKY_MAP]
    if kept.is_number(before):
        cycles.sample_map_resolution = int(before)
    cycles.sampling_method = "AUTOMATIC"
    del world[tags.SKY_MAP]
