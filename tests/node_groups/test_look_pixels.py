"""Gloss over a base loses and makes no light; textures and panes show what their numbers say."""

from functools import partial

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.node_groups import glazing, gloss, spectral_texture
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def world_of(scene, colour):
    """A World of one colour."""
    world = bpy.data.worlds.new("Even")
    scene.world = world
    nodes.use(world)
    world.node_tree.nodes.clear()
    background = groups.add(world.node_tree, "ShaderNodeBackground", (*colour, 1.0))
    groups.add(world.node_tree, "ShaderNodeOutputWorld", background.outputs[0])


def material_of(make):
    """A material whose shader a function makes in its tree."""
    material = bpy.data.materials.new("Made")
    nodes.use(material)
    material.node_tree.nodes.clear()
    groups.add(material.node_tree, "ShaderNodeOutputMaterial", make(material.node_tree))
    return material


def attribute(mesh, tree, name, values):
    """A number or colour for each face, as the socket that reads it."""
    values = np.asarray(values, dtype=np.float32)
    kind, place = ("FLOAT", "value") if values.ndim == 1 else ("FLOAT_VECTOR", "vector")
    mesh.attributes.new(name, kind, "FACE").data.foreach_set(place, values.ravel())
    node = groups.add(tree, "ShaderNodeAttribute", attribute_name=name)
    return node.outputs["Fac" if values.ndim == 1 else "Vector"]


@pytest.mark.parametrize("kind", gloss.KINDS)
def test_in_an_even_light_gloss_is_not_seen(tmp_path, kind):
    """White base, white metal, white World: white, whatever gloss and coat do (a furnace)."""
    scene = faces.empty_scene()
    scene.cycles.samples, scene.cycles.max_bounces = 512, 2
    scene.eevee.taa_render_samples = 16
    world_of(scene, (1.0, 1.0, 1.0))
    rng = np.random.default_rng(0)
    normals = faces.directions(900)
    normals = normals[normals[:, 2] > 0.05]
    count = len(normals)
    some = lambda values: np.where(rng.random(count) < 0.5, values, 0.0)  # noqa: E731
    values = {
        "Roughness": rng.uniform(0, 1, count),
        "IOR": rng.uniform(1.3, 1.8, count),
        "Specular IOR Level": rng.uniform(0.2, 1.0, count),
        "Coat Weight": some(rng.uniform(0, 1, count)),
        "Coat Roughness": rng.uniform(0, 0.5, count),
    }
    if kind == gloss.MIXED:
        values["Metallic"] = some(rng.uniform(0, 1, count))
    put = faces.add_faces(scene, normals)
    put.visible_glossy = put.visible_diffuse = False  # in Cycles a face would see its neighbours

    def make(tree, engine, output):
        node = groups.add(tree, "ShaderNodeGroup", node_tree=gloss.ensure(kind))
        if kind != gloss.METAL:
            emission = groups.add(tree, "ShaderNodeEmission", (1.0, 1.0, 1.0, 1.0))
            for base in gloss.OUTPUTS.values():
                tree.links.new(emission.outputs[0], node.inputs[base])
        for name, given in values.items():
            socket = attribute(put.data, tree, f"{engine} {name}", given)
            tree.links.new(socket, node.inputs[name])
        return node.outputs[output]

    for engine, output in (("cycles", "Cycles"), ("eevee", "Shader")):
        put.material_slots[0].material = material_of(partial(make, engine=engine, output=output))
        off = faces.seen(scene, tmp_path, count, engine)[:, 0] - 1.0
        # The share that gloss takes is fitted to 0.008 on average; what a Principled itself
        # reflects differs by as much from one engine to the other (see `share_reflected`), and both
        # lose some light in rough metal.
        assert abs(off.mean()) < 0.01 and np.abs(off).mean() < 0.012
        assert np.quantile(np.abs(off), 0.95) < 0.03
        assert np.abs(off).max() < 0.08  # edge-on
        # Without the base's share being taken off there would be 0.1 to 0.2 too much.


