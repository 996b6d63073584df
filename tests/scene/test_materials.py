"""Apply twice is once, remove leaves no trace, and what cannot be edited is refused."""

import contextlib

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.materials.record import Details, Result
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.tests import faces

pytestmark = pytest.mark.blender

MATRIX = np.arange(9.0).reshape(3, 3) / 10 - 0.1
DETAILS = Details(
    Result("Wall", "brick", "diagonal", 1.5, 0.2, 0.4, (0.1, 0.2, 0.3), True, "a line"),
    values=(0.25,) * 81,
    measured=(400.0, 700.0),
    source=(0.1, 0.2, "Image Texture"),
    file="paints.csv:brick",
)
SURFACE = spectral_material.Surface(np.array(MATRIX), "brick", "abc", DETAILS)


@pytest.fixture
def world(tmp_path):
    return faces.light(faces.empty_scene(), tmp_path)


LEFT_OUT = {"rna_type", "original", "users", "session_uid", "parent", "preview", "internal_links"}
NAMED = {"from_node", "to_node", "from_socket", "to_socket", "links", "id_data"}


def dump(thing, depth=0):
    """All that RNA and custom properties say about a material or node tree, as plain data."""
    record = {}
    with contextlib.suppress(AttributeError, TypeError):  # a struct that holds none
        record["custom properties"] = {
            key: value.to_dict() if hasattr(value, "to_dict") else value
            for key, value in thing.items()
            if key != "cycles"  # Blender 4.5 makes it when one looks for it
        }
    for prop in thing.bl_rna.properties:
        name = prop.identifier
        value = getattr(thing, name, None)
        if name in LEFT_OUT:
            continue
        if prop.type == "COLLECTION":
            value = [dump(item, depth + 1) for item in value] if depth < 5 else len(value)
            if name == "links":  # a set: their order means nothing
                value = sorted(value, key=str)
        elif prop.type == "POINTER" and value is not None:
            inside = name not in NAMED and depth < 5
            own = isinstance(value, bpy.types.ShaderNodeTree) and value.is_embedded_data
            inside = inside and (own or not isinstance(value, bpy.types.ID))
            value = dump(value, depth + 1) if inside else getattr(value, "name", "")
        elif getattr(prop, "is_array", False):
            value = [] if value is None else np.ravel(value).tolist()
        record[name] = value if isinstance(value, dict | list) else repr(value)
    return record


def principled(name="Principled"):
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    return material


def surface_of(material):
    return next(n for n in material.node_tree.nodes if n.type == "GROUP")


def bumpy():
    """Bump and alpha linked, displacement, volume and an unused node."""
    material = principled("Bumpy")
    tree = material.node_tree
    shader, output = tree.nodes["Principled BSDF"], tree.nodes["Material Output"]
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    volume, displace = (
        tree.nodes.new("ShaderNodeVolumeScatter"),
        tree.nodes.new("ShaderNodeDisplacement"),
    )
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], shader.inputs["Normal"])
    tree.links.new(noise.outputs[0], shader.inputs["Alpha"])
    tree.links.new(volume.outputs[0], output.inputs["Volume"])
    tree.links.new(displace.outputs[0], output.inputs["Displacement"])
    tree.nodes.new("ShaderNodeRGB")
    material.diffuse_color = (0.1, 0.2, 0.3, 0.4)
    material["mine"] = 7
    return material


def two_engines():
    """An output for each engine, and an inactive one."""
    material = principled("Two engines")
    tree = material.node_tree
    tree.nodes["Material Output"].target = "EEVEE"
    for target, kind in (("CYCLES", "ShaderNodeBsdfDiffuse"), ("CYCLES", "ShaderNodeEmission")):
        output, shader = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new(kind)
        output.target = target
        output.is_active_output = kind == "ShaderNodeBsdfDiffuse"
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def through_reroute():
    """A glass-like mix over Transparent, a reroute before the output."""
    material = principled("Reroute")
    tree = material.node_tree
    mix, reroute = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("NodeReroute")
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    mix.inputs[0].default_value = 0.25
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes["Principled BSDF"].outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def without_output():
    material = principled("No output")
    material.node_tree.nodes.remove(material.node_tree.nodes["Material Output"])
    return material


def unlinked():
    material = principled("Unlinked")
    material.node_tree.links.clear()
    return material


