"""The sky turns and dims with the World, by keyframes too; normals and alpha are honoured."""

import os
import subprocess
import sys

import bpy
import numpy as np
import pytest
from mathutils import Euler

from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.sky.polynomial import evaluate_polynomial
from spectral_skylight.tests import faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]

NORMALS = faces.directions(100, seed=8)
TURN = (0.3, -0.2, 1.2)
# Uneven in x, y and z, so that a wrong turn shows; everywhere positive.
COEFFICIENTS = np.random.default_rng(3).uniform(-0.1, 0.1, (16, 3)) + np.eye(16)[:, :1]
EEVEE = 0.0015  # half floats, rounded twice: 0.1 %, and a little for the normals
CYCLES = 1e-4  # float32


def expected(normals=NORMALS, turn=(0.0, 0.0, 0.0), inverse=False):
    rotation = np.array(Euler(turn).to_matrix())
    turned = normals @ (rotation if inverse else rotation.T)
    return evaluate_polynomial(COEFFICIENTS, turned)


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    world = faces.light(scene, tmp_path)
    light_group.set_coefficients(world, COEFFICIENTS)
    material = bpy.data.materials.new("Matt")
    spectral_material.apply(material, world, spectral_material.Surface(np.eye(3), "one", "0"))
    return scene


def put_faces(scene):
    faces.add_faces(scene, NORMALS).material_slots[0].material = bpy.data.materials["Matt"]


def put_mesh(scene, name):
    """One of Blender's meshes, 2 units wide, that fills a picture of 33 pixels."""
    getattr(bpy.ops.mesh, name)()
    bpy.context.object.data.materials.append(bpy.data.materials["Matt"])
    faces.watch(scene, (0.0, 0.0), 2.0)
    scene.render.resolution_x = scene.render.resolution_y = 33


def assert_keyframes_followed(scene, folder):
    for engine, tolerance in (("eevee", EEVEE), ("cycles", CYCLES)):
        for frame, strength, turn in ((1, 0.5, (0.0, 0.0, 0.0)), (10, 2.0, TURN)):
            scene.frame_set(frame)
            pixels = faces.seen(scene, folder, len(NORMALS), engine)
            np.testing.assert_allclose(pixels, strength * expected(turn=turn), rtol=tolerance)


def test_keyframed_world_also_after_reload(scene, tmp_path):
    put_faces(scene)
    nodes = scene.world.node_tree.nodes
    turn, strength = nodes["Mapping"].inputs["Rotation"], nodes["Background"].inputs["Strength"]
    for frame, value, angles in ((1, 0.5, (0.0, 0.0, 0.0)), (10, 2.0, TURN)):
        strength.default_value, turn.default_value = value, angles
        strength.keyframe_insert("default_value", frame=frame)
        turn.keyframe_insert("default_value", frame=frame)
    assert_keyframes_followed(scene, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "turning.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "turning.blend"))
    assert_keyframes_followed(bpy.context.scene, tmp_path)


@pytest.mark.parametrize("vector_type", ["POINT", "VECTOR", "NORMAL", "TEXTURE"])
def test_turn_means_what_it_means_to_the_background(scene, tmp_path, vector_type):
    """The polynomial of the HDRI's own directions, seen on faces, turns as the HDRI itself does."""
    put_faces(scene)
    mapping = scene.world.node_tree.nodes["Mapping"]
    mapping.vector_type = vector_type
    mapping.inputs["Rotation"].default_value = TURN
    light_group.ensure(scene.world)
    pixels = faces.seen(scene, tmp_path, len(NORMALS), "cycles")
    turned = expected(turn=TURN, inverse=vector_type == "TEXTURE")
    np.testing.assert_allclose(pixels, turned, rtol=CYCLES)


def test_world_in_another_name_and_without_mapping(scene, tmp_path):
    put_faces(scene)
    tree = scene.world.node_tree
    scene.world.name = 'A "sky" of \\ ours'
    tree.nodes["Background"].name = 'The "light" \\'
    tree.nodes["Mapping"].inputs["Rotation"].default_value = TURN
    light_group.ensure(scene.world)
    tree.nodes.remove(tree.nodes["Mapping"])
    surface = light_group.ensure(scene.world)
    tree.nodes['The "light" \\'].inputs["Strength"].default_value = 3.0
    assert len(bpy.data.node_groups) == 3 and len(surface.animation_data.drivers) == 1
    pixels = faces.seen(scene, tmp_path, len(NORMALS), "cycles")
    np.testing.assert_allclose(pixels, 3.0 * expected(), rtol=CYCLES)


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_smooth_shading(scene, tmp_path, engine):
    put_mesh(scene, "primitive_uv_sphere_add")
    mesh = bpy.context.object.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    pixels = faces.picture(scene, tmp_path, engine)
    at = (np.arange(33) + 0.5) / 33 * 2 - 1
    x, y = np.meshgrid(at, -at)
    inside = x**2 + y**2 < 0.8
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)[inside]
    # 32 by 16 faces: interpolated normals are off by up to 0.01, flat ones would be by 0.1; on
    # average they must meet.
    error = np.abs(pixels[inside][:, :3] / expected(normals) - 1)
    assert error.mean() < 0.002 and error.max() < 0.02


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_both_sides_of_a_face_and_a_linked_normal(scene, tmp_path, engine):
    put_mesh(scene, "primitive_plane_add")
    bpy.context.object.rotation_euler = (np.pi, 0.0, 0.0)  # seen from behind, as Diffuse shades it
    tolerance = EEVEE if engine == "eevee" else CYCLES
    up = expected(np.array([[0.0, 0.0, 1.0]]))[0]
    pixels = faces.picture(scene, tmp_path, engine)[..., :3]
    np.testing.assert_allclose(pixels[16, 16], up, rtol=tolerance)
    tree = bpy.data.materials["Matt"].node_tree
    given = tree.nodes.new("ShaderNodeCombineXYZ")
    for socket, value in zip(given.inputs, (0.6, 0.0, 0.8), strict=True):
        socket.default_value = value
    surface = next(n for n in tree.nodes if n.type == "GROUP")
    tree.links.new(given.outputs[0], surface.inputs["Normal"])
    leaning = expected(np.array([[0.6, 0.0, 0.8]]))[0]
    assert np.abs(leaning / up - 1).max() > 0.02  # the two can be told apart
    pixels = faces.picture(scene, tmp_path, engine)[..., :3]
    np.testing.assert_allclose(pixels[16, 16], leaning, rtol=tolerance)


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_alpha(scene, tmp_path, engine):
    """A quarter of the surface over the World, which film_transparent shows as alpha 0."""
    put_mesh(scene, "primitive_plane_add")
    scene.render.film_transparent = True
    scene.eevee.taa_render_samples = scene.cycles.samples = 64
    scene.cycles.transparent_max_bounces = 8
    surface = next(n for n in bpy.data.materials["Matt"].node_tree.nodes if n.type == "GROUP")
    up = expected(np.array([[0.0, 0.0, 1.0]]))[0]
    for alpha in (0.0, 0.25, 1.0):
        surface.inputs["Alpha"].default_value = alpha
        pixels = faces.picture(scene, tmp_path, engine)
        # The mean over 625 pixels of 64 yes-or-no samples each has a spread of 0.002.
        mean = pixels[4:-4, 4:-4].reshape(-1, 4).mean(axis=0)
        np.testing.assert_allclose(mean, [*(alpha * up), alpha], atol=0.01)


