"""Taking all of ours out of a file: materials, bakes, lamps, Worlds, groups and properties.

What a person has chosen stays where it can be used again: the files chosen for materials and the
spectra given to lamps.
"""

from __future__ import annotations

import bpy

from ...node_groups import tree as groups
from .. import tags
from .bake import scene_bake
from .day import day_world
from .lights import lighting
from .materials import spectral_material
from .world import hdri, own_worlds, view_exposure

OF_SCENES = (tags.LEFT_ALONE, tags.UNBAKED)
OF_WORLDS = (tags.SETTINGS,)


def is_anything_ours() -> bool:
    """Whether a file holds anything that `clear` takes away; cheap, for panels."""
    return (
        bool(spectral_material.ours())
        or any(groups.KIND in tree for tree in bpy.data.node_groups)
        or any(tags.WORLD_BEFORE in world for world in bpy.data.worlds)
        or any(tag in scene for scene in bpy.data.scenes for tag in (*OF_SCENES, tags.EXPOSURE))
    )


def clear() -> list[str]:
    """Take all of ours away that belongs to no material, once materials are given back; lines.

    Where materials of ours are left, which cannot be changed here, their light stays.
    """
    lines = []
    if baked := scene_bake.remove():
        lines.append(f"{baked} bake(s) removed")
    if any(material.library is None for material in spectral_material.ours()):
        return lines
    for scene in [each for each in bpy.data.scenes if each.is_editable]:
        lighting.clear(scene)
        view_exposure.give_back(scene)
        for tag in OF_SCENES:
            scene.pop(tag, None)
    for world in bpy.data.worlds:
        for tag in OF_WORLDS if world.is_editable else ():
            world.pop(tag, None)
        if tags.OWN_WORLD in world:
            day_world.stop(world)
            hdri.undevelop(world)
    _remove_groups()
    if back := own_worlds.give_back():
        lines.append(f"{back} scene(s) lit by their own World again")
    _remove_groups()
    return lines


def _remove_groups() -> None:
    """Take away the groups of ours that nothing shows, those inside of others last."""
    while unused := [
        tree
        for tree in bpy.data.node_groups
        if groups.KIND in tree and tree.users == 0 and tree.library is None
    ]:
        bpy.data.batch_remove(unused)
