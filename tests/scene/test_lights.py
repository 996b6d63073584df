"""Ground, lamps, live dome and textures: the shader gives what the numbers say, in both engines."""

import math

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.lights import lighting, user_lamps
from spectral_skylight.addon.scene.materials import base_color, spectral_material
from spectral_skylight.addon.scene.output import render as renders
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.tests import exr

pytestmark = [pytest.mark.blender, pytest.mark.slow]

RHO = np.linspace(0.2, 0.7, 81)
GREEN = np.exp(-(((np.linspace(380, 780, 81) - 540) / 50) ** 2)) * 0.5 + 0.05
X = (np.arange(64) + 0.5) / 8 - 4
"""Where the pixels of a row lie on the floor."""


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """A floor 8 wide, seen from above, beside a wall 3 high that stands at x < 0; one HDRI."""
    folder = tmp_path_factory.mktemp("lights")
    towards = directions(64, 128)
    sky = 0.2 + np.clip(towards[..., 2:], 0, 1) * np.array([0.3, 0.5, 0.9])
    sky = np.where(towards[..., 2:] > 0, sky, [0.1, 0.15, 0.05])
    write_panorama(folder / "sky.exr", sky)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    use_cases.set_sky(scene, folder / "sky.exr", Settings())
    bpy.ops.mesh.primitive_plane_add(size=8)
    floor = bpy.context.object
    floor.data.materials.append(bpy.data.materials.new("Floor"))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(-0.5, 0, 1.5))
    wall = bpy.context.object
    wall.scale = (1, 40, 3)
    wall.data.materials.append(bpy.data.materials.new("Wall"))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 8, (0, 0, 8)
    scene.render.resolution_x, scene.render.resolution_y = 64, 16
    scene.eevee.taa_render_samples = 8
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    return scene, folder, floor


def shoot(stage, engine, rho=RHO, **settings):
    """What was found, and the floor's row of pixels."""
    scene, folder, _ = stage
    light = use_cases.make_spectral(
        scene, {bpy.data.materials["Floor"]: Assignment("test", rho)}, Settings(**settings)
    ).light
    path, _ = renders.render(scene, folder / f"{engine}.exr", engine=engine)
    pixels = exr.picture(path)
    return light, pixels[8, :, :3].astype(float)


def test_a_live_dome_darkens_beside_a_wall(stage):
    light, free = shoot(stage, "eevee", ground="hdri")
    transfer = Settings().transfer(light)
    # The polynomial leaves 0.5 % at a horizon as hard as this one's.
    np.testing.assert_allclose(free[50], transfer.matrices(RHO) @ light.faces[0], rtol=0.01)
    _, shaded = shoot(stage, "eevee", occlusion="dome", ground="hdri")
    assert "live" in light_group.record_of(stage[0].world).caption
    for x in (34, 40, 48, 60):
        expected = 1.0 - (1.0 - math.cos(math.atan2(3.0, X[x]))) / 2.0  # of an even sky
        # What the wall hides is darker than the zenith here, by up to a tenth of all light.
        assert shaded[x, 1] / free[x, 1] == pytest.approx(expected + 0.03, abs=0.05)
    _, cycles = shoot(stage, "cycles", occlusion="dome", ground="hdri")
    np.testing.assert_allclose(cycles[50], free[50], rtol=0.01)


@pytest.fixture
def tidy(stage):
    """Takes the user's lamps away again."""
    yield
    for obj in [o for o in stage[0].objects if o.type == "LIGHT"]:
        bpy.data.objects.remove(obj)


