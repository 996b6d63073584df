"""The sun of a World's HDRI as a lamp: what casts shadows where the panorama only has a disc.

The lamp shines on managed objects alone, so strong that nothing else counts in their light probe
(`node_groups.light_probe`): it tells where the sun is seen, its colour lies in the World's group.
Unmanaged objects keep the World, from which Eevee pulls the same sun by `World.sun_threshold`; that
setting is ours meanwhile. Cycles finds the sun in the HDRI itself for them.
"""

from __future__ import annotations

import math
from collections.abc import Container

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from ....node_groups import light_probe
from ....node_groups import tree as groups
from ....node_groups.drivers import drive
from ....node_groups.skylight_surface import TRACED
from ... import tags
from ..blend_data import kept
from ..world import hdri as worlds
from . import light_linking

SUN, TURN = "sun", "turn"
FAINT = 1e-5  # a lamp's other channels: Cycles makes white of them, the other probes see nothing

_DIAMETER = math.radians(0.5332)
"""Of the sun's disc at its mean distance; panoramas blur and clip it."""


def place(
    scene: bpy.types.Scene,
    direction: NDArray[np.float64],
    rgb: NDArray[np.float64],
    brightest_sky: float,
    lacking: NDArray[np.float64] | None = None,
) -> None:
    """Give a scene the sun of its World: a lamp towards ``direction`` (3,) of the HDRI, up to date.

    ``rgb`` (3,): the irradiance/π that it gives a face that looks at it, ``lacking`` (3,): the part
    that the HDRI has clipped. The lamp turns with the World, also by keyframes; ``brightest_sky``
    is the HDRI's largest value beside the sun. Raises InputError where `hdri.sky_of` does.
    """
    world = scene.world
    sky = worlds.sky_of(world)
    lamp = find(scene, SUN)
    if lamp is None:
        lamp = new_lamp(scene, "Skylight Sun", "SUN", SUN, 0)
    lamp.parent = pivot(scene)
    lamp.data.angle = _DIAMETER
    lamp.data.energy = light_probe.STRENGTH
    lamp.rotation_euler = (-Vector(direction)).to_track_quat("-Z", "Y").to_euler()
    lacking = None if lacking is None else math.pi * lacking
    set_cycles_colour(lamp, math.pi * np.asarray(rgb), 0, lacking)
    _follow_strength(lamp.data, world, worlds.value_path(world, sky.background, "Strength"))
    _own_threshold(world, brightest_sky)


def find(scene: bpy.types.Scene, part: str) -> bpy.types.Object | None:
    """The one object of ours that plays a part in a scene, None without."""
    return next((obj for obj in scene.objects if obj.get(tags.LAMP) == part), None)


def pivot(scene: bpy.types.Scene) -> bpy.types.Object:
    """What turns a scene's lamps with its World's HDRI, made if need be, up to date."""
    turn = find(scene, TURN)
    if turn is None:
        turn = bpy.data.objects.new("Skylight Turn", None)
        turn[tags.LAMP] = TURN
        turn.hide_select = True
        collection(scene).objects.link(turn)
    _turn_with(turn, scene.world, worlds.sky_of(scene.world))
    return turn


def collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The collection of a scene that holds our lamps, made if need be."""
    for child in scene.collection.children:
        if child.get(tags.LAMP):
            return child
    made = bpy.data.collections.new("Skylight Lamps")
    made[tags.LAMP] = "collection"
    scene.collection.children.link(made)
    return made


def new_lamp(
    scene: bpy.types.Scene, name: str, like: str | bpy.types.Light, part: str, channel: int
) -> bpy.types.Object:
    """A lamp of the light probe: its channel's colour, on receivers only, without highlights.

    ``like``: Blender's type of lamp, or a lamp of that form; ``part``: the part that it plays, by
    which it is found.
    """
    light = bpy.data.lights.new(name, like) if isinstance(like, str) else like.copy()
    light.name = name
    if light.animation_data is not None:
        light.animation_data_clear()
    light.color = [1.0 if k == channel else FAINT for k in range(3)]
    light.specular_factor = light.transmission_factor = light.volume_factor = 0.0
    light.exposure = 0.0
    lamp = bpy.data.objects.new(name, light)
    lamp[tags.LAMP] = part
    receivers = light_linking.find(scene) or light_linking.ensure(scene)
    lamp.light_linking.receiver_collection = receivers
    lamp.hide_select = True
    # Cycles knows no specular factor: there it is the World that shines in gloss.
    lamp.visible_glossy = lamp.visible_transmission = lamp.visible_volume_scatter = False
    lamp.visible_camera = False
    collection(scene).objects.link(lamp)
    return lamp


def set_cycles_colour(
    lamp: bpy.types.Object,
    rgb: NDArray[np.float64],
    channel: int,
    lacking: NDArray[np.float64] | None = None,
) -> None:
    """Give a lamp of the probe its true colour in Cycles, which alone reads a lamp's nodes.

    ``rgb`` (3,): what Blender's energy times colour would be without the probe; ``lacking`` (3,):
    the part of it that is in none of the scene's own lights, for where Cycles traces those (see
    `trace`); None: nothing.
    """
    light = lamp.data
    if not light.use_nodes:  # in Blender 5.0 lamps have no nodes of their own yet
        light.use_nodes = True
    tree = light.node_tree
    tree.nodes.clear()
    output = groups.add(tree, "ShaderNodeOutputLight")
    traced = groups.add(tree, "ShaderNodeValue", name=TRACED, label=TRACED)
    traced.outputs[0].default_value = 0.0
    mix = groups.add(tree, "ShaderNodeMixShader", traced.outputs[0])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    colour = np.where(np.arange(3) == channel, 1.0, FAINT) * light_probe.STRENGTH
    own = np.zeros(3) if lacking is None else np.asarray(lacking)
    for k, light in enumerate((np.asarray(rgb) * light_probe.CYCLES_STRENGTH, own)):
        emission = groups.add(tree, "ShaderNodeEmission", (*(light / colour).tolist(), 1.0))
        tree.links.new(emission.outputs[0], mix.inputs[1 + k])


def trace(scene: bpy.types.Scene, on: bool) -> None:
    """Let our lamps of a scene shine by what its own lack in Cycles, which traces those, or else as
    our materials measure them."""
    for obj in scene.objects:
        tree = obj.data.node_tree if obj.type == "LIGHT" and tags.LAMP in obj else None
        if tree is not None and TRACED in tree.nodes:  # an earlier version had none
            tree.nodes[TRACED].outputs[0].default_value = float(on)


def remove(scene: bpy.types.Scene, parts: Container[str]) -> None:
    """Take our objects of these parts out of a scene; without a sun its World has its settings."""
    gone = [obj for obj in scene.objects if obj.get(tags.LAMP) in parts]
    turn = find(scene, TURN)
    if turn is not None and set(turn.children) <= set(gone):
        gone = [*(obj for obj in gone if obj != turn), turn]
    lights = [obj.data for obj in gone if obj.data is not None]
    bpy.data.batch_remove(gone)
    bpy.data.batch_remove([light for light in lights if light.users == 0])
    for child in list(scene.collection.children):
        if child.get(tags.LAMP) and not child.objects:
            bpy.data.collections.remove(child)
    light_linking.forget_unused()
    if SUN in parts:
        release_threshold(scene.world)


def release_threshold(world: bpy.types.World | None) -> None:
    """Give a World its own threshold for suns back."""
    if world is not None and tags.SUN_THRESHOLD in world:
        if before := kept.numbers(world, tags.SUN_THRESHOLD, 2):
            world.sun_threshold, world.use_sun_shadow = before[0], bool(before[1])
        del world[tags.SUN_THRESHOLD]


def _own_threshold(world: bpy.types.World, brightest_sky: float) -> None:
    if tags.SUN_THRESHOLD not in world:
        world[tags.SUN_THRESHOLD] = [world.sun_threshold, float(world.use_sun_shadow)]
    world.sun_threshold = brightest_sky
    world.use_sun_shadow = True


def _follow_strength(light: bpy.types.Light, world: bpy.types.World, path: str | None) -> None:
    for emission in (node for node in light.node_tree.nodes if node.type == "EMISSION"):
        strength = emission.inputs["Strength"]
        if path is not None:
            drive(strength, "default_value", world, path)
        else:
            strength.driver_remove("default_value")
            strength.default_value = 1.0


def _turn_with(pivot: bpy.types.Object, world: bpy.types.World, sky: worlds.WorldSky) -> None:
    """Turn as the HDRI seems to: by the inverse of how its directions are looked up."""
    pivot.rotation_mode = "XYZ" if sky.inverse else "ZYX"
    for axis in range(3):
        pivot.driver_remove("rotation_euler", axis)
        if sky.mapping is None:
            pivot.rotation_euler[axis] = 0.0
            continue
        path = worlds.value_path(world, sky.mapping, "Rotation")
        # The inverse of Rz Ry Rx is Rx Ry Rz by the negative angles.
        sign = 1.0 if sky.inverse else -1.0
        drive(pivot, "rotation_euler", world, f"{path}[{axis}]", axis, sign)
