"""Worlds that we made: whose World each stands in for, and how that one comes back.

A scene's own World is never edited. While one of ours lights the scene it has no other user, and
Blender saves nothing that has none: ours holds it.
"""

from __future__ import annotations

import bpy

from ....node_groups import skylight_surface
from ... import tags
from ..blend_data import kept


def take_place(world: bpy.types.World, before: bpy.types.World | None) -> None:
    """Mark a World as ours, in place of another or of the user's that this one stands in for."""
    world[tags.OWN_WORLD] = True
    before = behind(before)
    if before is not None:
        world[tags.WORLD_BEFORE] = before


def behind(world: bpy.types.World | None) -> bpy.types.World | None:
    """The user's World that one of ours stands in for, None for no World; any other itself."""
    if world is None or tags.OWN_WORLD not in world:
        return world
    return kept.data(world, tags.WORLD_BEFORE, bpy.types.World)


def give_back() -> int:
    """Light the file's scenes by their own Worlds again, take ours away and count the scenes.

    The images that only ours have shown leave with them. A World of ours that took no other's place
    is the user's from now on: without it the scene would be dark.
    """
    count = 0
    for scene in [each for each in bpy.data.scenes if each.is_editable]:
        before = behind(scene.world)
        if before is not None and before != scene.world:
            scene.world = before
            count += 1
    for world in [each for each in bpy.data.worlds if tags.OWN_WORLD in each and each.users]:
        if behind(world) is None:
            del world[tags.OWN_WORLD]
    remove_unused()
    return count


def remove_unused() -> None:
    """Take away Worlds of ours that light no scene and no material, and their images."""
    unused = [
        world
        for world in bpy.data.worlds
        if tags.OWN_WORLD in world and world.library is None and world.users == 0
        if skylight_surface.find(world) is None
    ]
    shown = {image for world in unused for image in _images(world)}
    bpy.data.batch_remove(unused)
    bpy.data.batch_remove([image for image in shown if image.users == 0])


def _images(world: bpy.types.World) -> list[bpy.types.Image]:
    nodes = world.node_tree.nodes if world.node_tree else ()
    return [node.image for node in nodes if getattr(node, "image", None) is not None]
