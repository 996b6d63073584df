"""A dozen awkward scenes.

Each builder makes one and returns the materials that become spectral and those left alone.
"""

import math

import bpy

from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import buildings


def paint(name, **values):
    material = bpy.data.materials.new(name)
    nodes.use(material)
    shader = material.node_tree.nodes["Principled BSDF"]
    for key, value in values.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    return material


def collection(name, linked=True):
    made = bpy.data.collections.new(name)
    if linked:
        bpy.context.scene.collection.children.link(made)
    return made


def into(obj, where):
    """Move an object from the scene's own collection into another."""
    bpy.context.scene.collection.objects.unlink(obj)
    where.objects.link(obj)
    return obj


def empty_of(of, where=(0, 0, 0), within=None):
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", of, where
    (within or bpy.context.scene.collection).objects.link(empty)
    return empty


def set_material_group(material):
    """A Geometry Nodes group that gives what comes in a material."""
    tree = bpy.data.node_groups.new("Set", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    node = tree.nodes.new("GeometryNodeSetMaterial")
    node.inputs["Material"].default_value = material
    tree.links.new(start.outputs[0], node.inputs["Geometry"])
    tree.links.new(node.outputs[0], end.inputs[0])
    return tree


def glass_house(folder):
    """One mesh of walls, a pane and a metal."""
    house = buildings.box("House", (0, 0, 1), (2, 2, 2), paint("Wall"))
    for extra in (paint("Pane", Transmission_Weight=1.0), paint("Steel", Metallic=1.0)):
        house.data.materials.append(extra)
    house.data.polygons.foreach_set("material_index", [0, 0, 0, 0, 1, 2])
    return {"Wall"}, {"Pane", "Steel"}


def village(folder, rows=20):
    """Houses in rows of instances of instances; the collections are in no view layer."""
    house, row = collection("House", False), collection("Row", False)
    into(buildings.box("Walls", (0, 0, 1), (2, 2, 2), paint("Wall")), house)
    into(buildings.box("Roof", (0, 0, 2.2), (2.4, 2.4, 0.4), paint("Roof")), house)
    for k in range(5):
        empty_of(house, (4 * k, 0, 0), row)
    for k in range(rows):
        empty_of(row, (0, 4 * k, 0)).rotation_euler.z = 0.1 * k
    return {"Wall", "Roof"}, set()


def hamlet(folder):
    """As the village, of ten houses."""
    return village(folder, 2)


def set_by_nodes(folder):
    """Geometry Nodes set the material; the object has no slot."""
    box = buildings.box("Box", (0, 0, 1), (2, 2, 2), None)
    box.data.materials.clear()
    box.modifiers.new("Set", "NODES").node_group = set_material_group(paint("Set by nodes"))
    return {"Set by nodes"}, set()


def scattered(folder):
    """Geometry Nodes instance a collection on points."""
    trees = collection("Trees", False)
    into(buildings.box("Trunk", (0, 0, 1), (0.2, 0.2, 2), paint("Bark")), trees)
    lawn = buildings.ground(4, paint("Lawn"))
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    info, points = (
        tree.nodes.new(f"GeometryNode{kind}") for kind in ("CollectionInfo", "InstanceOnPoints")
    )
    join = tree.nodes.new("GeometryNodeJoinGeometry")
    info.inputs["Collection"].default_value = trees
    tree.links.new(start.outputs[0], points.inputs["Points"])
    tree.links.new(info.outputs[0], points.inputs["Instance"])
    tree.links.new(points.outputs[0], join.inputs[0])
    tree.links.new(start.outputs[0], join.inputs[0])
    tree.links.new(join.outputs[0], end.inputs[0])
    lawn.modifiers.new("Scatter", "NODES").node_group = tree
    return {"Bark", "Lawn"}, set()


def foreign_shaders(folder):
    """Nodes of a renderer that is not there, a script, an empty output, and none at all."""

    class ForeignShader(bpy.types.ShaderNode):
        """A shader of another renderer, known as long as its add-on is there."""

        bl_idname, bl_label = "ForeignShaderTestNode", "Foreign"

        def init(self, context):
            self.outputs.new("NodeSocketShader", "Shader")

    bpy.utils.register_class(ForeignShader)
    try:
        foreign, script, empty = paint("Foreign"), paint("Script"), paint("Empty")
        tree = foreign.node_tree
        node = tree.nodes.new("ForeignShaderTestNode")
        tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    finally:
        bpy.utils.unregister_class(ForeignShader)
    tree = script.node_tree
    tree.nodes.clear()
    groups.add(tree, "ShaderNodeScript")
    empty.node_tree.nodes.clear()
    bare = bpy.data.materials.new("Bare")
    for k, material in enumerate((foreign, script, empty, bare, paint("Plain"))):
        buildings.box("Box", (3 * k, 0, 1), (2, 2, 2), material)
    return {"Plain", "Bare"}, {"Foreign", "Script", "Empty"}


def missing_images(folder):
    """A base color whose picture is gone, one without a picture, one that is all black."""
    for k, name in enumerate(("Gone", "None", "Black")):
        material = paint(name)
        tree = material.node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        if name == "Gone":
            node.image = bpy.data.images.new("gone.png", 4, 4)
            node.image.source, node.image.filepath = "FILE", str(folder / "gone.png")
        elif name == "Black":
            node.image = bpy.data.images.new("Black", 4, 4)
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
        buildings.box("Box", (3 * k, 0, 1), (2, 2, 2), material)
    return {"Gone", "None", "Black"}, set()


def linked_collection(folder):
    """An instance of a collection of another file, and a house of this one."""
    library = folder / "library.blend"
    shared = collection("Shared")
    into(buildings.box("Theirs", (0, 0, 1), (2, 2, 2), paint("Theirs")), shared)
    bpy.data.libraries.write(str(library), {shared}, fake_user=True)
    bpy.data.batch_remove([shared, *shared.objects, bpy.data.materials["Theirs"]])
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.collections = ["Shared"]
    empty_of(wanted.collections[0])
    buildings.box("Ours", (4, 0, 1), (2, 2, 2), paint("Ours"))
    return {"Ours"}, {"Theirs"}


def excluded(folder):
    """A roof over all in a collection that the view layer excludes hides no sky."""
    buildings.ground(4, paint("Floor"))
    roof = collection("Roof")
    into(buildings.box("Roof", (0, 0, 3), (40, 40, 0.2), paint("Roof")), roof)
    bpy.context.view_layer.layer_collection.children["Roof"].exclude = True
    return {"Floor", "Roof"}, set()


def many(folder):
    """300 materials on 300 objects, a quarter of them glass."""
    for k in range(300):
        material = paint(f"M{k:03}", Transmission_Weight=float(k % 4 == 0))
        material.node_tree.nodes["Principled BSDF"].inputs[0].default_value = (k / 300, 0.5, 0.3, 1)
        buildings.box("Box", (3 * (k % 20), 3 * (k // 20), 1), (2, 2, 2), material)
    glass = {f"M{k:03}" for k in range(0, 300, 4)}
    return {f"M{k:03}" for k in range(300)} - glass, glass


def odd_geometry(folder):
    """No faces, no size, no numbers, far away; curves, texts and metaballs."""
    material = paint("Odd")
    flat = buildings.box("Flat", (0, 0, 1), (2, 2, 2), material)
    flat.scale.z = 0.0
    buildings.box("Far", (1e7, 0, 1), (2, 2, 2), material)
    lost = buildings.box("Lost", (0, 0, 1), (2, 2, 2), material)
    lost.data.vertices[0].co.x = math.nan
    empty = bpy.data.meshes.new("Empty")
    empty.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Empty", empty))
    for add in (
        bpy.ops.curve.primitive_bezier_circle_add,
        bpy.ops.object.text_add,
        bpy.ops.object.metaball_add,
    ):
        add()
        bpy.context.object.data.materials.append(material)
    return {"Odd"}, set()


def shared_slots(folder):
    """One mesh on two objects with materials of their own, one of another scene, an empty slot."""
    one = buildings.box("One", (0, 0, 1), (2, 2, 2), paint("Of the mesh"))
    two = one.copy()
    two.location.x = 4
    bpy.context.scene.collection.objects.link(two)
    two.material_slots[0].link = "OBJECT"
    two.material_slots[0].material = paint("Of the object")
    one.data.materials.append(None)
    other = bpy.data.scenes.new("Other")
    elsewhere = buildings.box("Elsewhere", (0, 9, 1), (2, 2, 2), paint("Elsewhere"))
    into(elsewhere, other.collection)
    return {"Of the mesh", "Of the object"}, set()


def emitters_and_hair(folder):
    """A sign, a holdout, a volume and smoke in an open box: none has a reflectance."""
    sign = paint("Sign", Emission_Strength=3.0)
    made = {"Sign": sign}
    for name, kind, output in (
        ("Hole", "ShaderNodeHoldout", "Surface"),
        ("Fog", "ShaderNodeVolumePrincipled", "Volume"),
        ("Hair", "ShaderNodeBsdfHair", "Surface"),
    ):
        made[name] = paint(name)
        tree = made[name].node_tree
        tree.nodes.clear()
        node = tree.nodes.new(kind)
        end = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(node.outputs[0], end.inputs[output])
    for k, material in enumerate(made.values()):
        buildings.box("Box", (3 * k, 0, 1), (2, 2, 2), material)
    sign.node_tree.nodes["Principled BSDF"].inputs["Emission Color"].default_value = (1, 0, 0, 1)
    buildings.ground(9, paint("Floor"))
    return {"Floor"}, set(made)


SCENES = (
    glass_house,
    village,
    set_by_nodes,
    scattered,
    foreign_shaders,
    missing_images,
    linked_collection,
    excluded,
    many,
    odd_geometry,
    shared_slots,
    emitters_and_hair,
)