def test_lamps_by_two_spectra(stage, tidy):
    scene, _, _ = stage
    _, dark = shoot(stage, "eevee")
    for name, x, spectrum in (("Warm", 2.0, "2700K"), ("Tube", 3.0, "FL11")):
        light = bpy.data.lights.new(name, "POINT")
        light.energy = 100.0
        light[tags.LAMP_SPECTRUM] = spectrum
        lamp = bpy.data.objects.new(name, light)
        lamp.location = (x, 0.0, 1.0)
        scene.collection.objects.link(lamp)
    light, lit = shoot(stage, "eevee")
    assert sum(obj.get("spectral_skylight_lamp") == "twin" for obj in scene.objects) == 2
    _, cycles = shoot(stage, "cycles")
    for x in (44, 52, 60):
        expected = np.zeros(3)
        for at, name in ((2.0, "2700K"), (3.0, "FL11")):
            spectrum = user_lamps.lamp_spectrum(name)
            # A point lamp of 100 W: 100 / (4 pi^2) radiance of a white face at a distance of 1.
            irradiance = 100 / (4 * math.pi**2) / ((X[x] - at) ** 2 + 1.0) ** 1.5
            expected += irradiance * observer() @ (RHO * spectrum)
        # A lamp has a size, and Eevee's falls by 1-2 % under one.
        np.testing.assert_allclose(lit[x] - dark[x], expected, rtol=0.025)
        # Cycles takes the first lamp's reflectance for both: some per cent, in blue a seventh.
        np.testing.assert_allclose(cycles[x] - dark[x], expected, rtol=0.2)
    bpy.data.objects["Warm"].data[tags.LAMP_SPECTRUM] = "no such lamp"
    with pytest.raises(InputError, match="no such lamp"):
        shoot(stage, "eevee")
    bpy.data.objects["Warm"].hide_render = bpy.data.objects["Tube"].hide_render = True
    shoot(stage, "eevee")
    assert not any(obj.get("spectral_skylight_lamp") for obj in scene.objects)


def test_the_ground_of_the_choice(stage):
    scene, _, floor = stage
    camera = scene.camera
    floor.rotation_euler = (math.pi, 0.0, 0.0)  # a soffit, seen from below
    camera.location, camera.rotation_euler = (0, 0, -8), (math.pi, 0, 0)
    try:
        for ground, upward in (("hdri", 1.0), ("none", 0.0)):
            light, seen = shoot(stage, "eevee", ground=ground)
            found = lighting.find(light, Settings().transfer(light), ground=ground)
            down = np.array([0.1, 0.15, 0.05]) * upward
            reflected = found.reflected(RHO)["Ground"]
            # 0.004: what a polynomial of degree 6 leaves of nothing where the horizon is hard.
            np.testing.assert_allclose(seen[50], reflected * down, rtol=0.02, atol=0.004)
        light, seen = shoot(stage, "eevee", ground="modelled")  # of grey's 20 %: nothing is below
        M = Settings().transfer(light).matrices(0.2 * RHO)
        np.testing.assert_allclose(seen[50], M @ light.faces[0], rtol=0.03)
    finally:
        floor.rotation_euler = (0.0, 0.0, 0.0)
        camera.location, camera.rotation_euler = (0, 0, 8), (0, 0, 0)


def test_a_texture_carries_the_spectrum(stage):
    scene, folder, _ = stage
    material = bpy.data.materials["Floor"]
    spectral_material.remove(material)
    material.use_nodes = True
    tree = material.node_tree
    image = bpy.data.images.new("Texture", 64, 1, float_buffer=True)
    ramp = np.ones((64, 4), np.float32)
    ramp[:, :3] = np.linspace([0.1, 0.2, 0.05], [0.5, 0.4, 0.3], 64)
    image.pixels.foreach_set(ramp.ravel())
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation, node.extension = image, "Linear", "EXTEND"
    shader = tree.nodes["Principled BSDF"]
    tree.links.new(node.outputs[0], shader.inputs["Base Color"])
    # One whose every pixel is the mean: exactly the measured reflectance.
    mean = base_color.mean_colour(node.outputs[0])
    np.testing.assert_allclose(mean, ramp[:, :3].mean(axis=0), rtol=1e-5)
    light, seen = shoot(stage, "eevee", rho=GREEN, ground="hdri")
    transfer = Settings().transfer(light)
    varied = base_color.varied(material, Assignment("test", GREEN))
    np.testing.assert_allclose(mean @ varied, GREEN, atol=1e-9)
    for x in (40, 50, 60):
        rho = ramp[x, :3] @ varied
        np.testing.assert_allclose(
            seen[x], transfer.matrices(rho) @ light.faces[0], rtol=0.02, atol=1e-3
        )
    # Nobody measured it: the texture is all there is.
    use_cases.estimate(scene, [material], Settings(ground="hdri"))
    path, _ = renders.render(scene, folder / "estimated.exr", engine="eevee")
    seen = exr.picture(path)[8, :, :3]
    for x in (40, 60):
        rho = ramp[x, :3] @ base_color.basis()
        np.testing.assert_allclose(
            seen[x], transfer.matrices(rho) @ light.faces[0], rtol=0.02, atol=1e-3
        )
    spectral_material.remove(material)
    assert not bpy.data.node_groups
