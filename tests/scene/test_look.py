"""What an old shader looked like is taken over by our nodes, and taking those away leaves it."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.materials import shader_rewrite, spectral_material
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.node_groups import gloss, spectral_texture
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces
from spectral_skylight.tests.scene.test_materials import dump

pytestmark = pytest.mark.blender


@pytest.fixture(autouse=True)
def empty():
    faces.empty_scene()


def surface_group(colour=(1.0, 1.0, 1.0)):
    """A surface that emits one colour: with the sockets that `shader_rewrite.dress` wants."""

    def build(tree):
        emission = groups.add(tree, "ShaderNodeEmission", (*colour, 1.0)).outputs[0]
        groups.add(tree, "NodeGroupOutput", emission, emission)

    return groups.ensure(
        None,
        "Stub",
        1,
        [
            *(groups.Socket(name, "Vector", "") for name in spectral_texture.OUTPUTS),
            groups.Socket("Normal", "Vector", ""),
            groups.Socket("Alpha", "Float", "", 1.0),
        ],
        [groups.Socket("Shader", "Shader", ""), groups.Socket("Cycles", "Shader", "")],
        build,
    )


def material_with(kind, **values):
    """A material of one shader, with some of its inputs set."""
    material = bpy.data.materials.new(kind)
    nodes.use(material)
    tree = material.node_tree
    tree.nodes.clear()
    shader = groups.add(tree, f"ShaderNode{kind}", name="Old")
    for name, value in values.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    groups.add(tree, "ShaderNodeOutputMaterial", shader.outputs[0], name="Output")
    return material


def put(material, **settings):
    """Dress the material and plug it in; return its look, its surface and what was plugged."""
    tree = material.node_tree
    surface = groups.add(tree, "ShaderNodeGroup", node_tree=surface_group())
    surface[tags.NODE] = "surface"
    output = tree.nodes["Output"].inputs["Surface"]
    old = shader_rewrite.read(nodes.source(output))
    tops = shader_rewrite.dress(material, surface, old, **settings)
    assert tops == shader_rewrite.tops(tree, surface)
    tree.links.new(tops["Shader"], output)
    return old, surface, tops


def take_off(material, plugged):
    """Remove what was added, and plug the old shader in again."""
    tree = material.node_tree
    for node in [n for n in tree.nodes if tags.NODE in n]:
        tree.nodes.remove(node)
    tree.links.new(plugged, tree.nodes["Output"].inputs["Surface"])


def value_of(socket):
    value = getattr(socket, "default_value", None)
    return list(value) if hasattr(value, "__len__") else value


def keyframed(material):
    socket = material.node_tree.nodes["Old"].inputs["Roughness"]
    for frame, value in ((1, 0.1), (10, 0.7)):
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)


def driven(material):
    driver = material.node_tree.nodes["Old"].inputs["Specular Tint"]
    for axis in (0, 2):
        curve = driver.driver_add("default_value", axis)
        curve.driver.type = "AVERAGE"
        target = curve.driver.variables.new().targets[0]
        target.id_type, target.id, target.data_path = "MATERIAL", material, "pass_index"


def with_textures(material):
    tree = material.node_tree
    shader, noise = tree.nodes["Old"], groups.add(tree, "ShaderNodeTexNoise", name="Noise")
    bump = groups.add(tree, "ShaderNodeBump", name="Bump")
    reroute = groups.add(tree, "NodeReroute", noise.outputs["Color"], name="Reroute")
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], shader.inputs["Normal"])
    tree.links.new(reroute.outputs[0], shader.inputs["Base Color"])
    tree.links.new(noise.outputs[0], shader.inputs["Alpha"])
    tree.links.new(noise.outputs[0], shader.inputs["Coat Weight"]).is_muted = True
    tree.links.new(noise.outputs[0], shader.inputs["Metallic"])


@pytest.mark.parametrize("change", [None, keyframed, driven, with_textures])
@pytest.mark.parametrize("textured", [False, True])
def test_taken_off_again_nothing_is_left(change, textured):
    material = material_with("BsdfPrincipled", Roughness=0.3, Coat_Weight=0.5)
    if change:
        change(material)
    before = dump(material)
    shader = material.node_tree.nodes["Old"].outputs[0]
    seen = []
    for _ in range(2):  # apply → remove → apply: the same again
        _, _, tops = put(material, textured=textured)
        node = tops["Shader"].node
        seen.append([(s.name, s.is_linked, str(value_of(s))) for s in node.inputs])
        take_off(material, shader)
        assert dump(material) == before
    assert seen[0] == seen[1]


def test_a_principled_keeps_its_values_links_and_motion():
    material = material_with(
        "BsdfPrincipled", Roughness=0.3, IOR=1.7, Coat_Weight=0.4, Specular_Tint=(0.9, 0.8, 0.7, 1)
    )
    with_textures(material)
    keyframed(material)
    faces.add_faces(bpy.context.scene, faces.directions(1)).data.materials[0] = material
    old, surface, tops = put(material, textured=True)
    tree = material.node_tree
    node = tops["Shader"].node
    assert old.kind == gloss.MIXED == node.node_tree[groups.KIND]
    assert tops["Cycles"].node == node  # one node, one set of values, for both engines
    fed = {s.name: s.links[0].from_node.name for s in node.inputs if s.is_linked}
    assert fed["Metallic"] == fed["Alpha"] == "Noise" and fed["Normal"] == "Bump"
    assert fed["Metal Color"] == "Reroute" and fed["Base"] == surface.name
    assert "Coat Weight" not in fed  # its link was muted
    np.testing.assert_allclose(node.inputs["IOR"].default_value, 1.7)
    np.testing.assert_allclose(node.inputs["Coat Weight"].default_value, 0.4)
    np.testing.assert_allclose(node.inputs["Metal Edge"].default_value[:3], (0.9, 0.8, 0.7))
    assert surface.inputs["Normal"].links[0].from_node.name == "Bump"
    assert not surface.inputs["Alpha"].is_linked and surface.inputs["Alpha"].default_value == 1.0
    texture = shader_rewrite.texture_node(material)
    assert texture.inputs["Color"].links[0].from_node.name == "Reroute" and old.colour
    for name in spectral_texture.OUTPUTS:
        assert surface.inputs[name].links[0].from_node == texture
    tree.nodes["Old"].inputs["Specular Tint"].default_value[0] = 0.5  # copied: does not follow
    for frame, value in ((1, 0.1), (10, 0.7), (5, 0.344)):
        bpy.context.scene.frame_set(frame)
        shown = material.evaluated_get(bpy.context.evaluated_depsgraph_get())
        now = shown.node_tree.nodes[node.name].inputs["Roughness"].default_value
        assert now == pytest.approx(
            shown.node_tree.nodes["Old"].inputs["Roughness"].default_value, abs=1e-6
        )
        assert now == pytest.approx(value, abs=0.02)  # the curve is eased between keyframes


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ({}, gloss.GLOSS),
        ({"Metallic": 1.0}, gloss.METAL),
        ({"Metallic": 0.3}, gloss.MIXED),
        ({"Specular_IOR_Level": 0.0}, shader_rewrite.MATT),
        ({"Specular_IOR_Level": 0.0, "Coat_Weight": 0.1}, gloss.GLOSS),
        ({"Specular_IOR_Level": 0.0, "Emission_Strength": 0.1}, gloss.GLOSS),
    ],
)
def test_the_least_that_shows_it_all(values, kind):
    """Which trees there are is a closed set: another kind of shader is not compiled for a value."""
    old, surface, tops = put(material_with("BsdfPrincipled", **values))
    assert old.kind == kind and old.left_out == ()
    node = tops["Shader"].node
    assert node == surface if kind == shader_rewrite.MATT else node.node_tree[groups.KIND] == kind


@pytest.mark.parametrize(
    ("shader", "values", "kind", "words"),
    [
        ("BsdfDiffuse", {}, shader_rewrite.MATT, ()),
        ("BsdfGlossy", {"Color": (0.2, 0.5, 0.7, 1.0), "Anisotropy": 0.3}, gloss.METAL, ()),
        ("BsdfMetallic", {"Base_Color": (0.2, 0.5, 0.7, 1.0), "Anisotropy": 0.3}, gloss.METAL, ()),
        ("BsdfSheen", {}, shader_rewrite.MATT, ("what Sheen BSDF adds to a diffuse surface",)),
        ("BsdfPrincipled", {"Sheen_Weight": 0.5}, gloss.GLOSS, ("sheen",)),
        ("BsdfPrincipled", {"Transmission_Weight": 1.0}, gloss.GLOSS, ("transmission",)),
        ("BsdfPrincipled", {"Diffuse_Roughness": 0.5}, gloss.GLOSS, ("diffuse roughness",)),
        ("BsdfDiffuse", {"Roughness": 0.5}, shader_rewrite.MATT, ("diffuse roughness",)),
        ("BsdfGlass", {}, shader_rewrite.MATT, ()),
        ("Emission", {}, shader_rewrite.MATT, ()),
    ],
)
def test_other_shaders(shader, values, kind, words):
    material = material_with(shader, **values)
    old, _, tops = put(material)
    assert old.kind == kind and old.left_out == words
    assert old.glass == (shader == "BsdfGlass" or "transmission" in words)
    if kind == gloss.METAL:
        node = tops["Shader"].node
        np.testing.assert_allclose(node.inputs["Metal Color"].default_value[:3], (0.2, 0.5, 0.7))
        np.testing.assert_allclose(node.inputs["Anisotropic"].default_value, 0.3)
        assert shader_rewrite.set_metal(material, (0.9, 0.6, 0.3), (1.0, 0.9, 0.8))
        np.testing.assert_allclose(node.inputs["Metal Color"].default_value[:3], (0.9, 0.6, 0.3))
    else:
        assert not shader_rewrite.set_metal(material, (1.0, 1.0, 1.0), (1.0, 1.0, 1.0))


def test_colours_that_one_reflectance_cannot_hold_are_told():
    """A second colour in a mix, a metal's texture, and another shader for Cycles."""
    material = material_with("BsdfPrincipled", Metallic=1.0)
    tree = material.node_tree
    shader = tree.nodes["Old"]
    tree.links.new(groups.add(tree, "ShaderNodeTexNoise").outputs[1], shader.inputs["Base Color"])
    assert spectral_material.look_of(material).left_out == ("the spectrum of a metal's texture",)
    material = material_with("BsdfDiffuse")
    tree = material.node_tree
    first = tree.nodes["Old"]
    second = groups.add(tree, "ShaderNodeBsdfPrincipled")
    mixed = groups.add(tree, "ShaderNodeMixShader", 0.5, first.outputs[0], second.outputs[0])
    output = tree.nodes["Output"]
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    assert spectral_material.look_of(material).left_out == ()  # both 0.8
    second.inputs["Base Color"].default_value = (0.8, 0.1, 0.1, 1.0)
    (line,) = spectral_material.look_of(material).left_out
    assert line == "1 more base color(s) that are mixed in"
    output.target = "EEVEE"
    other = groups.add(tree, "ShaderNodeOutputMaterial", second.outputs[0])
    other.target = "CYCLES"
    assert spectral_material.look_of(material).left_out == (line, "what Cycles alone shows")


