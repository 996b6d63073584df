"""What tests of lamps build: collections, lamps, instances, shaders and a house of three faces."""

import bpy

from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.node_groups import tree as groups


def collection(name, within=None):
    made = bpy.data.collections.new(name)
    if within is not None:
        within.children.link(made)
    return made


def lamp(name, within, **settings):
    light = bpy.data.lights.new(name, "POINT")
    light.energy = 100.0
    for key, value in settings.items():
        setattr(light, key, value)
    obj = bpy.data.objects.new(name, light)
    within.objects.link(obj)
    return obj


def instance(of, within, **settings):
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", of
    for key, value in settings.items():
        setattr(empty, key, value)
    within.objects.link(empty)
    return empty


def principled(name, **values):
    material = bpy.data.materials.new(name)
    nodes.use(material)
    tree = material.node_tree
    tree.nodes.clear()
    shader = groups.add(tree, "ShaderNodeBsdfPrincipled")
    for key, value in values.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    groups.add(tree, "ShaderNodeOutputMaterial", shader.outputs[0])
    return material


def house(scene, *materials):
    """One mesh of three level faces from x = -4 to 4, a material each."""
    mesh = bpy.data.meshes.new("House")
    corners = [(x, y, 0) for x in (-4, 0, 2, 4) for y in (-1, 1)]
    mesh.from_pydata(corners, [], [(0, 2, 3, 1), (2, 4, 5, 3), (4, 6, 7, 5)])
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", [0, 1, 2])
    scene.collection.objects.link(bpy.data.objects.new("House", mesh))
    return mesh
