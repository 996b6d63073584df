"""Which lamps shine on what: as renders show and link them, in glass houses and instances too."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.lights import light_linking, rendered_lamps, user_lamps
from spectral_skylight.addon.scene.output import render as renders
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import exr, faces
from spectral_skylight.tests.lanes import newest
from spectral_skylight.tests.scene.lamp_scenes import collection, house, instance, lamp, principled
from spectral_skylight.tests.scene.test_sun import sky_with_sun

pytestmark = pytest.mark.blender

GREY = Assignment("grey", np.full(81, 0.5))


@pytest.fixture
def scene(tmp_path):
    """A floor 8 wide of one material, seen from above, under an even sky."""
    scene = faces.empty_scene()
    faces.light(scene, tmp_path)
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.name = "Floor"
    bpy.context.object.data.materials.append(bpy.data.materials.new("Floor"))
    return scene


def make(scene, *names, **settings):
    bpy.context.view_layer.update()
    given = {bpy.data.materials[name]: GREY for name in names or ("Floor",)}
    return use_cases.make_spectral(scene, given, Settings(**{"occlusion": "open", **settings}))


def twins(scene):
    """Where the lamps of ours stand that follow users', by the name of those."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    found = [obj for obj in scene.objects if obj.get(tags.LAMP) == user_lamps.TWIN]
    return {
        rendered_lamps.followed(obj).name: np.array(obj.evaluated_get(depsgraph).matrix_world)
        for obj in found
    }


def test_only_what_a_render_shows_shines(scene):
    """Excluded and render-off collections, ray visibility, portals and empty nodes give nothing."""
    root = scene.collection
    lamp("Shown", root)
    lamp("Alone", collection("Child", collection("Excluded", root)))
    lamp("Gone", bpy.data.collections["Excluded"])
    off = collection("Render off", root)
    lamp("Off", off)
    lamp("Below", collection("Below", off))
    off.hide_render = True
    lamp("Hidden", root).hide_render = True
    lamp("No diffuse", root).visible_diffuse = False
    lamp("No factor", root, diffuse_factor=0.0)
    bare = lamp("Bare nodes", root)
    bare.data.use_nodes = True
    bare.data.node_tree.nodes.clear()
    layer = bpy.context.view_layer.layer_collection.children["Excluded"]
    layer.exclude = True
    layer.children["Child"].exclude = False
    make(scene)
    assert set(twins(scene)) == {"Shown", "Alone"}
    layer.children["Child"].exclude = True
    make(scene)
    assert set(twins(scene)) == {"Shown"}


def test_instanced_lamps_stand_where_they_are_shown(scene):
    """In instances within instances, turned, scaled and moved, and where a modifier puts them."""
    luminaire, row = collection("Luminaire"), collection("Row")
    lamp("Bulb", luminaire).location = (0.5, 0.0, 0.2)
    luminaire.instance_offset = (0.5, 0.0, 0.0)
    instance(luminaire, row, location=(0.0, 1.0, 0.0))
    outer = instance(row, scene.collection, location=(1.0, 2.0, 3.0), scale=(2.0, 2.0, 2.0))
    outer.rotation_euler.z = math.pi / 2
    make(scene)
    # (0.5, 0, 0.2) less the offset, one along y, then doubled, turned by 90° and moved.
    at = twins(scene)["Bulb"][:3, 3]
    np.testing.assert_allclose(at, [1.0 - 2.0, 2.0, 3.0 + 0.4], atol=1e-5)
    (one,) = rendered_lamps.of_scene(scene)
    np.testing.assert_allclose(one.matrix[:3, 3], at, atol=1e-5)
    outer.location.x += 5.0  # it moves with what carries it, without us
    bpy.context.view_layer.update()
    assert twins(scene)["Bulb"][0, 3] == pytest.approx(4.0, abs=1e-5)
    outer.hide_render = True
    make(scene)
    assert not twins(scene)


