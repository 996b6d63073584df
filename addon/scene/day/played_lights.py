"""Baked light that moves: written for some moments on what keeps bakes, and played by two numbers.

Both are values of one group of modifiers (`node_groups.sky_bake`) for all objects under a World:
the number of the moment, which is keyframed on the World, and the sky's level, its strength.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import sky_bake
from ....node_groups import tree as groups
from ....node_groups.drivers import drive
from ... import tags
from ..bake import storage
from ..blend_data import drivers
from ..world import hdri as worlds
from ..world import light_group
from . import values
from .key_lights import KeyLights

PATH = f'["{tags.BAKED_KEY}"]'


def install(world: bpy.types.World, found: KeyLights, frames: NDArray) -> None:
    """Let all that is baked move with a World from a first frame to a last (2,)."""
    world[tags.BAKED_KEY] = 0.0
    first, last = (float(frame) for frame in frames)
    world.keyframe_insert(PATH, frame=first)
    for curve in drivers.curves(world):
        if curve.data_path == PATH:
            at = first + np.array(found.at) * (last - first)
            values.write_keys(curve, at, np.arange(len(at), dtype=float))
    tree = sky_bake.ensure_day()
    sky = worlds.sky_of(world)
    strength = worlds.value_path(world, sky.background, "Strength")
    assert strength is not None  # the World is one of ours
    for name, path in ((sky_bake.KEY, PATH), (sky_bake.SKY_LEVEL, strength)):
        drive(tree.nodes[name].outputs[0], "default_value", world, path)
    light_group.ensure(world)  # which leaves the strength to them from now on
    objects = {obj.name: obj for obj in bpy.data.objects if obj.library is None}
    steady = dict(found.steady or [])
    for each in zip(*found.values, strict=True):
        name = each[0][0]
        obj = objects[name]
        modifier, bake = storage.modifier_of(obj), storage.bake_of(obj)
        assert modifier is not None and bake is not None  # else it had no light
        for attribute in each[0][1]:
            still = storage.read_attribute(bake, attribute)
            still[:, :3] = 0.0
            if name in steady:
                own = steady[name][attribute]
                still[: len(own)] = own
            storage.write_attribute(bake, attribute, still)
            for k, (_, own) in enumerate(each):
                storage.write_attribute(bake, sky_bake.at_key(attribute, k), own[attribute])
        modifier.node_group = tree
        storage.tell(bake)
        obj.update_tag()


def stop(world: bpy.types.World, key: int, level: float) -> None:
    """Let bakes stand still that moved with a World, in the light of one of their moments, at this
    level of the sky."""
    if tags.BAKED_KEY not in world:
        return
    del world[tags.BAKED_KEY]
    for tree in [each for each in groups.of_kind(sky_bake.KIND) if _follows(each, world)]:
        for obj in bpy.data.objects:
            modifier, bake = storage.modifier_of(obj), storage.bake_of(obj)
            if modifier is None or modifier.node_group != tree:
                continue
            modifier.node_group = sky_bake.ensure()
            if bake is None:
                continue
            for attribute in storage.LIGHTS:
                _stand_still(bake, attribute, key, level)
            storage.tell(bake)
            obj.update_tag()
        bpy.data.node_groups.remove(tree)


def _stand_still(bake: bpy.types.Object, attribute: str, key: int, level: float) -> None:
    """Keep one moment of a bake's, where there are any."""
    attributes = bake.data.attributes
    if sky_bake.at_key(attribute, key) in attributes and attribute in attributes:
        light = storage.read_attribute(bake, attribute)
        light[:, :3] += level * storage.read_attribute(bake, sky_bake.at_key(attribute, key))
        storage.write_attribute(bake, attribute, light)
    for name in list(_moments(bake, attribute)):
        attributes.remove(attributes[name])


def _moments(bake: bpy.types.Object, attribute: str) -> Iterator[str]:
    """The names of the attributes that hold another's moments."""
    start = sky_bake.at_key(attribute, "")
    for name in [each.name for each in bake.data.attributes]:
        if name.startswith(start) and name[len(start) :].isdigit():
            yield name


def _follows(tree: bpy.types.NodeTree, world: bpy.types.World) -> bool:
    """Whether a group of modifiers follows a World."""
    data = tree.animation_data
    curves = data.drivers if data is not None and sky_bake.is_day(tree) else ()
    return any(t.id == world for c in curves for v in c.driver.variables for t in v.targets)
