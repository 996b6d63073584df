"""What geometry is around materials: how much of the sky it hides, and what lies under them."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

from .geometry import triangles_of

_POINTS, _RAYS = 64, 64
"""Places that are looked from, and rays from each: a hundredth of the sky, in some tenths of a
second."""

_LIFT = 1e-4
"""How far over its face a place lies, of the scene's size: rays must not meet their own face."""


def hidden_share(scene: bpy.types.Scene, chosen: Collection[bpy.types.Material]) -> float | None:
    """Return the part, 0 to 1, of an even sky's light that is kept from faces of some materials.

    What another object, or the face's own, stands in front of; faces that look down count by the
    sky that they could see. From a few places in proportion to their area, always the same ones.
    None where no visible face has one of the materials.
    """
    depsgraph = bpy.context.evaluated_depsgraph_get()
    rng = np.random.default_rng(0)
    open_sky = seen = 0
    for start, normal in _places(depsgraph, chosen, rng):
        # Cosine-weighted about the normal (N. Malley): the normal plus an even direction.
        even = rng.standard_normal((_RAYS, 3))
        ways = normal + even / np.linalg.norm(even, axis=1, keepdims=True)
        ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9)
        for way in ways[ways[:, 2] > 0.0].tolist():
            open_sky += 1
            seen += not scene.ray_cast(depsgraph, start, way)[0]
    return None if open_sky == 0 else 1.0 - seen / open_sky


def ground_below(
    scene: bpy.types.Scene, chosen: Collection[bpy.types.Material]
) -> tuple[bool, bpy.types.Material | None]:
    """Return whether geometry lies under the faces of some materials, and its usual material.

    Of faces that see what is below them nine in ten have to have something straight under them.
    """
    depsgraph = bpy.context.evaluated_depsgraph_get()
    below: list[bpy.types.Material | None] = []
    looked = 0
    for start, normal in _places(depsgraph, chosen, np.random.default_rng(0)):
        if normal[2] > 0.7:
            continue
        looked += 1
        hit, _, _, face, obj, _ = scene.ray_cast(depsgraph, start, (0.0, 0.0, -1.0))
        if hit:
            below.append(_material_at(obj, face))
    if not looked or len(below) < 0.9 * looked:
        return False, None
    return True, max(set(below), key=below.count)


def _material_at(obj: bpy.types.Object, face: int) -> bpy.types.Material | None:
    if not obj.material_slots:
        return None
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    polygons = shown.data.polygons if shown.type == "MESH" else ()
    index = polygons[face].material_index if face < len(polygons) else 0
    return obj.material_slots[min(index, len(obj.material_slots) - 1)].material


def _places(
    depsgraph: bpy.types.Depsgraph,
    chosen: Collection[bpy.types.Material],
    rng: np.random.Generator,
) -> Iterator[tuple[list[float], NDArray[np.float64]]]:
    """Yield a point just over a face and its normal (3,), for some places evenly over all."""
    triangles = _triangles(depsgraph, {material.name_full for material in chosen})
    vectors = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(vectors, axis=1)
    if not areas.sum() > 0.0:
        return
    places = np.searchsorted(np.cumsum(areas) / areas.sum(), (np.arange(_POINTS) + 0.5) / _POINTS)
    lift = _LIFT * np.ptp(triangles.reshape(-1, 3), axis=0).max()
    for place in np.minimum(places, len(areas) - 1):
        # Evenly over the triangle (R. Osada et al. 2002, DOI 10.1145/571647.571648).
        root, along = np.sqrt(rng.random()), rng.random()
        origin = np.array([1.0 - root, root * (1.0 - along), root * along]) @ triangles[place]
        normal = vectors[place] / areas[place]
        yield (origin + lift * normal).tolist(), normal


def _triangles(depsgraph: bpy.types.Depsgraph, names: set[str]) -> NDArray[np.float64]:
    """Return the triangles (n, 3, 3) with materials so named, in the world, fronts out.

    Of evaluated meshes and their instances.
    """
    found = [np.empty((0, 3, 3))]
    for instance in depsgraph.object_instances:
        shown = instance.object
        if shown.type != "MESH" or not any(
            slot.material is not None and slot.material.name_full in names
            for slot in shown.material_slots
        ):
            continue
        triangles, slots, materials = triangles_of(shown)
        kept = triangles[np.isin(materials, list(names))[slots]]
        to_world = np.array(instance.matrix_world)
        placed = kept @ to_world[:3, :3].T + to_world[:3, 3]
        mirrored = np.linalg.det(to_world[:3, :3]) < 0.0
        found.append(placed[:, ::-1] if mirrored else placed)
    return np.concatenate(found)
