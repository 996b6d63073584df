"""What stands in the scene, in one number: what is known of it holds as long as that."""

from __future__ import annotations

import bpy
import numpy as np


def scene_key() -> int:
    """What stands in the scene, in one number: another place or mesh is another."""
    parts = []
    bpy.context.view_layer.update()
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        mesh = instance.object.data
        if instance.object.type == "MESH" and mesh is not None:
            place = tuple(round(value, 6) for row in instance.matrix_world for value in row)
            slots = [s.material.name_full for s in instance.object.material_slots if s.material]
            parts.append((instance.object.name, place, _shape(mesh), *slots))
    return hash(tuple(sorted(parts)))


def _shape(mesh: bpy.types.Mesh) -> int:
    """What a mesh's vertices are, in one number."""
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    return hash(places.tobytes())
