"""The mesh of ours that keeps what was baked for an object, and the modifier that reads it.

The user's mesh is not touched. A bake belongs to an object, not to its mesh: linked duplicates have
one each. See `node_groups.sky_bake` for how it is laid out.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import baked_light, modifiers, sky_bake
from ... import tags
from ...transport.row_keys import row_keys
from . import surroundings
from .geometry import STEP

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


@dataclass
class Fine:
    """An evaluated, subdivided mesh as a bake sees it: its corners brought to points.

    A point is a place with a normal and a material: corners that share all three share it.
    """

    places: NDArray[np.float64]
    """(p, 3), in the object's space."""
    normals: NDArray[np.float64]
    """(p, 3), unit."""
    point: NDArray[np.int64]
    """(c,), each corner's point."""
    starts: NDArray[np.int64]
    """(f + 1,), each face's first corner, and the count of corners."""
    coarse: NDArray[np.int64]
    """(f,), each face's number before subdivision."""
    slots: NDArray[np.int64]
    """(f,), each face's material slot."""
    materials: list[str] = field(default_factory=list)
    """Full names of the slots' materials, empty for none."""
    managed: NDArray[np.bool_] = field(default_factory=lambda: np.empty(0, bool))
    """(f,), whether a face's material is managed."""
    twin_of: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    """(t,), of which points the last t are twins (see `hidden_corners`)."""

    def with_twins(self, point: NDArray[np.int64], twin_of: NDArray[np.int64]) -> Fine:
        """The same faces with so many points more, their corners brought to ``point`` (c,)."""
        return replace(
            self,
            places=np.concatenate([self.places, self.places[twin_of]]),
            normals=np.concatenate([self.normals, self.normals[twin_of]]),
            point=point,
            twin_of=twin_of,
        )

    @property
    def face(self) -> NDArray[np.int64]:
        """(c,), each corner's face."""
        return np.repeat(np.arange(len(self.coarse)), np.diff(self.starts))

    @property
    def following(self) -> NDArray[np.int64]:
        """(c,), of each corner the next one around its face."""
        after = np.arange(1, len(self.point) + 1)
        after[self.starts[1:] - 1] = self.starts[:-1]
        return after

    def mean(self, of_corners: NDArray) -> NDArray:
        """The mean (f, …) over each face of what its corners (c, …) have."""
        total = np.add.reduceat(of_corners, self.starts[:-1], axis=0)
        return total / np.diff(self.starts).reshape(-1, *[1] * (of_corners.ndim - 1))


@dataclass
class Raw:
    """An evaluated mesh's arrays as Blender has them, and the full names and whether managed of its
    slots' materials; ``faces``: numbers before subdivision."""

    vertex: NDArray[np.int32]
    starts: NDArray[np.int32]
    slots: NDArray[np.int32]
    faces: NDArray[np.int32]
    places: NDArray[np.float32]
    normals: NDArray[np.float32]
    materials: list[str] = field(default_factory=lambda: [""])
    managed: list[bool] = field(default_factory=lambda: [False])


def evaluated(objects: Sequence[bpy.types.Object]) -> list[Raw | None]:
    """The faces of objects after their modifiers, ours the last; None for those without a face."""
    if not objects:
        return []
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    made = {}
    if any(obj.type != "MESH" for obj in objects):
        # A curve or text shows its mesh as an instance of itself.
        for instance in depsgraph.object_instances:
            if instance.object.type == "MESH" and instance.object.original.type != "MESH":
                made.setdefault(instance.object.original.name_full, instance.object.data)
    found: list[Raw | None] = []
    for obj in objects:
        shown = obj.evaluated_get(depsgraph)
        mesh = shown.data if obj.type == "MESH" else made.get(obj.name_full)
        if mesh is None or not mesh.polygons:
            found.append(None)
            continue
        # Of the evaluated mesh, for instances that became real bring their materials along.
        slots = [slot.material for slot in shown.material_slots] if obj.type == "MESH" else []
        materials = slots or list(mesh.materials) or [None]
        raw = _raw(mesh)
        raw.materials = [each.name_full if each else "" for each in materials]
        raw.managed = [each is not None and tags.MATERIAL in each for each in materials]
        found.append(raw)
    return found


def brought(found: Sequence[Raw | None]) -> list[Fine | None]:
    """What `evaluated` meshes are to a bake; linked duplicates share what is found."""
    known: dict[bytes, Fine] = {}
    return [None if raw is None else _fine(raw, known) for raw in found]


def read(mesh: bpy.types.Mesh) -> Fine:
    """The faces of an evaluated mesh that came through the modifier, all of one material."""
    return _fine(_raw(mesh), {})


def _raw(mesh: bpy.types.Mesh) -> Raw:
    corners, faces = len(mesh.loops), len(mesh.polygons)
    vertex, starts = np.empty(corners, np.int32), np.empty(faces, np.int32)
    slots, coarse = np.empty(faces, np.int32), np.arange(faces, dtype=np.int32)
    places = np.empty(3 * len(mesh.vertices), np.float32)
    normals = np.empty(3 * corners, np.float32)
    mesh.loops.foreach_get("vertex_index", vertex)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.polygons.foreach_get("material_index", slots)
    mesh.vertices.foreach_get("co", places)
    mesh.corner_normals.foreach_get("vector", normals)
    if sky_bake.FACE in mesh.attributes:
        mesh.attributes[sky_bake.FACE].data.foreach_get("value", coarse)
    return Raw(vertex, starts, slots, coarse, places, normals)


def _fine(raw: Raw, known: dict[bytes, Fine]) -> Fine:
    """A mesh as a bake sees it; ``known``: others by their content."""
    arrays = raw.vertex, raw.starts, raw.slots, raw.faces, raw.places, raw.normals
    materials = len(raw.materials)
    digest = hashlib.blake2b(str(materials).encode())
    for values in arrays:
        digest.update(values.tobytes())
    if digest.digest() not in known:
        known[digest.digest()] = _brought(*arrays, materials)
    fine = replace(known[digest.digest()], materials=raw.materials)
    fine.managed = np.array(raw.managed)[fine.slots]
    return fine


def _brought(vertex, starts, slots, coarse, places, normals, materials) -> Fine:
    """What a mesh's arrays tell, corners brought to points."""
    corners = len(vertex)
    at, normal = places.reshape(-1, 3)[vertex].astype(float), normals.reshape(-1, 3).astype(float)
    at, normal = np.nan_to_num(at), np.nan_to_num(normal)  # faces without area may have no normal
    step = STEP * (float(np.ptp(at, axis=0).max()) if corners else 0.0) or 1.0
    slots = np.minimum(slots, materials - 1)
    own = np.repeat(slots, np.diff(np.append(starts, corners)))[:, None]
    rounded = np.concatenate([np.round(at / step), np.round(normal * 500.0), own], axis=1)
    _, first, point = np.unique(_keys(rounded), return_index=True, return_inverse=True)
    unit = normal[first]
    length = np.linalg.norm(unit, axis=1, keepdims=True)
    return Fine(
        at[first],
        np.divide(unit, length, out=np.zeros_like(unit), where=length > 0.5),
        point.reshape(-1),
        np.append(starts, corners).astype(np.int64),
        coarse.astype(np.int64),
        slots.astype(np.int64),
    )


def _keys(rounded: NDArray[np.float64]) -> NDArray[np.uint64]:
    """As `row_keys`, folded: in this order files hold the points of bakes."""
    mixed = row_keys(rounded)
    return mixed ^ (mixed >> np.uint64(31))


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
