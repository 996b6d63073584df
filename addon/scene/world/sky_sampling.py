"""How finely Cycles looks for what is bright in a World's sky: ours while it traces the light.

Left to itself Cycles draws a map of 4096 columns or more before each render, which takes over a
second of a processor. The sun's disc, 0.53 degrees, is three of 2048 columns. Where it is as small
in the HDRI's own pixels, those of the map must begin and end with them, or Cycles looks beside it.
"""

from __future__ import annotations

import bpy

from ... import tags
from ..blend_data import kept
from . import hdri

LEAST, MOST = 2048, 4096
"""Columns of the map where there is a sun …"""
SUNLESS = 256
"""… and where there is none."""


def own(world: bpy.types.World, sunny: bool) -> None:
    """Let Cycles draw no larger a map of a World's sky than it needs; a user's own choice stays."""
    cycles = getattr(world, "cycles", None)  # none where that add-on is off
    if cycles is None or not (tags.SKY_MAP in world or cycles.sampling_method == "AUTOMATIC"):
        return
    if tags.SKY_MAP not in world:
        world[tags.SKY_MAP] = cycles.sample_map_resolution
    cycles.sampling_method = "MANUAL"
    cycles.sample_map_resolution = _columns(hdri.sky_of(world).image) if sunny else SUNLESS


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


def _columns(image: bpy.types.Image | None) -> int:
    """A multiple of an image's columns, twice as many at least of a small one; `MOST` at most."""
    width = 0 if image is None else int(image.size[0])
    if not width:
        return LEAST
    times = max(-(-LEAST // width), 2)
    return min(times * width, MOST)
