"""What one click leaves alone, and why: every kind of shader that has no diffuse reflectance."""

import bpy
import pytest

from spectral_skylight.addon.scene.materials import eligibility

pytestmark = pytest.mark.blender


def material(kind, mixed=None, volume=None, **values):
    """A material of one shader, mixed with another, by their kinds."""
    made = bpy.data.materials.new(kind)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    if kind != "none":
        shader = tree.nodes.new(f"ShaderNode{kind}")
        for name, value in values.items():
            shader.inputs[name.replace("_", " ")].default_value = value
        if mixed is not None:
            mix = tree.nodes.new("ShaderNodeMixShader")
            tree.links.new(shader.outputs[0], mix.inputs[1])
            tree.links.new(tree.nodes.new(f"ShaderNode{mixed}").outputs[0], mix.inputs[2])
            shader = mix
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    if volume is not None:
        fog = tree.nodes.new(f"ShaderNode{volume}")
        tree.links.new(fog.outputs[0], output.inputs["Volume"])
    return made


def grouped(inside):
    """A material whose shader stands inside a group with a Color input."""
    tree = bpy.data.node_groups.new("House paint", "ShaderNodeTree")
    tree.interface.new_socket("Color", in_out="INPUT", socket_type="NodeSocketColor")
    tree.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    end = tree.nodes.new("NodeGroupOutput")
    tree.links.new(tree.nodes.new(f"ShaderNode{inside}").outputs[0], end.inputs[0])
    made = material("none")
    node = made.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = tree
    output = next(n for n in made.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    made.node_tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


RED = (1.0, 0.1, 0.1, 1.0)
CASES = [
    (lambda: material("BsdfPrincipled"), ""),
    (lambda: material("BsdfDiffuse"), ""),
    (lambda: material("BsdfPrincipled", mixed="BsdfTransparent"), ""),
    (lambda: material("BsdfDiffuse", mixed="BsdfGlossy"), ""),
    (lambda: material("BsdfPrincipled", Emission_Color=RED, Emission_Strength=0.0), ""),
    (lambda: material("BsdfPrincipled", Emission_Color=(0, 0, 0, 1), Emission_Strength=1.0), ""),
    (lambda: material("Emission", Strength=0.0, mixed="BsdfDiffuse"), ""),
    (lambda: grouped("BsdfDiffuse"), ""),
    (lambda: material("BsdfPrincipled", Emission_Color=RED, Emission_Strength=2.0), "emits light"),
    (lambda: material("Emission"), "emits light"),
    (lambda: material("BsdfDiffuse", mixed="Emission"), "emits light"),
    (lambda: grouped("Emission"), "emits light"),
    (lambda: material("BsdfGlass"), "is glass"),
    (lambda: material("BsdfRefraction"), "is glass"),
    (lambda: material("BsdfPrincipled", Transmission_Weight=0.5), "is glass"),
    (lambda: grouped("BsdfGlass"), "is glass"),
    (lambda: material("Holdout"), "is a holdout"),
    (lambda: material("BsdfDiffuse", mixed="Holdout"), "is a holdout"),
    (lambda: material("none", volume="VolumePrincipled"), "is a volume"),
    (lambda: material("BsdfDiffuse", volume="VolumeScatter"), "is a volume"),
    (lambda: material("BsdfPrincipled", Metallic=1.0), "is a metal"),
    (lambda: material("BsdfGlossy"), "is a metal"),
    (lambda: material("BsdfHairPrincipled"), "is hair"),
    (lambda: material("BsdfTransparent"), "is clear"),
    (lambda: material("BsdfTranslucent"), "no base color to estimate"),
    (lambda: material("none"), "no surface shader"),
]


@pytest.fixture(autouse=True)
def empty():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def test_each_kind_of_shader():
    for k, (make, why) in enumerate(CASES):
        found = eligibility.reason(make())
        assert bool(found) == bool(why) and why in found, (k, found)


def test_a_group_without_a_colour_tells_none():
    made = grouped("BsdfDiffuse")
    tree = made.node_tree.nodes["Group"].node_tree
    tree.interface.remove(tree.interface.items_tree["Color"])
    assert "has no base color to estimate a reflectance from" in eligibility.reason(made)


def test_a_muted_emission_shines_not():
    made = material("BsdfDiffuse", mixed="Emission")
    made.node_tree.nodes["Emission"].mute = True
    assert eligibility.reason(made) == ""


def test_a_material_without_nodes_has_its_viewport_colour():
    made = bpy.data.materials.new("Plain")
    if bpy.app.version < (5, 0, 0):
        assert not made.use_nodes
    assert eligibility.reason(made) == ""


def test_grease_pencil_is_none():
    made = bpy.data.materials.new("Ink")
    bpy.data.materials.create_gpencil_data(made)
    assert "Grease Pencil" in eligibility.reason(made)


def test_materials_inside_instanced_collections_are_the_scenes():
    scene = bpy.context.scene
    mesh = bpy.data.meshes.new("Tree")
    mesh.materials.append(material("BsdfDiffuse"))
    forest = bpy.data.collections.new("Forest")
    forest.objects.link(bpy.data.objects.new("Tree", mesh))
    instance = bpy.data.objects.new("Wood", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", forest
    scene.collection.objects.link(instance)
    assert eligibility.materials_of(scene) == [mesh.materials[0]]


def test_materials_that_geometry_nodes_set_are_the_scenes():
    scene = bpy.context.scene
    tree = bpy.data.node_groups.new("Paint", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    start, paint, end = (
        tree.nodes.new(kind)
        for kind in ("NodeGroupInput", "GeometryNodeSetMaterial", "NodeGroupOutput")
    )
    paint.inputs["Material"].default_value = material("BsdfDiffuse")
    tree.links.new(start.outputs[0], paint.inputs["Geometry"])
    tree.links.new(paint.outputs[0], end.inputs[0])
    mesh = bpy.data.meshes.new("Wall")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    wall = bpy.data.objects.new("Wall", mesh)
    wall.modifiers.new("Paint", "NODES").node_group = tree
    scene.collection.objects.link(wall)
    assert eligibility.materials_of(scene) == [paint.inputs["Material"].default_value]