@pytest.mark.parametrize(
    "make", [principled, bumpy, two_engines, through_reroute, without_output, unlinked]
)
def test_remove_restores_everything(world, make):
    material = make()
    before = dump(material)
    spectral_material.apply(material, world, SURFACE)
    assert dump(material) != before and spectral_material.is_managed(material)
    spectral_material.remove(material)
    assert dump(material) == before
    assert len(bpy.data.node_groups) == 0
    spectral_material.remove(material)
    assert dump(material) == before


def test_twice_is_once(world):
    material = bumpy()
    spectral_material.apply(material, world, SURFACE)
    once = dump(material), [dump(group) for group in bpy.data.node_groups]
    spectral_material.apply(material, world, SURFACE)
    assert (dump(material), [dump(group) for group in bpy.data.node_groups]) == once
    told = spectral_material.managed(material)
    np.testing.assert_allclose(told.matrix, MATRIX, atol=1e-7)  # sockets are float32
    record = told.record
    assert (record.reflectance, record.reflectance_hash, told.world) == ("brick", "abc", world)
    assert told.details == DETAILS and spectral_material.managed_materials() == [material]
    spectral_material.update(material, np.eye(3))
    assert spectral_material.managed(material).matrix == np.eye(3).tolist()


def test_normal_and_alpha_are_carried_over(world):
    material = bumpy()
    spectral_material.apply(material, world, SURFACE)
    inputs = surface_of(material).inputs
    assert inputs["Normal"].links[0].from_node.type == "BUMP"
    assert inputs["Alpha"].links[0].from_node.type == "TEX_NOISE"
    output = material.node_tree.nodes["Material Output"]
    assert output.inputs["Volume"].is_linked and output.inputs["Displacement"].is_linked
    material = through_reroute()
    spectral_material.apply(material, world, SURFACE)
    assert surface_of(material).inputs["Alpha"].default_value == 0.25


def test_each_engines_output_is_taken_over(world):
    material = two_engines()
    spectral_material.apply(material, world, SURFACE)
    tree = material.node_tree
    for engine in ("EEVEE", "CYCLES"):
        fed_by = tree.get_output_node(engine).inputs["Surface"].links[0].from_node
        assert fed_by == surface_of(material)
    fed_by = [
        n.inputs[0].links[0].from_node.type for n in tree.nodes if n.type == "OUTPUT_MATERIAL"
    ]
    assert sorted(fed_by) == ["EMISSION", "GROUP", "GROUP"]


def test_names_do_not_matter(world):
    """Nodes, groups, World and material renamed: still found, still undone."""
    material = bumpy()
    spectral_material.apply(material, world, SURFACE)
    for thing in (*material.node_tree.nodes, *bpy.data.node_groups, world, material):
        thing.name = "Renamed"
    spectral_material.apply(material, world, SURFACE)
    assert (
        spectral_material.managed_materials(world) == [material] and len(bpy.data.node_groups) == 3
    )
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    spectral_material.remove(material)
    output = material.node_tree.get_output_node("ALL")
    assert output.inputs["Surface"].links[0].from_node == shader


def test_a_copy_is_managed_on_its_own(world):
    material = principled()
    spectral_material.apply(material, world, SURFACE)
    copy = material.copy()
    assert spectral_material.managed_materials() == [material, copy]
    spectral_material.remove(material)
    assert spectral_material.managed_materials() == [copy] and len(bpy.data.node_groups) == 3
    spectral_material.remove(copy)
    assert len(bpy.data.node_groups) == 0
    assert dump(copy.node_tree) == dump(material.node_tree)


def test_what_a_user_plugged_meanwhile_stays(world):
    material = principled()
    spectral_material.apply(material, world, SURFACE)
    tree = material.node_tree
    own = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes["Material Output"].inputs["Surface"]
    tree.links.new(own.outputs[0], output)
    spectral_material.remove(material)
    assert output.links[0].from_node == own
    spectral_material.apply(material, world, SURFACE)
    tree.nodes.remove(surface_of(material))
    assert not spectral_material.is_managed(material)
    spectral_material.apply(material, world, SURFACE)
    assert output.links[0].from_node == surface_of(material)
    spectral_material.remove(material)
    assert output.links[0].from_node == own


