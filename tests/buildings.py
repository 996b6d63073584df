"""Buildings to bake, and what a bake has left on them."""

import bpy
import numpy as np

from spectral_skylight.addon import tags
from spectral_skylight.node_groups import baked_light

DATA = (
    "materials",
    "worlds",
    "node_groups",
    "objects",
    "meshes",
    "lights",
    "collections",
    "images",
)
"""What of a file has names and may be ours."""


def material():
    """A material that counts as managed."""
    found = bpy.data.materials.new("Matt")
    found[tags.MATERIAL] = {"id": "test"}
    return found


def box(name, middle, size, made_of):
    """A box with its faces outwards."""
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    places = np.array(signs) * np.array(size) / 2 + middle
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return shown(name, places.tolist(), sides, made_of)


def shown(name, places, polygons, made_of):
    """An object of these polygons in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(places, [], polygons)
    mesh.materials.append(made_of)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def ground(size, made_of):
    """A square in the plane z = 0."""
    around = [(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)]
    return shown("Ground", around, [(0, 1, 2, 3)], made_of)


def colours(mesh, name):
    """The RGBA (c, 4) of an attribute."""
    values = np.empty(4 * len(mesh.loops), np.float32)
    attribute = mesh.attributes[name]
    if attribute.data_type != "FLOAT_COLOR":
        return None
    attribute.data.foreach_get("color", values)
    return values.reshape(-1, 4)


def as_bytes(mesh):
    places, corners = np.empty(3 * len(mesh.vertices), "f"), np.empty(len(mesh.loops), "i")
    mesh.vertices.foreach_get("co", places)
    mesh.loops.foreach_get("vertex_index", corners)
    return places.tobytes(), corners.tobytes(), sorted(mesh.attributes.keys())


def flags(obj):
    """Whether the corners (c,) of an object as shown have values of its bake."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return colours(mesh, baked_light.LIGHT)[:, 3] == baked_light.FLAG


def sky_share(obj):
    """What an object's corners receive of an even sky of 1, and their normals in the world."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    normals = np.empty(3 * len(mesh.loops), np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    to_world = np.linalg.inv(np.array(obj.matrix_world)[:3, :3])
    normals = normals.reshape(-1, 3) @ to_world
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return colours(mesh, baked_light.LIGHT)[:, 0], normals
