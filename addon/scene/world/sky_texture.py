"""What Blender's Sky Texture says of its sun, whatever its type and the version of Blender."""

from __future__ import annotations

import math
from collections.abc import Iterator

import bpy

from ..blend_data import nodes

WITH_DISC = {"NISHITA", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"}
"""Types that place their sun by elevation and rotation; the older two by a direction."""


def sun_elevation(output: bpy.types.Node | None) -> float | None:
    """The elevation [degrees] of the sun in the one Sky Texture that a World Output shows.

    None where it shows none, several, or an image, and where the texture is turned or the value
    moved by something else.
    """
    found = list(nodes.feeding(output)) if output else []
    skies = [node for node in found if node.type == "TEX_SKY"]
    images = any(node.type in ("TEX_ENVIRONMENT", "TEX_IMAGE") for node in found)
    if len(skies) != 1 or images or not _upright(skies[0]):
        return None
    return elevation(skies[0])


def elevation(sky: bpy.types.Node) -> float:
    """Where the sun of a Sky Texture stands over the horizon [degrees]."""
    x, y, z = direction(sky)
    return math.degrees(math.atan2(z, math.hypot(x, y)))


def direction(sky: bpy.types.Node) -> tuple[float, float, float]:
    """Where (3,) the sun of a Sky Texture stands that nothing turns, in Blender's world."""
    if sky.sky_type in WITH_DISC:
        up, turn = sky.sun_elevation, sky.sun_rotation
        return (math.cos(up) * math.sin(turn), math.cos(up) * math.cos(turn), math.sin(up))
    return tuple(sky.sun_direction)


def suns(output: bpy.types.Node) -> Iterator[tuple[float, float, float]]:
    """Directions of the discs that Sky Textures show a World Output, those that are not turned."""
    for node in nodes.feeding(output):
        disc = node.type == "TEX_SKY" and node.sky_type in WITH_DISC and node.sun_disc
        if disc and _upright(node):
            yield direction(node)


def _upright(sky: bpy.types.Node) -> bool:
    """Whether a Sky Texture is looked up where one looks."""
    vector = sky.inputs.get("Vector")  # which some types have not
    found = None if vector is None else nodes.source(vector)
    return found is None or (found.node.type, found.name) == ("TEX_COORD", "Generated")
