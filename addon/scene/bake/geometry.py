"""What stands in a scene: its triangles in the world, whose they are, and what they are made of."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, is_between_events
from ...transport import extent
from ...transport.cells import Surfaces
from .shells import Shell, close, closed_parts

READING = 0.15
"""[s] of reading between two events: until then a window waits."""

GATHERING = Progress(0.0, "geometry")


@dataclass
class Geometry:
    """Triangles of a scene, in the world."""

    corners: NDArray[np.float64]
    """(n, 3, 3), relative to `origin`, for float32 is fine near 0 only; counter-clockwise as seen
    from their fronts, also where an object is mirrored."""
    origin: NDArray[np.float64]
    """(3,), about which most of the scene is."""
    owner: NDArray[np.int32]
    """(n,), which of `owners` each belongs to."""
    owners: list[str]
    """Names of objects; for instances, of what instances them."""
    instance: NDArray[np.int32]
    """(n,), a number for each mesh in each place."""
    material: NDArray[np.int32]
    """(n,), which of `materials` each has."""
    materials: list[str]
    """Full names; empty for none."""
    polygon: NDArray[np.int32]
    """(n,), which face of its mesh each is a part of."""
    solid: NDArray[np.bool_]
    """(n,), whether its back is inside something closed."""
    size: float
    """How large what stands in the scene is, see `extent.scale`."""

    @cached_property
    def whole(self) -> float:
        """The longest edge of the box around all of it, 0 without triangles."""
        return extent.box(self.corners)

    @cached_property
    def _by_owner(self) -> dict[str, NDArray[np.int64]]:
        order = np.argsort(self.owner, kind="stable")
        ends = np.cumsum(np.bincount(self.owner, minlength=len(self.owners)))
        parts = np.split(order, ends[:-1]) if len(ends) else []
        return dict(zip(self.owners, parts, strict=True))

    def of(self, owner: str) -> NDArray[np.int64]:
        """The triangles of an owner, none of an unknown one."""
        return self._by_owner.get(owner, np.empty(0, np.int64))

    @property
    def surfaces(self) -> Surfaces:
        """The triangles as light knows them; their kinds are numbers of `materials`."""
        return Surfaces(self.corners, self.material, self.solid, self.instance, self.size)


@dataclass
class _Shape:
    """The triangles of one mesh in its own space."""

    triangles: NDArray[np.float64]
    slots: NDArray
    names: list[str]
    polygons: NDArray


@dataclass
class _Placed:
    """One mesh in one place: its ``shape``, matrix (4, 4), owner, number, and its slots' kinds."""

    shape: _Shape
    to_world: NDArray[np.float64]
    owner: int
    number: int
    kinds: NDArray[np.int32]


def gathering() -> Generator[Progress, None, Geometry]:
    """Gather all that light meets in the evaluated scene, instances and curves included.

    Left out: what is hidden in renders or in the viewport, and what casts no shadow (ray
    visibility). A holdout and a shadow catcher are there as they are in Cycles.
    """
    read = yield from reading()
    return (yield from aside(GATHERING, assembled, read))


@dataclass
class Read:
    """Meshes and places as Blender has them, and names of owners and materials by number."""

    placed: list[_Placed] = field(default_factory=list)
    owners: dict[str, int] = field(default_factory=dict)
    materials: dict[str, int] = field(default_factory=lambda: {"": 0})
    shapes: dict[Any, _Shape] = field(default_factory=dict)


def reading() -> Generator[Progress, None, Read]:
    """Read what `assembled` makes geometry of, yielding where there is much; only as long as
    nothing in the scene changes."""
    read = Read()
    first = _read_some(0, read)
    while first is not None:
        yield GATHERING
        first = _read_some(first, read)
    return read


def _read_some(first: int, read: Read) -> int | None:
    """Read instances from a first one on, between events for a moment; which is the next to read.

    An iterator over instances must not be kept while Blender does anything else.
    """
    until = time.monotonic() + READING if is_between_events() else np.inf
    owners, materials, cache = read.owners, read.materials, read.shapes
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for number, instance in islice(enumerate(depsgraph.object_instances), first, None):
        if number > first and time.monotonic() > until:
            return number
        shown = instance.object
        by = instance.parent if instance.is_instance else shown
        # Curves, texts and metaballs show their meshes as instances of themselves.
        if not instance.show_self or shown.type != "MESH":
            continue
        if shown.hide_render or by.hide_render:
            continue
        if not shown.visible_shadow:  # it hides nothing, but it is lit
            for slot in shown.material_slots:
                name = slot.material.name_full if slot.material else ""
                materials.setdefault(name, len(materials))
            continue
        key = shown.original.name_full, shown.data.as_pointer() if shown.data else 0
        if key not in cache:
            cache[key] = _Shape(*_read(shown))
        shape = cache[key]
        if not len(shape.triangles):
            continue
        owner = owners.setdefault(by.original.name_full, len(owners))
        kinds = np.array([materials.setdefault(name, len(materials)) for name in shape.names])
        to_world = np.array(instance.matrix_world)
        read.placed.append(_Placed(shape, to_world, owner, number, kinds.astype(np.int32)))
    return None


