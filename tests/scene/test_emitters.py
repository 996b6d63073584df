"""A room that an LED strip alone lights, against Cycles: all light of every bounce."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import patches
from spectral_skylight.addon.scene.bake.matter import optics_of
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import box, shown
from spectral_skylight.tests.lanes import newest

pytestmark = [pytest.mark.blender, pytest.mark.slow]

BAKED = Settings(occlusion="baked")
RHO, RADIANCE = 0.5, 4000.0
SIZE = 16, 12
SAMPLES = 1024
"""Of Cycles, whose pixels are off by some percent then: what the strip lights, lights in turn."""


def of(name, kind, **values):
    """An unmanaged material of one shader."""
    material = bpy.data.materials.new(name)
    nodes.use(material)
    tree = material.node_tree
    tree.nodes.clear()
    shader = groups.add(tree, f"ShaderNode{kind}")
    for key, value in values.items():
        shader.inputs[key].default_value = value
    groups.add(tree, "ShaderNodeOutputMaterial", shader.outputs[0])
    return material


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    """A closed room 4 m by 3 m with a block on its floor, and under its ceiling a strip of 1.5 m by
    1 cm, which shines to either side."""
    folder = tmp_path_factory.mktemp("strip")
    scene = faces.empty_scene()
    write_panorama(folder / "sky.exr", np.full((16, 32, 3), 1.0, np.float32))
    paint = of("Paint", "BsdfDiffuse", Color=(RHO, RHO, RHO, 1.0))
    walls = box("Room", (0, 0, 1.25), (4, 3, 2.5), paint)
    walls.data.flip_normals()
    box("Block", (0.6, 0.3, 0.4), (0.8, 0.8, 0.8), paint)
    ends = [(-0.75, -0.505, 1.9), (-0.75, -0.495, 1.9), (0.75, -0.495, 1.9), (0.75, -0.505, 1.9)]
    shown("Strip", ends, [(0, 1, 2, 3)], of("Strip", "Emission", Strength=RADIANCE))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location, camera.rotation_euler = (-1.8, -1.3, 1.6), (1.2, 0.0, -1.0)
    camera.data.lens = 18
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 8
    world = use_cases.set_sky(scene, folder / "sky.exr", BAKED)
    # By which a bake is multiplied: the strip shines all the same.
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    return scene, folder


@newest
def test_a_room_lit_by_a_strip(room, monkeypatch):
    scene, folder = room
    scene.cycles.samples = SAMPLES
    true = faces.picture(scene, folder, "cycles")[..., :3].mean(axis=2)
    monkeypatch.setattr(patches, "PATCHES", (500, 2000))  # a room of a few faces needs no more
    grey = Assignment("Grey", np.full(WAVELENGTHS.size, RHO))
    use_cases.make_spectral(scene, {bpy.data.materials["Paint"]: grey}, BAKED)
    run(use_cases.bake(scene, BAKED, rays=64, tolerance=1.0))
    scene.cycles.samples = 16
    ours = faces.picture(scene, folder, "cycles")[..., :3].mean(axis=2)
    # Pixels that show the strip are as bright as it is, and so many times the room.
    room_only = np.maximum(true, ours) < 5.0 * np.median(true)
    assert room_only.mean() > 0.9
    off = (ours / true - 1.0)[room_only]
    # Eight bounces at a half leave out 0.4 %. Half of what single pixels are off by is Cycles' own;
    # rays that find the strip by chance leave 38 %.
    assert abs(off.mean()) < 0.015
    assert np.abs(off).mean() < 0.06


def test_what_lets_light_pass_shines_by_the_part_that_does_not():
    """Rays stop at a mix with a transparent shader by chance: what they meet then is all of it."""
    faces.empty_scene()
    shares = {}
    for factor in (0.25, 1.0):
        material = of("Half", "Emission", Strength=2.0)
        tree = material.node_tree
        emission, output = tree.nodes
        clear = groups.add(tree, "ShaderNodeBsdfTransparent")
        mix = groups.add(tree, "ShaderNodeMixShader", factor, clear.outputs[0], emission.outputs[0])
        tree.links.new(mix.outputs[0], output.inputs[0])
        optics = optics_of(material, transfer())
        assert optics.opacity == pytest.approx(factor)
        shares[factor] = optics.emission
    np.testing.assert_allclose(shares[0.25], shares[1.0], rtol=1e-6)
    assert shares[1.0].max() > 0.0
