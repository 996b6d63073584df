"""The World of a day: a `Day Sky` that turns with the sun, and back to a sky that stands still."""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from ....node_groups import day_sky
from ....node_groups import tree as groups
from ... import tags
from ...sky.exr_writer import write_exr
from ...sky.sun_course import Course, Curve
from ...spectra.working_spaces import DEFAULT_SPACE
from ..blend_data import drivers, kept
from ..lights import lighting, sun_lamp
from ..world import hdri as worlds
from . import played_lights, values
from . import tiles as key_skies
from .curves import slopes
from .moments import KeySkies, levels_of

NIGHT = np.arange(1.0, 13.0)
"""[degrees] below the lowest sky that is simulated, to which it fades as it has faded until there;
after that it is dark."""

THRESHOLD = 1.5
"""Times the brightest of the sky, over which Eevee takes light of the World for the sun."""


def install(
    world: bpy.types.World, course: Course, found: KeySkies, frames: NDArray, north: float
) -> None:
    """Let a World that shows a single sky show a course's, from a first frame to a last (2,).

    ``north`` [degrees]: where true north is in the scene, clockwise from +Y.
    """
    tree, sky = world.node_tree, worlds.sky_of(world)
    mapping, background = tree.nodes[sky.mapping], tree.nodes[sky.background]
    heights = [moment.elevation for moment in found.moments]
    group = day_sky.ensure()
    day_sky.set_image(
        group,
        _image([key.look.tile for key in found.keys if key.look.tile is not None]),
        len(found.keys),
    )
    node = groups.add(tree, "ShaderNodeGroup", mapping.outputs[0], node_tree=group)
    node.name = node.label = day_sky.KIND
    node.location = background.location.x - 200, background.location.y - 300
    tree.links.new(node.outputs[0], background.inputs["Color"])
    elevation, azimuth = course.elevation, course.azimuth
    key(world, values.ELEVATION, -1, elevation, frames)
    turn = Curve(azimuth.x, turned(azimuth.y, north), np.radians(azimuth.slope))
    key(tree, mapping.inputs["Rotation"].path_from_id("default_value"), 2, turn, frames)

    def follow(owner: Any, path: str, axis: int, rows: Sequence[float] | NDArray) -> None:
        numbers = np.asarray(rows, float)
        values.drive(owner, path, axis, world, heights, numbers, slopes(np.array(heights), numbers))

    ends = np.array([-90.0, 90.0])
    height = node.inputs["Elevation"].path_from_id("default_value")
    values.drive(tree, height, -1, world, ends, ends)
    place = node.inputs["Key"].path_from_id("default_value")
    values.drive(tree, place, -1, world, heights, found.places)
    colors = {
        "Sun": [one.disc for one in found.moments],
        "Ground": [one.below for one in found.moments],
    }
    for name, rows in colors.items():
        path = node.inputs[name].path_from_id("default_value")
        for axis in range(3):
            follow(tree, path, axis, np.array(rows)[:, axis])
    follow(world, "sun_threshold", -1, [THRESHOLD * one.brightest for one in found.moments])
    strength = background.inputs["Strength"].path_from_id("default_value")
    curve = level_of(found)
    values.drive(tree, strength, -1, world, curve.x, curve.y, curve.slope)
    for scene in lighting.scenes_of(world):
        if (lamp := sun_lamp.find(scene, sun_lamp.SUN)) is not None:
            _raise(lamp, world)


def turned(azimuth: NDArray, north: float) -> NDArray:
    """How far [rad] a World is turned for the sun's azimuths [degrees, clockwise from +Y of a scene
    whose north is 0], where directions stand as for a sun over +X."""
    return np.radians(azimuth + north - 90.0)


def key(owner: bpy.types.ID, path: str, axis: int, curve: Curve, frames: NDArray) -> None:
    """Keyframe a number of a World or of its nodes from a first frame to a last (2,)."""
    first, last = (float(frame) for frame in frames)
    at = first + curve.x * (last - first)
    owner.keyframe_insert(path, index=axis, frame=first)
    for each in drivers.curves(owner):
        if each.data_path == path and each.array_index == max(axis, 0):
            values.write_keys(each, at, curve.y, curve.slope / (last - first))