def test_a_lamp_that_geometry_nodes_instance_shines(scene):
    bulb = lamp("Bulb", collection("Not in the scene"))
    tree = bpy.data.node_groups.new("Lamps", "GeometryNodeTree")
    tree.interface.new_socket("G", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = bulb, True
    move = tree.nodes.new("GeometryNodeTransform")
    move.inputs["Translation"].default_value = (1.0, 2.0, 3.0)
    tree.links.new(info.outputs["Geometry"], move.inputs["Geometry"])
    tree.links.new(move.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    mesh = bpy.data.objects.new("Scatter", bpy.data.meshes.new("Scatter"))
    scene.collection.objects.link(mesh)
    mesh.modifiers.new("Lamps", "NODES").node_group = tree
    make(scene)
    np.testing.assert_allclose(twins(scene)["Bulb"][:3, 3], [1.0, 2.0, 3.0], atol=1e-5)


def test_lamps_keep_their_linking(scene):
    """A twin shines on those of our objects alone that its lamp is linked to, and is blocked so."""
    other = bpy.data.objects["Floor"].copy()
    other.name = "Other"
    scene.collection.objects.link(other)
    only, but, free = (lamp(name, scene.collection) for name in ("Only", "But", "Free"))
    only.light_linking.receiver_collection = collection("Only")
    bpy.data.collections["Only"].objects.link(other)
    but.light_linking.receiver_collection = collection("But")
    bpy.data.collections["But"].objects.link(other)
    bpy.data.collections["But"].collection_objects[0].light_linking.link_state = "EXCLUDE"
    only.light_linking.blocker_collection = bpy.data.collections["Only"]
    nothing = lamp("Nothing", scene.collection)
    nothing.light_linking.receiver_collection = collection("Nothing")
    bpy.data.collections["Nothing"].objects.link(free)  # none of what is spectral
    for _ in range(2):  # once more is the same
        make(scene)
        reached, blocked = {}, {}
        for obj in (o for o in scene.objects if o.get(tags.LAMP) == user_lamps.TWIN):
            name = rendered_lamps.followed(obj).name
            linking = obj.light_linking
            reached[name] = {
                o.name for o in linking.receiver_collection.objects if o.type == "MESH"
            }
            assert linking.receiver_collection.objects, "an empty one lights all"
            if linking.blocker_collection is not None:
                blocked[name] = {o.name for o in linking.blocker_collection.objects}
        assert reached == {
            "Only": {"Other"},
            "But": {"Floor"},
            "Free": {"Floor", "Other"},
            "Nothing": set(),
        }
        assert blocked == {"Only": {"Other"}}
    ours = [
        c for c in bpy.data.collections if {tags.RECEIVERS, tags.LINKED, tags.PANES} & set(c.keys())
    ]
    assert len(ours) == 5
    use_cases.remove(bpy.data.materials)
    assert {c.name for c in bpy.data.collections} == {"Only", "But", "Nothing"}


def test_what_of_lamps_cannot_be_carried_is_named(scene):
    """Linking of reflected light, and view layers that have lamps of their own."""
    only = lamp("Only", scene.collection)
    only.light_linking.receiver_collection = collection("Some")
    bpy.data.collections["Some"].objects.link(bpy.data.objects["Floor"])
    make(scene, occlusion="baked")
    (line,) = light_group.record_of(scene.world).warnings
    assert line.startswith("Only: its light linking holds for direct light")
    make(scene)
    assert not light_group.record_of(scene.world).warnings
    night = collection("Night", scene.collection)
    lamp("Street", night)
    scene.view_layers.new("Other").layer_collection.children["Night"].exclude = True
    make(scene)
    (line,) = light_group.record_of(scene.world).warnings
    assert line == "Street: lights spectral materials in all view layers"
    scene.view_layers["Other"].use = False
    make(scene)
    assert not light_group.record_of(scene.world).warnings


def test_an_instance_loses_its_light_only_to_what_scatters_it(scene):
    """Linking goes by the Empty: panes inside take nothing, plaster takes all and is named."""
    inside = collection("House")
    house(scene, bpy.data.materials["Floor"], principled("Pane", Transmission_Weight=1.0), None)
    walls = bpy.data.objects["House"]
    walls.data.materials[2] = bpy.data.materials["Pane"]
    scene.collection.objects.unlink(walls)
    inside.objects.link(walls)
    instance(inside, scene.collection)
    lamp("Lamp", scene.collection)
    make(scene)
    assert {o.name for o in light_linking.find(scene).objects} == {"Floor", "Instance"}
    assert not light_group.record_of(scene.world).warnings
    walls.data.materials[2] = principled("Plaster")
    make(scene)
    assert {o.name for o in light_linking.find(scene).objects} == {"Floor"}
    (line,) = light_group.record_of(scene.world).warnings
    assert line.startswith("Instance: no sun and no lamps") and "Plaster" in line


def test_lamp_nodes_count_as_cycles_has_them(scene):
    """Color, black body and strength of an Emission; what else there is, is named."""

    def nodes_for(obj, **values):
        obj.data.use_nodes = True
        tree = obj.data.node_tree
        tree.nodes.clear()
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputLight").inputs[0])
        for key, value in values.items():
            emission.inputs[key].default_value = value
        return tree, emission

    nodes_for(lamp("Red", scene.collection), Color=(0.5, 0.25, 0.125, 1.0), Strength=3.0)
    tree, emission = nodes_for(lamp("Warm", scene.collection), Strength=2.0)
    tree.links.new(groups.add(tree, "ShaderNodeBlackbody", 2700.0).outputs[0], emission.inputs[0])
    tree, emission = nodes_for(lamp("Profile", scene.collection))
    tree.links.new(tree.nodes.new("ShaderNodeTexIES").outputs[0], emission.inputs["Strength"])
    make(scene)
    light = use_cases.analyzed(scene.world, Settings())
    found = user_lamps.find(scene, Settings().transfer(light), np.empty((0, 81)))
    colours = dict(zip((one.name for one in found.shining), found.colours, strict=True))
    np.testing.assert_allclose(colours["Red"], [1.5, 0.75, 0.375], rtol=1e-6)
    np.testing.assert_allclose(colours["Profile"], 1.0)
    assert colours["Warm"] @ [0.2126, 0.7152, 0.0722] == pytest.approx(2.0, rel=1e-3)
    assert colours["Warm"][0] > 3.0 * colours["Warm"][2]  # a bulb's
    (line,) = found.left_out
    assert line == 'Profile: shines without its nodes: "IES Texture"'
    assert line in light_group.record_of(scene.world).warnings


def test_glass_and_metal_leave_a_house_its_light(scene):
    """Panes and metal in one mesh with walls; what scatters light takes it, and is named."""
    wall = bpy.data.materials["Floor"]
    pane, steel = principled("Pane", Transmission_Weight=1.0), principled("Steel", Metallic=1.0)
    mesh = house(scene, wall, pane, steel)
    lamp("Lamp", scene.collection)
    make(scene)
    assert {o.name for o in light_linking.find(scene).objects} == {"Floor", "House"}
    assert not light_group.record_of(scene.world).warnings
    for inside in (
        {"Metallic": 0.5},
        {"Transmission_Weight": 0.9},
        {"Metallic": 1.0, "Sheen_Weight": 0.5},
    ):
        mesh.materials[1] = principled("Lacquer", **inside)
        make(scene)
        assert set(light_linking.mixed(scene)) == {bpy.data.objects["House"]}
        (line,) = light_group.record_of(scene.world).warnings
        assert line.startswith("House: no sun and no lamps") and "Lacquer" in line
        bpy.data.materials.remove(mesh.materials[1])
    mesh.materials[1] = None
    make(scene)
    (line,) = light_group.record_of(scene.world).warnings
    assert "faces without a material" in line


def test_a_shader_that_is_not_connected_burns_nothing(scene):
    """An old Diffuse beside the Glass that shows does not; one inside a group that shows does."""
    pane = principled("Pane", Transmission_Weight=1.0)
    groups.add(pane.node_tree, "ShaderNodeBsdfDiffuse")
    house(scene, bpy.data.materials["Floor"], pane, pane)
    lamp("Lamp", scene.collection)
    make(scene)
    assert not light_linking.mixed(scene)
    inside = bpy.data.node_groups.new("Paint", "ShaderNodeTree")
    inside.interface.new_socket("S", in_out="OUTPUT", socket_type="NodeSocketShader")
    groups.add(inside, "NodeGroupOutput", groups.add(inside, "ShaderNodeBsdfDiffuse").outputs[0])
    tree = pane.node_tree
    group = groups.add(tree, "ShaderNodeGroup", node_tree=inside)
    tree.links.new(group.outputs[0], tree.get_output_node("EEVEE").inputs["Surface"])
    assert set(light_linking.mixed(scene)) == {bpy.data.objects["House"]}


@newest
@pytest.mark.slow
def test_pictures_of_a_glass_house_and_an_instanced_lamp(tmp_path):
    """Walls beside panes have the sun, panes are not burnt out; a lamp in an instance is one."""
    sky_with_sun(tmp_path / "sky.exr")
    scene = faces.empty_scene()
    scene.eevee.use_shadows = True
    use_cases.set_sky(scene, tmp_path / "sky.exr", Settings())
    wall = bpy.data.materials.new("Wall")
    pane, steel = principled("Pane", Transmission_Weight=1.0), principled("Steel", Metallic=1.0)
    mesh = house(scene, wall, pane, steel)
    mesh.polygons.foreach_set("material_index", [0, 0, 0])
    faces.watch(scene, (0.0, 0.0), 8)
    scene.render.resolution_x, scene.render.resolution_y = 64, 16
    scene.eevee.taa_render_samples = 4

    def shoot(name, engine="eevee"):
        path, _ = renders.render(scene, tmp_path / f"{name}.exr", engine=engine)
        return exr.picture(path)[8, :, :3].astype(float)

    make(scene, "Wall")
    alone = shoot("alone")
    mesh.polygons.foreach_set("material_index", [0, 1, 2])
    make(scene, "Wall")
    beside = shoot("beside")
    np.testing.assert_allclose(beside[4:28], alone[4:28], rtol=0.01)
    assert beside.max() < 10.0  # the lamp's 1e5 is nowhere seen
    dark = beside
    bulb = lamp("Bulb", scene.collection)
    bulb.matrix_world = Matrix.Translation((-2.0, 0.0, 1.0))
    make(scene, "Wall")
    lit = shoot("lit")
    assert lit[16, 1] > dark[16, 1] + 0.2
    library = collection("Library")
    library.objects.link(bulb)
    scene.collection.objects.unlink(bulb)
    bulb.location = (0.0, 0.0, 0.0)
    instance(library, scene.collection, location=(-2.0, 0.0, 1.0))
    make(scene, "Wall")
    np.testing.assert_allclose(shoot("instanced")[4:28], lit[4:28], rtol=0.01)
    bpy.data.objects["Instance"].hide_render = True
    make(scene, "Wall")
    np.testing.assert_allclose(shoot("off")[4:28], dark[4:28], rtol=0.01)
    # A lamp that is linked to nothing spectral: Blender takes an empty collection for no linking.
    nobodys = lamp("Nobody's", scene.collection)
    nobodys.location = (-2.0, 0.0, 1.0)
    nobodys.light_linking.receiver_collection = collection("Others")
    bpy.data.collections["Others"].objects.link(scene.camera)
    make(scene, "Wall")
    for engine, noise in (("eevee", 0.01), ("cycles", 0.05)):
        scene.cycles.samples = 64
        seen = shoot("nobody", engine)
        np.testing.assert_allclose(seen[8:24].mean(axis=0), dark[8:24].mean(axis=0), rtol=noise)
