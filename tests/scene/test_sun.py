"""The HDRI's sun as a lamp: right where it shines, gone in shadow, counted once, in both."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.lights import light_linking, lighting
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.output import render as renders
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.reflectance import reflectance_hash
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.tests import exr

pytestmark = [pytest.mark.blender, pytest.mark.slow]

TURN = 0.9
"""The World's Mapping turns by this [rad]."""
UP = np.array([0.0, 0.0, 1.0])


def sky_with_sun(path, strength=8000.0):
    """A sky that is bluer above, with a sun of two pixels' radius at 40°, in the HDRI's frame."""
    towards = directions(128, 256)
    sky = 0.2 + np.clip(towards[..., 2:], 0, 1) * np.array([0.3, 0.5, 0.9])
    elevation, azimuth = math.radians(40), math.radians(25)
    sun = np.array(
        [
            math.cos(elevation) * math.cos(azimuth),
            math.cos(elevation) * math.sin(azimuth),
            math.sin(elevation),
        ]
    )
    disc = towards @ sun > math.cos(math.radians(0.6))
    write_panorama(path, sky + strength * disc[..., None] * np.array([1.0, 0.85, 0.7]))
    return sun


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """Two floors side by side, managed (left) and not, each half in the shadow of a slab."""
    folder = tmp_path_factory.mktemp("sun")
    in_hdri = sky_with_sun(folder / "sky.exr")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    world = use_cases.set_sky(scene, folder / "sky.exr", Settings())
    mapping = next(node for node in world.node_tree.nodes if node.type == "MAPPING")
    mapping.inputs["Rotation"].default_value[2] = TURN
    c, s = math.cos(-TURN), math.sin(-TURN)
    sun = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ in_hdri
    for name, x in (("Spectral", -4.0), ("Plain", 4.0)):
        bpy.ops.mesh.primitive_plane_add(size=8, location=(x, 0, 0))
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0, 0):
            material.use_nodes = True
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (1, 1, 1, 1)
        shader.inputs["Specular IOR Level"].default_value = 0.0
        bpy.context.object.data.materials.append(material)
        bpy.context.object.name = name
    # Its shadow covers y > 0 of both floors; it is so high that it hides a twentieth of the sky.
    at = Vector(sun) / sun[2] * 50.0
    bpy.ops.mesh.primitive_plane_add(size=20, location=at + Vector((0, 10, 0)))
    slab = bpy.context.object
    slab.visible_camera = False
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 16
    camera.location = (0, 0, 3)
    scene.render.resolution_x, scene.render.resolution_y = 64, 32
    scene.eevee.taa_render_samples = 16
    scene.cycles.samples, scene.cycles.use_denoising = 64, False
    scene.cycles.max_bounces = 0
    return scene, folder, sun


def make(scene, rho, **settings):
    """Make the left floor spectral with a reflectance, and return what was analysed."""
    material = bpy.data.materials["Spectral"]
    light = use_cases.make_spectral(
        scene, {material: Assignment("test", rho)}, Settings(**settings)
    ).light
    return light


def seen(scene, folder, engine):
    """The mean colours, away from penumbra: left lit, left shaded, right lit, right shaded."""
    path, _ = renders.render(scene, folder / f"{engine}.exr", engine=engine)
    pixels = exr.picture(path)[..., :3]
    boxes = [(x, y) for x in (slice(8, 24), slice(40, 56)) for y in (slice(22, 29), slice(4, 11))]
    return [pixels[y, x].reshape(-1, 3).mean(axis=0) for x, y in boxes]


def expected(light, rho, sun):
    """What a level face of a reflectance returns of sun and sky, by the room's own numbers."""
    settings = Settings()
    transfer = settings.transfer(light)
    found = lighting.find(light, transfer)
    sky = transfer.matrices(rho) @ light.faces[0]
    return sky, sky + found.sun.rgb * sun[2] * found.reflected(rho)["Sun"]


def test_lit_and_shaded_in_both_engines(scene):
    scene, folder, sun = scene
    rho = np.linspace(0.1, 0.8, 81)
    light = make(scene, rho)
    assert light.sun is not None and not light.sun.clipped
    shaded, lit = expected(light, rho, sun)
    for engine, noise in (("eevee", 0.003), ("cycles", 0.01)):
        # The polynomial leaves up to 1 % here, the sun's lamp 4e-4; Cycles adds its noise.
        found = seen(scene, folder, engine)
        np.testing.assert_allclose(found[0], lit, rtol=0.01 + noise)
        np.testing.assert_allclose(found[1], shaded, rtol=0.01 + noise)


def test_a_white_wall_beside_one_that_is_not_managed(scene):
    scene, folder, sun = scene
    light = make(scene, np.ones(81))
    # Eevee's own light of the World is a damped first-order harmonic, up to a fifth off.
    for engine, tolerance in (("eevee", 0.25), ("cycles", 0.05)):
        ours_lit, ours_shaded, plain_lit, plain_shaded = seen(scene, folder, engine)
        ours, plain = ours_lit - ours_shaded, plain_lit - plain_shaded
        np.testing.assert_allclose(ours, light.sun.irradiance * sun[2], rtol=0.01)
        # Once. The slab hides a twentieth of the sky, which only Cycles' plain wall knows.
        np.testing.assert_allclose(plain, ours, rtol=0.06)
        np.testing.assert_allclose(ours_lit, plain_lit, rtol=tolerance)


def test_removal_leaves_no_trace_and_no_sun_costs_nothing(scene):
    scene, _, _ = scene
    before = scene.world.sun_threshold, scene.world.use_sun_shadow
    make(scene, np.ones(81), sun=False)
    assert not [obj for obj in scene.objects if tags.LAMP in obj]
    objects = set(bpy.data.objects), set(bpy.data.lights), set(bpy.data.collections)
    threshold = scene.world.sun_threshold
    make(scene, np.ones(81))
    assert scene.world.sun_threshold != threshold
    material = bpy.data.materials["Spectral"]
    assert len([n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL"]) == 2
    spectral_material.remove(material)
    assert objects == (set(bpy.data.objects), set(bpy.data.lights), set(bpy.data.collections))
    assert scene.world.sun_threshold == threshold
    assert len([n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL"]) == 1
    assert before is not None


def test_mixed_objects_are_named_not_burnt(scene):
    scene, _, _ = scene
    rho = np.full(81, 0.5)
    make(scene, rho)
    floor = bpy.data.objects["Spectral"]
    assert floor.name in light_linking.find(scene).objects
    floor.data.materials.append(bpy.data.materials["Plain"])
    floor.data.polygons[0].material_index = 1
    assert any("Spectral" in line for line in lighting.refresh(scene.world))
    assert floor.name not in light_linking.find(scene).objects
    floor.data.polygons[0].material_index = 0  # a slot that no face shows harms nothing
    assert lighting.refresh(scene.world) == []
    assert floor.name in light_linking.find(scene).objects
    floor.data.materials.pop(index=1)
    assert reflectance_hash(rho)