def test_nothing_plugged_in():
    material = material_with("BsdfDiffuse")
    material.node_tree.links.clear()
    old, surface, tops = put(material)
    assert old.shader is None and tops["Shader"] == surface.outputs["Shader"]


def test_a_mix_is_rebuilt_around_our_base():
    """Alpha by Transparent, a Glossy and an Emission on top: mixed as before, our base inside."""
    material = material_with("BsdfPrincipled")
    tree = material.node_tree
    fresnel = groups.add(tree, "ShaderNodeFresnel", name="Fresnel")
    glossy, glow, clear, diffuse = (
        groups.add(tree, f"ShaderNode{kind}", name=kind)
        for kind in ("BsdfGlossy", "Emission", "BsdfTransparent", "BsdfDiffuse")
    )
    sockets = lambda *names: [tree.nodes[name].outputs[0] for name in names]  # noqa: E731
    groups.add(
        tree, "ShaderNodeMixShader", fresnel.outputs[0], *sockets("Old", "BsdfGlossy"), name="One"
    )
    groups.add(tree, "ShaderNodeAddShader", *sockets("One", "Emission"), name="Two")
    groups.add(tree, "ShaderNodeMixShader", 0.25, clear.outputs[0], *sockets("Two"), name="Three")
    tree.links.new(tree.nodes["Three"].outputs[0], tree.nodes["Output"].inputs["Surface"])
    before = dump(material)
    old, surface, tops = put(material)
    assert old.kind == gloss.GLOSS and old.targets == (tree.nodes["Old"],)
    for name, base in gloss.OUTPUTS.items():
        three = tops[name].node
        assert three.inputs[0].default_value == 0.25 and three.name != "Three"
        assert three.inputs[1].links[0].from_node == clear
        two = three.inputs[2].links[0].from_node
        assert two.inputs[1].links[0].from_node == glow
        one = two.inputs[0].links[0].from_node
        assert one.inputs[0].links[0].from_node == fresnel
        assert one.inputs[2].links[0].from_node == glossy
        ours = one.inputs[1].links[0]
        assert ours.from_socket.name == name and ours.from_node[tags.NODE] == "gloss"
        assert ours.from_node.inputs[base].links[0].from_node == surface
    take_off(material, tree.nodes["Three"].outputs[0])
    assert dump(material) == before
    _, surface, tops = put(material, kind=shader_rewrite.MATT)  # as without a look: all replaced
    assert tops["Shader"].node == surface and surface.inputs["Alpha"].default_value == 0.25
    assert diffuse.outputs[0].is_linked is False