def test_two_worlds_and_a_change_of_world(world, tmp_path):
    scene = bpy.context.scene
    other = faces.light(scene, tmp_path, 2)
    assert other != world
    first, second = principled("First"), principled("Second")
    spectral_material.apply(first, world, SURFACE)
    spectral_material.apply(second, other, SURFACE)
    light_group.set_coefficients(world, np.full((4, 3), 0.5))
    assert len(bpy.data.node_groups) == 5  # the matrix is shared
    assert not light_group.coefficients_of(other).any()
    spectral_material.apply(second, world, SURFACE)
    assert spectral_material.managed_materials(world) == [first, second]
    spectral_material.remove(first)
    np.testing.assert_allclose(light_group.coefficients_of(world)[[0, 3]], [[0.5] * 3, [0] * 3])


def test_materials_of_object_and_data_slots():
    scene = faces.empty_scene()
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    of_data, of_object = principled("Data"), principled("Object")
    for _ in range(3):
        mesh.materials.append(of_data)
    objects = [bpy.data.objects.new(name, mesh) for name in "ab"]
    for thing in objects:
        scene.collection.objects.link(thing)
    objects[1].material_slots[1].link = "OBJECT"
    objects[1].material_slots[1].material = of_object
    objects[1].material_slots[2].link = "OBJECT"  # empty
    assert spectral_material.materials_of(objects) == [of_data, of_object]


def test_linked_and_overridden_materials_are_refused(world, tmp_path):
    library = str(tmp_path / "library.blend")
    bpy.data.libraries.write(library, {principled("Theirs")})
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        wanted.materials = ["Theirs"]
    linked = next(m for m in bpy.data.materials if m.library)
    before = dump(linked)
    for call in (spectral_material.apply, spectral_material.update):
        with pytest.raises(InputError, match=r'"Theirs": is linked from .*library.blend"; make it'):
            given = (world, SURFACE) if call is spectral_material.apply else (MATRIX,)
            call(linked, *given)
    assert dump(linked) == before and len(bpy.data.node_groups) == 0
    # Blender 5.3 takes what nothing uses for indirectly linked, and does not override that.
    mesh = bpy.data.meshes.new("Of theirs")
    mesh.materials.append(linked)
    override = linked.override_create()
    with pytest.raises(InputError, match="library override"):
        spectral_material.apply(override, world, SURFACE)


def test_a_sky_that_is_none_leaves_the_material_alone(world):
    material = principled()
    before = dump(material)
    with pytest.raises(InputError, match="has no World"):
        spectral_material.apply(material, None, SURFACE)
    assert dump(material) == before
    with pytest.raises(InputError, match="has no reflectance yet"):
        spectral_material.update(material, MATRIX)


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="from 5.0 every material has nodes")
def test_a_material_without_nodes_gets_and_loses_them(world):
    material = bpy.data.materials.new("Plain")
    material.diffuse_color = (0.9, 0.1, 0.2, 1.0)
    spectral_material.apply(material, world, SURFACE)
    spectral_material.apply(material, world, SURFACE)
    assert material.use_nodes
    spectral_material.remove(material)
    assert not material.use_nodes and tags.MATERIAL not in material
    fresh = bpy.data.materials.new("Plain too")
    fresh.diffuse_color = material.diffuse_color
    fresh.use_nodes = material.use_nodes = True  # what a user then finds is what Blender makes
    assert dump(material.node_tree) == dump(fresh.node_tree)


def test_older_groups_are_brought_up_to_date_in_place(world):
    """An older version keeps links, values and coefficients; its inside and sockets become ours."""
    material = bumpy()
    light_group.set_coefficients(world, np.random.default_rng(1).uniform(0, 1, (49, 3)))
    spectral_material.apply(material, world, SURFACE)
    kept = light_group.coefficients_of(world)
    now = [dump(group) for group in bpy.data.node_groups]
    for group in bpy.data.node_groups:
        group["spectral_skylight_version"] = 0
        group.nodes.remove(group.nodes[-1])
    surface = surface_of(material).node_tree
    surface.interface.remove(surface.interface.items_tree["Alpha"])
    assert "Alpha" not in surface_of(material).inputs
    light_group.ensure(world)
    assert surface_of(material).node_tree == surface and len(bpy.data.node_groups) == 3
    assert surface_of(material).inputs["Normal"].links[0].from_node.type == "BUMP"
    assert surface_of(material).inputs["Alpha"].default_value == 1.0
    np.testing.assert_array_equal(light_group.coefficients_of(world), kept)
    np.testing.assert_allclose(spectral_material.managed(material).matrix, MATRIX, atol=1e-7)
    again = [dump(group) for group in bpy.data.node_groups]
    strip = lambda groups: [[n["name"] for n in g["nodes"]] for g in groups]  # noqa: E731
    assert strip(again) == strip(now)
