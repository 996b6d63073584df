"""What stands in the light's way: the scene's triangles, and which of them a ray meets first."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import glazing
from ....node_groups import tree as groups
from ..blend_data import nodes

CLEAR = {"BSDF_GLASS", "BSDF_REFRACTION", "BSDF_TRANSPARENT"}


def fast() -> bool:
    """Whether `embreex` is installed, which casts rays several times as fast as Blender."""
    return importlib.util.find_spec("embreex") is not None


@dataclass
class Occluders:
    """Triangles of a scene, in the world."""

    corners: NDArray[np.float32]
    """(n, 3, 3), relative to `origin`, for float32 is fine near 0 only; counter-clockwise as seen
    from their fronts, also where an object is mirrored."""
    origin: NDArray[np.float64]
    """(3,), the middle of the scene."""
    owner: NDArray[np.int32]
    """(n,), which of `owners` each belongs to."""
    owners: list[str]
    """Names of objects; for instances, of what instances them."""
    material: NDArray[np.int32]
    """(n,), which of `materials` each has."""
    materials: list[str]
    """Full names; empty for none."""
    _caster: Any = field(default=None, repr=False)

    @property
    def size(self) -> float:
        """The longest edge of the box around all of it, 0 without triangles."""
        return float(np.ptp(self.corners.reshape(-1, 3), axis=0).max()) if len(self.corners) else 0

    @cached_property
    def normals(self) -> NDArray[np.float32]:
        """(n, 3), of the fronts; their length is twice the area."""
        first, second, third = self.corners.swapaxes(0, 1)
        return np.cross(second - first, third - first)

    def first_hits(
        self, origins: NDArray[np.float32], directions: NDArray[np.float32], slow: bool = False
    ) -> NDArray[np.int32]:
        """Return the triangle that each ray (n, 3), (n, 3) meets first, -1 for the sky.

        Origins are relative to `origin`; both faces of a triangle count. With `embreex` several
        threads may call at once. `slow`: Blender's own caster also where `embreex` is installed.
        """
        if not len(self.corners):
            return np.full(len(origins), -1, np.int32)
        if fast() and not slow:
            return self._embree().run(origins, directions, query="INTERSECT")
        from mathutils.bvhtree import BVHTree

        if not isinstance(self._caster, BVHTree):
            vertices = self.corners.reshape(-1, 3).tolist()
            triangles = np.arange(len(vertices)).reshape(-1, 3).tolist()
            self._caster = BVHTree.FromPolygons(vertices, triangles, all_triangles=True)
        cast = self._caster.ray_cast
        found = [cast(o, d)[2] for o, d in zip(origins.tolist(), directions.tolist(), strict=True)]
        return np.array([-1 if index is None else index for index in found], np.int32)

    def _embree(self):
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        if not isinstance(self._caster, EmbreeScene):
            scene = EmbreeScene(robust=True)  # no ray slips through between two triangles
            TriangleMesh(scene, np.ascontiguousarray(self.corners))
            self._caster = scene
            ray = np.array([[0.0, 0.0, 1.0]], np.float32)
            scene.run(ray, ray)  # the first call builds, which threads must not do twice
        return self._caster


def occluders(depsgraph: bpy.types.Depsgraph) -> Occluders:
    """Gather all that hides the sky in the evaluated scene, instances and curves included.

    Left out: what is hidden in renders or in the viewport, what casts no shadow (ray visibility),
    and triangles whose material lets most light through (see `is_clear`). A holdout hides the sky
    as it does in Cycles; a shadow catcher too. Opacity that a texture tells is not read: leaves
    cut out of a plane hide the sky as the whole plane does.
    """
    corners, owner, material = [], [], []
    owners: dict[str, int] = {}
    materials: dict[str, int] = {"": 0}
    clear: dict[str, bool] = {}
    cache: dict[Any, tuple] = {}
    for instance in depsgraph.object_instances:
        shown = instance.object
        by = instance.parent if instance.is_instance else shown
        # Curves, texts and metaballs show their meshes as instances of themselves.
        if not instance.show_self or shown.type != "MESH" or not shown.visible_shadow:
            continue
        if shown.hide_render or by.hide_render:
            continue
        key = shown.original.name_full, shown.data.as_pointer() if shown.data else 0
        if key not in cache:
            cache[key] = triangles_of(shown)
        triangles, slots, names = cache[key]
        for name in names:
            if name not in clear:
                clear[name] = bool(name) and is_clear(_material(shown, name))
        kept = ~np.array([clear[name] for name in names])[slots]
        if not kept.any():
            continue
        to_world = np.array(instance.matrix_world)
        placed = triangles[kept] @ to_world[:3, :3].T + to_world[:3, 3]
        mirrored = np.linalg.det(to_world[:3, :3]) < 0.0
        corners.append(placed[:, ::-1] if mirrored else placed)
        number = owners.setdefault(by.original.name_full, len(owners))
        owner.append(np.full(kept.sum(), number, np.int32))
        place = np.array([materials.setdefault(name, len(materials)) for name in names], np.int32)
        material.append(place[slots[kept]])
    if not corners:
        empty = np.empty(0, np.int32)
        return Occluders(np.empty((0, 3, 3), np.float32), np.zeros(3), empty, [], empty, [""])
    places = np.concatenate(corners)
    flat = places.reshape(-1, 3)
    origin = (flat.min(axis=0) + flat.max(axis=0)) / 2
    return Occluders(
        (places - origin).astype(np.float32),
        origin,
        np.concatenate(owner),
        list(owners),
        np.concatenate(material),
        list(materials),
    )


def triangles_of(shown: bpy.types.Object) -> tuple[NDArray[np.float64], NDArray, list[str]]:
    """Triangles (n, 3, 3) of an evaluated mesh, the slot of each (n,), and the slots' materials.

    In its own space; none of a mesh without faces. A slot's material is named in full, an empty one
    is ""; without slots there is one such.
    """
    # A last Subdivision modifier may be left to the GPU, and `data` then is what went into it.
    smooth = any(modifier.type == "SUBSURF" for modifier in shown.modifiers)
    mesh = shown.to_mesh() if smooth else shown.data
    names = [slot.material.name_full if slot.material else "" for slot in shown.material_slots]
    names = names or [""]
    if mesh is None or not mesh.polygons:
        return np.empty((0, 3, 3)), np.empty(0, int), names
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    slots = np.empty(len(mesh.loop_triangles), np.int32)
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    mesh.loop_triangles.foreach_get("material_index", slots)
    mesh.vertices.foreach_get("co", places)
    triangles = places.reshape(-1, 3)[corners.reshape(-1, 3)].astype(float)
    if smooth:
        shown.to_mesh_clear()
    return triangles, np.minimum(slots, len(names) - 1), names


def _material(shown: bpy.types.Object, name: str) -> bpy.types.Material:
    slots: Iterable[bpy.types.MaterialSlot] = shown.material_slots
    return next(s.material for s in slots if s.material and s.material.name_full == name)


def is_clear(material: bpy.types.Material) -> bool:
    """Whether a material lets most of the light through: glass, transparent, or a volume alone.

    An opacity or transmission that is linked counts as opaque; in a mix the larger part counts.
    """
    without = bpy.app.version < (5, 0, 0) and not material.use_nodes
    if without or material.node_tree is None:
        return False
    output = material.node_tree.get_output_node("EEVEE")
    if output is None or output.type == "GROUP_OUTPUT":
        return False
    surface = nodes.source(output.inputs["Surface"])
    if surface is None:
        return output.inputs["Volume"].is_linked
    return _is_clear(surface.node)


def _is_clear(node: bpy.types.Node) -> bool:
    if node.type == "MIX_SHADER":
        parts = [(s := nodes.source(i)) is not None and _is_clear(s.node) for i in node.inputs[1:3]]
        factor = node.inputs[0]
        return all(parts) if factor.is_linked else parts[factor.default_value > 0.5]
    if node.type in CLEAR or groups.kind_of(node) == glazing.KIND:
        return True  # its tint is in the numbers of what lies behind
    alpha, transmission = node.inputs.get("Alpha"), node.inputs.get("Transmission Weight")
    faint = alpha is not None and not alpha.is_linked and alpha.default_value < 0.5
    glassy = transmission is not None and not transmission.is_linked
    return faint or (glassy and transmission.default_value > 0.5)