@pytest.mark.slow
def test_pixels_come_back(tmp_path):
    """Textured, bumpy, half metal, see-through: off again as before, on again as then."""
    scene = bpy.context.scene
    world = faces.light(scene, tmp_path)
    scene.cycles.max_bounces, scene.cycles.transparent_max_bounces = 2, 4
    scene.cycles.samples = scene.eevee.taa_render_samples = 4
    bpy.ops.mesh.primitive_uv_sphere_add()
    material = material_with("BsdfPrincipled", Roughness=0.3, Coat_Weight=0.5)
    with_textures(material)
    bpy.context.object.data.materials.append(material)
    faces.watch(scene, (0.0, 0.0), 2.0)
    scene.render.resolution_x = scene.render.resolution_y = 33

    def shown():
        return [faces.picture(scene, tmp_path, engine)[..., :3] for engine in ("cycles", "eevee")]

    def put_on():
        matrix = np.diag([0.6, 0.3, 0.1])
        surface = spectral_material.Surface(matrix, gloss=True, textured=True)
        spectral_material.apply(material, world, surface)
        light_group.set_coefficients(world, np.ones((1, 3)))

    before = shown()
    put_on()
    on = shown()
    spectral_material.remove(material)
    assert not bpy.data.node_groups
    after = shown()
    put_on()
    again = shown()
    for k in range(2):
        np.testing.assert_array_equal(before[k], after[k])
        np.testing.assert_array_equal(on[k], again[k])
        assert np.abs(on[k] - before[k]).mean() > 0.01
        relief = on[k][12:21, 12:21].std(axis=(0, 1))
        assert np.all(relief > 0.01)  # texture and bumps are seen