def level_of(found: KeySkies) -> Curve:
    """Return the level by the sun's elevation [degrees]: of all moments computed, and of the
    night."""
    x, level, slope = levels_of(dict(found.levels))
    fade = max(float(slope[0] / level[0]), 1.0)
    y = np.concatenate([level[0] * np.exp(-fade * NIGHT[::-1]), level])
    y[0] = 0.0
    slope = np.concatenate([fade * y[: len(NIGHT)], slope])
    return Curve(np.concatenate([x[0] - NIGHT[::-1], x]), y, slope)


def _raise(lamp: bpy.types.Object, world: bpy.types.World) -> None:
    """Let the sun's lamp stand as high as the sun; it turns with the World already."""
    heights = np.arange(-10.0, 90.1, 10.0)
    turns = [
        (-Vector((math.cos(h), 0.0, math.sin(h)))).to_track_quat("-Z", "Y").to_euler()
        for h in np.radians(heights)
    ]
    for axis, angles in enumerate(np.unwrap(np.array(turns), axis=0).T):
        values.drive(lamp, "rotation_euler", axis, world, heights, angles)


def _image(tiles: Sequence[NDArray[np.float32]]) -> bpy.types.Image:
    """Key skies in one image of the blend file."""
    name = f"{day_sky.KIND}.exr"
    with tempfile.TemporaryDirectory(prefix="skylight-") as folder:
        path = Path(folder) / name
        write_exr(path, {"RGB": key_skies.atlas(list(tiles))}, {})
        image = bpy.data.images.load(str(path))
        image.pack()
    image.filepath_raw = f"//{name}"
    image.colorspace_settings.name = DEFAULT_SPACE
    image.use_half_precision = False
    image.name = day_sky.KIND
    return image


def is_day(world: bpy.types.World | None) -> bool:
    """Whether a World's sky moves through a day."""
    return world is not None and tags.DAY in world


def keep(world: bpy.types.World, **what: Any) -> None:
    """Keep with a World what its day was asked for as."""
    world[tags.DAY] = json.dumps(what)


def kept_of(world: bpy.types.World | None) -> dict[str, Any]:
    """What `keep` kept; empty for a World whose sky stands still."""
    found: dict[str, Any] = {} if world is None else kept.plain(world, tags.DAY, {})
    return found if isinstance(found, dict) else {}


def stop_unused() -> None:
    """Stop the Worlds of this file that light no scene any more: what they lit is lit by others."""
    for world in [each for each in bpy.data.worlds if is_day(each) and each.is_editable]:
        if not lighting.scenes_of(world):
            stop(world)


def stop(world: bpy.types.World) -> None:
    """Let a World's sky stand still, as its highest key sky, and all that followed its sun."""
    if tags.DAY not in world:
        return
    played_lights.stop(world, *kept_of(world).get("baked", (0, 1.0)))
    values.release(world)
    tree = world.node_tree
    for owner in (world, tree):
        if owner.animation_data is not None:
            action = owner.animation_data.action
            owner.animation_data_clear()
            if action is not None and action.users == 0:
                bpy.data.actions.remove(action)
    for scene in lighting.scenes_of(world):
        first, last = kept_of(world).get("range", (scene.frame_start, scene.frame_end))
        scene.frame_start, scene.frame_end = int(first), int(last)
    texture = next((node for node in tree.nodes if node.type == "TEX_ENVIRONMENT"), None)
    for node in [n for n in tree.nodes if groups.kind_of(n) == day_sky.KIND]:
        group = node.node_tree
        for socket in [link.to_socket for link in node.outputs[0].links]:
            socket.node.inputs["Strength"].default_value = 1.0
            if texture is not None:
                tree.links.new(texture.outputs[0], socket)
        tree.nodes.remove(node)
        if group.users == 0:
            image = day_sky.image_of(group)
            bpy.data.node_groups.remove(group)
            if image is not None and image.users == 0:
                bpy.data.images.remove(image)
    del world[tags.DAY], world[tags.SUN_ELEVATION]
