"""An object's evaluated, subdivided mesh as a bake sees it: its corners brought to points."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import sky_bake
from ... import tags
from ...transport.row_keys import row_keys
from .shells import STEP


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