def assembled(read: Read) -> Geometry:
    """All that was read, in the world."""
    placed, owners, materials = _in_order(read)
    empty = np.empty(0, np.int32)
    if not placed:
        none, no = np.empty((0, 3, 3)), np.empty(0, bool)
        return Geometry(none, np.zeros(3), empty, [], empty, empty, materials, empty, no, 0.0)
    solids: dict[bytes, tuple[NDArray[np.bool_], list[Shell]]] = {}
    known: dict[int, tuple[NDArray[np.bool_], list[Shell]]] = {}
    columns: list[list[NDArray]] = [[] for _ in range(6)]
    shells: list[tuple[NDArray, Shell, NDArray]] = []
    total = 0
    for one in placed:
        shape, to_world = one.shape, one.to_world
        if id(shape) not in known:
            # Linked duplicates, and what stands in for instances, have the same triangles.
            content = shape.triangles.tobytes()
            if content not in solids:
                solids[content] = closed_parts(shape.triangles)
            known[id(shape)] = solids[content]
        inside, open_parts = known[id(shape)]
        corners = shape.triangles @ to_world[:3, :3].T + to_world[:3, 3]
        mirrored = np.linalg.det(to_world[:3, :3]) < 0.0
        count = len(corners)
        for shell in open_parts if not mirrored else ():
            shells.append((total + np.flatnonzero(shell.triangles), shell, to_world))
        total += count
        for column, values in zip(
            columns,
            (
                corners[:, ::-1] if mirrored else corners,
                np.full(count, one.owner, np.int32),
                np.full(count, one.number, np.int32),
                one.kinds[shape.slots],
                shape.polygons,
                inside,
            ),
            strict=True,
        ):
            column.append(values)
    for k, column in enumerate(columns):
        columns[k] = [np.concatenate(column)]  # one by one, for a town's are large
    places, owner, instances, material, polygon, solid = (column[0] for column in columns)
    origin = extent.middle(places)
    places -= origin
    close(solid, shells, places, origin)
    size = extent.scale(places)
    places, part = extent.graded(places, size)
    if len(part) > len(owner):
        others = (owner, instances, material, polygon, solid)
        owner, instances, material, polygon, solid = (column[part] for column in others)
    return Geometry(
        places, origin, owner, owners, instances, material, materials, polygon, solid, size
    )


def _in_order(read: Read) -> tuple[list[_Placed], list[str], list[str]]:
    """What was read, and names of owners and materials, in one order for one scene.

    Blender's own goes by addresses in memory: each time it starts, rays would be others.
    """
    owners, materials = sorted(read.owners), sorted(read.materials)  # no material, "", is first
    kinds = np.array([materials.index(name) for name in read.materials], np.int32)
    ranks = {read.owners[name]: rank for rank, name in enumerate(owners)}
    placed = [replace(one, owner=ranks[one.owner], kinds=kinds[one.kinds]) for one in read.placed]
    placed.sort(key=lambda one: one.owner)  # an owner's instances stay as they follow each other
    return [replace(one, number=k) for k, one in enumerate(placed)], owners, materials


def triangles_of(shown: bpy.types.Object) -> tuple[NDArray[np.float64], NDArray, list[str]]:
    """Triangles (n, 3, 3) of an evaluated mesh, the slot of each (n,), and the slots' materials.

    In its own space; none of a mesh without faces. A slot's material is named in full, an empty one
    is ""; without slots there is one such.
    """
    return _read(shown)[:3]


def _read(shown: bpy.types.Object) -> tuple[NDArray[np.float64], NDArray, list[str], NDArray]:
    # A last Subdivision modifier may be left to the GPU, and `data` then is what went into it.
    smooth = any(modifier.type == "SUBSURF" for modifier in shown.modifiers)
    mesh = shown.to_mesh() if smooth else shown.data
    names = [slot.material.name_full if slot.material else "" for slot in shown.material_slots]
    names = names or [""]
    if mesh is None or not mesh.polygons:
        return np.empty((0, 3, 3)), np.empty(0, int), names, np.empty(0, np.int32)
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners, slots, polygons = (np.empty(size, np.int32) for size in (3 * count, count, count))
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    mesh.loop_triangles.foreach_get("material_index", slots)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    mesh.vertices.foreach_get("co", places)
    triangles = places.reshape(-1, 3)[corners.reshape(-1, 3)].astype(float)
    if smooth:
        shown.to_mesh_clear()
    there = np.isfinite(triangles).all(axis=(1, 2))  # broken modifiers and imports leave NaN
    slots = np.minimum(slots, len(names) - 1)
    return triangles[there], slots[there], names, polygons[there]