def test_gloss_over_black_is_blenders_own(tmp_path):
    """Roughness, coat, relief and tint: pixel by pixel what a black Principled shows."""
    scene = faces.empty_scene()
    scene.cycles.samples, scene.eevee.taa_render_samples = 64, 8
    scene.cycles.max_bounces = 2
    faces.light(scene, tmp_path)
    put = faces.add_faces(scene, faces.directions(64))
    put.visible_glossy = False
    given = {
        "Roughness": 0.3,
        "IOR": 1.6,
        "Specular IOR Level": 0.8,
        "Specular Tint": (1.0, 0.6, 0.4, 1.0),
        "Coat Weight": 0.5,
        "Coat Roughness": 0.1,
        "Coat Tint": (0.7, 0.8, 0.9, 1.0),
        "Emission Color": (0.1, 0.2, 0.3, 1.0),
        "Emission Strength": 0.1,
    }

    def dressed(tree, node):
        lean = groups.add(tree, "ShaderNodeCombineXYZ", 0.2, -0.1, 0.97)
        for name in ("Normal", "Coat Normal"):
            tree.links.new(lean.outputs[0], node.inputs[name])
        for name, value in given.items():
            node.inputs[name].default_value = value
        return node.outputs[0]

    def ours(tree):
        return dressed(
            tree, groups.add(tree, "ShaderNodeGroup", node_tree=gloss.ensure(gloss.GLOSS))
        )

    def blenders(tree):
        node = groups.add(tree, "ShaderNodeBsdfPrincipled")
        node.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        return dressed(tree, node)

    for engine in ("cycles", "eevee"):
        pictures = []
        for make in (ours, blenders):
            put.material_slots[0].material = material_of(make)
            pictures.append(faces.seen(scene, tmp_path, 64, engine))
        # The same samples; normals differ by the trace that finds unlinked ones.
        np.testing.assert_allclose(*pictures, rtol=0.01, atol=0.002)
        assert pictures[0].std() > 0.01


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_textures_weight_three_values(tmp_path, engine):
    scene = faces.empty_scene()
    rng = np.random.default_rng(1)
    colours = rng.uniform(0, 1, (100, 3))
    basis = {name: rng.uniform(-0.1, 1.0, (3, 3)) for name in spectral_texture.OUTPUTS}
    to_rec709 = np.array([[1.6, -0.5, -0.1], [-0.1, 1.1, 0.0], [0.0, -0.1, 1.1]])
    put = faces.add_faces(scene, np.tile([0.0, 0.0, 1.0], (100, 1)))
    for name in ("Row R", "Row B", "Sun", "Lamp 2"):  # all are built alike

        def make(tree, name=name):
            node = groups.add(tree, "ShaderNodeGroup", node_tree=spectral_texture.ensure())
            tree.links.new(attribute(put.data, tree, f"in {name}", colours), node.inputs["Color"])
            spectral_texture.set_values(node, basis, to_rec709)
            kept = spectral_texture.get_values(node)[name]
            np.testing.assert_allclose(kept, to_rec709.T @ basis[name], atol=1e-6)
            return groups.add(tree, "ShaderNodeEmission", node.outputs[name]).outputs[0]

        put.material_slots[0].material = material_of(make)
        expected = colours @ to_rec709.T @ basis[name]
        pixels = faces.seen(scene, tmp_path, 100, engine)
        if engine == "eevee":
            expected = np.maximum(expected, 0.0)  # as Eevee shows an Emission; Cycles goes below
        np.testing.assert_allclose(pixels, expected, rtol=0.002, atol=0.001)  # half floats
    by_default = spectral_texture.ensure()
    node = groups.add(bpy.data.materials[0].node_tree, "ShaderNodeGroup", node_tree=by_default)
    values = spectral_texture.get_values(node)
    assert np.array_equal(values["Sun"], np.eye(3))
    rows = np.array([values[f"Row {c}"] for c in "RGB"])  # rows of the matrix, by channel
    for k, colour in enumerate(np.eye(3)):
        assert np.array_equal(rows[:, k], np.diag(colour))  # RGB times RGB


def pane(cos, tint, n=1.52):
    """Exact transmittance of a pane that lets `tint` through where faced."""
    inside = np.sqrt(1 - (1 - cos**2) / n**2)
    s, p = (cos - n * inside) / (cos + n * inside), (n * cos - inside) / (n * cos + inside)
    face, faced = (s**2 + p**2) / 2, ((n - 1) / (n + 1)) ** 2
    clear, clear_faced = (1 - face) / (1 + face), (1 - faced) / (1 + faced)
    return clear[:, None] * (tint / clear_faced) ** (1 / inside[:, None])


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_a_pane_tints_what_is_behind(tmp_path, engine):
    """Panes at all slants before a light: Fresnel and Beer; as two faces of a block the same."""
    scene = faces.empty_scene()
    scene.cycles.samples = 64
    world_of(scene, (0.0, 0.0, 0.0))
    tint = np.array([0.3, 0.6, 0.8])
    normals = faces.directions(64)
    put = faces.add_faces(scene, normals)
    behind = faces.add_faces(scene, np.array([[0.0, 0.0, 1.0]]))
    behind.location, behind.scale = (-100.0, -100.0, -200.0), (300.0, 300.0, 1.0)
    behind.visible_glossy = False  # a leaning pane would mirror it
    faces.watch(scene, (4.0, 4.0), 8.0)
    scene.render.resolution_x = scene.render.resolution_y = 8 * faces.PIXELS
    behind.material_slots[0].material = material_of(
        lambda tree: groups.add(tree, "ShaderNodeEmission", (1.0, 1.0, 1.0, 1.0)).outputs[0]
    )

    def make(tree):
        node = groups.add(tree, "ShaderNodeGroup", node_tree=glazing.ensure(), name="Pane")
        node.inputs["Transmittance"].default_value = (*tint, 1.0)
        return node.outputs[0]

    put.material_slots[0].material = glass = material_of(make)
    glass.surface_render_method = "BLENDED"  # dithered, Eevee shows no tint but its grey
    scene.cycles.transparent_max_bounces = 8
    expected = pane(normals[:, 2], tint)
    tolerance = {"eevee": 0.001, "cycles": 0.06}[engine]  # half floats; 64 samples of either-or
    pixels = faces.seen(scene, tmp_path, 64, engine)
    np.testing.assert_allclose(pixels, expected, atol=4 * tolerance)
    np.testing.assert_allclose(pixels.mean(axis=0), expected.mean(axis=0), atol=tolerance / 4)

    glass.node_tree.nodes["Pane"].inputs["Faces"].default_value = 2.0
    other = bpy.data.objects.new("Other face", put.data)
    other.location.z = -30.0
    scene.collection.objects.link(other)
    put.visible_glossy = other.visible_glossy = False
    pixels = faces.seen(scene, tmp_path, 64, engine)
    # What goes to and fro between the faces is mirrored away here: F² of the light, on average less
    # than 0.01 where a pane is not nearly edge-on.
    inside = normals[:, 2] > 0.3
    np.testing.assert_allclose(
        pixels[inside].mean(axis=0), expected[inside].mean(axis=0), atol=0.01 + tolerance / 4
    )
