"""The mesh of ours that keeps what was baked for an object, and the modifier that reads it.

The user's mesh is not touched. A bake belongs to an object, not to its mesh: linked duplicates have
one each. See `node_groups.sky_bake` for how it is laid out.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import baked_light, modifiers, sky_bake
from . import surroundings
from .fine_mesh import Fine

LIGHTS = baked_light.LIGHT, baked_light.BEHIND
"""The attributes of a bake's points that hold light."""

_VALUE = {"FLOAT_COLOR": "color", "FLOAT_VECTOR": "vector"}


def modifier_of(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """The `Sky Bake` modifier of an object."""
    return modifiers.of_kind(obj, sky_bake.KIND)


def bake_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """The object of ours that keeps this object's bake, None without one."""
    modifier = modifier_of(obj)
    return None if modifier is None else modifiers.get_input(modifier, "Bake")


def lit_bake_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """The bake of an object that holds light; None also for one by an earlier version."""
    bake = bake_of(obj)
    return bake if bake is not None and is_bake_lit(bake) else None


def is_bake_lit(bake: bpy.types.Object) -> bool:
    """Whether a bake holds light."""
    return baked_light.LIGHT in bake.data.attributes


def is_lit(obj: bpy.types.Object) -> bool:
    """Whether an object has a bake that holds light."""
    return lit_bake_of(obj) is not None


def new(obj: bpy.types.Object) -> bpy.types.Object:
    """A new, empty bake for an object, which has the modifier afterwards and shows it."""
    modifier = modifier_of(obj)
    if modifier is None:
        modifier = obj.modifiers.new(sky_bake.KIND, "NODES")
        modifier.show_in_editmode = False
        modifier.use_pin_to_last = True
    modifier.node_group = sky_bake.ensure()
    name = f"{sky_bake.KIND} {obj.name}"
    bake = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    before = modifiers.get_input(modifier, "Bake")
    modifiers.set_inputs(modifier, Bake=bake, Faces=0, Near=0.0, Back=False)
    write_levels(bake, np.empty(0), np.empty(0))
    if before is not None and not is_bake_lit(before):
        discard([before])
    return bake


def remove(objects: Iterable[bpy.types.Object]) -> None:
    """Take modifiers and bakes of objects away; without any left in the file, the group too."""
    bakes, trees = set(), set()
    for obj in objects:
        modifier = modifier_of(obj)
        if modifier is None:
            continue
        bakes.add(modifiers.get_input(modifier, "Bake"))
        modifiers.set_inputs(modifier, Bake=None)  # which removing it leaves a user of the bake
        trees.add(modifier.node_group)
        obj.modifiers.remove(modifier)
    discard(bake for bake in bakes if bake is not None)
    for tree in trees:
        if not tree.users:
            bpy.data.node_groups.remove(tree)


def discard(bakes: Iterable[bpy.types.Object]) -> None:
    """Take bakes away that no object shows: one that a copy of an object shares is the copy's."""
    # All at once: Blender looks through the whole file for whoever uses what goes.
    gone = [bake for bake in bakes if not bake.users]
    meshes = {bake.data for bake in gone}
    records = {record for bake in gone if (record := surroundings.record_of(bake)) is not None}
    bpy.data.batch_remove(gone)
    bpy.data.batch_remove([each for each in (*meshes, *records) if not each.users])


def as_baked(fine: Fine, bake: bpy.types.Object) -> Fine | None:
    """The faces of an evaluated mesh with the points that its bake has; None of another mesh."""
    mesh, count = bake.data, len(fine.places)
    point = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", point)
    if len(point) != len(fine.point):
        return None
    twins = np.flatnonzero(point >= count)
    twin_of = np.zeros(int(point.max(initial=-1)) + 1 - count if len(twins) else 0, np.int64)
    twin_of[point[twins] - count] = fine.point[twins]
    expected = np.where(point >= count, fine.point, point)
    if not np.array_equal(expected, fine.point):
        return None
    return fine.with_twins(point.astype(np.int64), twin_of)


def write_levels(bake: bpy.types.Object, levels: NDArray, split: NDArray) -> None:
    """Say how often each face (n,) is halved, and whether it is triangulated first."""
    mesh = bake.data
    mesh.clear_geometry()
    mesh.vertices.add(len(levels))
    _store(mesh, sky_bake.LEVEL, "INT8", levels.astype(np.int8))
    _store(mesh, sky_bake.SPLIT, "BOOLEAN", split.astype(bool))
    mesh.update()
    bake.update_tag()


def write(
    bake: bpy.types.Object,
    fine: Fine,
    levels: NDArray,
    split: NDArray,
) -> None:
    """Lay a bake out for the points of an object, which shows it after `show`.

    It is lit by `write_attribute`.
    """
    mesh, points = bake.data, len(fine.places)
    mesh.clear_geometry()
    mesh.vertices.add(points + len(levels))
    mesh.edges.add(1)
    mesh.loops.add(len(fine.point))
    mesh.polygons.add(len(fine.coarse))
    places = np.zeros((points + len(levels), 3), np.float32)
    places[:points] = fine.places
    mesh.vertices.foreach_set("co", places.ravel())
    mesh.loops.foreach_set("vertex_index", fine.point.astype(np.int32))
    mesh.polygons.foreach_set("loop_start", fine.starts[:-1].astype(np.int32))
    # Nobody sees this mesh, and edges would take a third of it: one stands for all.
    mesh.edges.foreach_set("vertices", np.array([0, 1], np.int32))
    mesh.loops.foreach_set("edge_index", np.zeros(len(fine.point), np.int32))
    padded = np.zeros(points + len(levels), np.int8)
    padded[points:] = levels
    _store(mesh, sky_bake.LEVEL, "INT8", padded)
    padded[points:] = split
    _store(mesh, sky_bake.SPLIT, "BOOLEAN", padded.astype(bool))
    for name in (".select_vert", ".select_edge", ".select_poly"):
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])


def show(obj: bpy.types.Object, fine: Fine, backs: bool) -> None:
    """Let an object show the bake that was laid out for its points; ``backs``: whether any has
    light behind it."""
    near = sky_bake.NEAR * float(np.ptp(fine.places, axis=0).max())
    modifiers.set_inputs(modifier_of(obj), Faces=len(fine.places), Near=near, Back=backs)


def tell(bake: bpy.types.Object) -> None:
    """Tell Blender that what a bake keeps has changed."""
    bake.data.update()
    bake.update_tag()


def write_attribute(bake: bpy.types.Object, name: str, values: NDArray) -> None:
    """Keep a colour (p, 4), or three numbers (p, 3), for each point of a bake."""
    mesh, width = bake.data, values.shape[1]
    padded = np.zeros((len(mesh.vertices), width), np.float32)
    padded[: len(values)] = values
    _store(mesh, name, "FLOAT_COLOR" if width == 4 else "FLOAT_VECTOR", padded.ravel())


def read_attribute(bake: bpy.types.Object, name: str) -> NDArray[np.float32]:
    """Return what `write_attribute` has kept, (vertices, 4 or 3)."""
    attribute, count = bake.data.attributes[name], len(bake.data.vertices)
    values = np.empty((count, 4 if attribute.data_type == "FLOAT_COLOR" else 3), np.float32)
    attribute.data.foreach_get(_VALUE[attribute.data_type], values.ravel())
    return values


def _store(mesh: bpy.types.Mesh, name: str, kind: str, values: NDArray) -> None:
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set(_VALUE.get(kind, "value"), values)