COMPILES = """
import os, sys
import bpy, numpy as np
from pathlib import Path
from spectral_skylight.addon.scene.materials import rgb_comparison, spectral_material
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.tests import faces

folder = Path(sys.argv[1])
dump = folder / "shaders"
scene = faces.empty_scene()
world = faces.light(scene, folder)
material = bpy.data.materials.new("Matt")
mesh = faces.add_faces(scene, faces.directions(16)).data
mesh.materials[0] = material
spectral_material.apply(material, world, spectral_material.Surface(np.eye(3)))
light_group.set_coefficients(world, np.full((25, 3), 0.1))

def frame(name):
    before = len(os.listdir(dump))
    faces.seen(scene, folder, 16)
    print("compiled", len(os.listdir(dump)) - before, name, flush=True)

frame("first")
spectral_material.update(material, np.eye(3) * 0.3 - 0.1)
frame("matrix")
names = ("Row R", "Row G", "Sun")
rgb_comparison.keep(material, {("surface", name): (0.3, 0.2, 0.1) for name in names})
assert rgb_comparison.show(True) == 1
frame("before")
assert rgb_comparison.show(False) == 1
light_group.set_coefficients(world, np.full((49, 3), 0.1))
frame("degree")
faces.light(scene, folder, 2)
world.node_tree.nodes["Background"].inputs["Strength"].default_value = 2.0
world.node_tree.nodes["Mapping"].inputs["Rotation"].default_value = (0.1, 0.2, 0.3)
frame("strength and rotation")
second = bpy.data.materials.new("Second")
spectral_material.apply(second, world, spectral_material.Surface(np.eye(3) * 0.5))
mesh.materials.append(second)
mesh.polygons[3].material_index = 1
frame("another material")
for tree in bpy.data.node_groups:  # as made before sockets had tooltips
    for item in tree.interface.items_tree:
        item.description = ""
frame("no tooltips")
light_group.ensure(world)
assert all(item.description for tree in bpy.data.node_groups for item in tree.interface.items_tree)
frame("tooltips")
material.node_tree.nodes["Skylight Surface"].inputs["Normal"].hide_value = False
tree = material.node_tree
tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Tangent"],
               tree.nodes["Skylight Surface"].inputs["Normal"])
frame("another topology")
sys.stdout.flush()
os._exit(0)
"""


def test_values_compile_no_shader(tmp_path):
    """Mesa writes out the source of each shader that it compiles, once: none may come anew."""
    (tmp_path / "shaders").mkdir()
    done = subprocess.run(
        [sys.executable, "-c", COMPILES, str(tmp_path)],
        capture_output=True,
        text=True,
        check=True,
        env={
            **os.environ,
            "MESA_SHADER_DUMP_PATH": str(tmp_path / "shaders"),
            "MESA_SHADER_CACHE_DISABLE": "true",
        },
    )
    lines = [line.split(maxsplit=2) for line in done.stdout.splitlines()]
    counts = {words[2]: int(words[1]) for words in lines if words[:1] == ["compiled"]}
    if counts["first"] == 0:
        pytest.skip("the OpenGL driver is not Mesa, so its compiling cannot be watched")
    assert counts.pop("first") > 0 and counts.pop("another topology") > 0
    assert counts == {
        "matrix": 0,
        "before": 0,
        "degree": 0,
        "strength and rotation": 0,
        "another material": 0,
        "no tooltips": 0,
        "tooltips": 0,
    }
