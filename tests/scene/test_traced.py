"""Light that Cycles traces by itself, with the color of each material in the light on it."""

import math
from dataclasses import replace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import out_of_date, use_cases
from spectral_skylight.addon.scene.bake import scene_bake, traced_colors
from spectral_skylight.addon.scene.day import animate
from spectral_skylight.addon.scene.explain import explain
from spectral_skylight.addon.scene.lights import lighting as lights
from spectral_skylight.addon.scene.lights import rendered_lamps, sun_lamp, user_lamps
from spectral_skylight.addon.scene.materials import rgb_comparison, spectral_material
from spectral_skylight.addon.scene.output import render as renderer
from spectral_skylight.addon.scene.use_cases import light as lighting
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.scene.world.simulated_sky import SkyPlace
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.assignment import Assignment
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.transfer.prefilter import prefiltered
from spectral_skylight.node_groups import light_probe, skylight_surface
from spectral_skylight.tests import faces
from spectral_skylight.tests.lanes import newest

pytestmark = pytest.mark.blender

GREEN = np.exp(-(((np.linspace(380, 780, 81) - 540) / 60) ** 2)) * 0.4 + 0.15
RAMP = np.linspace(0.2, 0.9, 81)
TRACED = Settings(occlusion="traced")
BLUE_SKY, GROUND = np.array([0.3, 0.5, 0.9]), np.array([0.12, 0.12, 0.12])


@pytest.fixture
def scene(tmp_path):
    """A floor 8 wide seen from above, a quarter of its picture, under an even blue sky."""
    up = directions(32, 64)[..., 2:] > 0
    return floor_under(np.where(up, BLUE_SKY, GROUND), tmp_path)


def floor_under(sky, folder):
    """A floor of a material, 4 of its 8 m seen from above, under a sky (h, 2 h, 3)."""
    scene = faces.empty_scene()
    write_panorama(folder / "sky.exr", sky)
    use_cases.set_sky(scene, folder / "sky.exr", Settings())
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.data.materials.append(bpy.data.materials.new("Floor"))
    faces.watch(scene, (0.0, 0.0), 4.0)
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.cycles.samples = 256
    return scene


def traced(scene, folder, rho=GREEN, settings=TRACED):
    """What was found of the sky, and the mean color of the floor in Cycles."""
    material = bpy.data.materials["Floor"]
    light = use_cases.make_spectral(scene, {material: Assignment("test", rho)}, settings).light
    return light, faces.picture(scene, folder, "cycles")[..., :3].mean(axis=(0, 1))


def test_one_light_is_exact(scene, tmp_path):
    """Under one spectrum RGB × RGB by the color in it is what the matrix gives."""
    light, seen = traced(scene, tmp_path)
    M = TRACED.transfer(light).matrices(GREEN)
    # 16,384 samples of an even sky.
    np.testing.assert_allclose(seen, M @ light.faces[0], rtol=5e-3)
    today = prefiltered(GREEN, user_lamps.lamp_spectrum("D65")) * light.faces[0]
    assert np.abs(today / seen - 1.0).max() > 0.03  # which the color under D65 would miss
    assert "Cycles traces" in light_group.record_of(scene.world).caption


@newest
def test_a_lamp_lights_by_its_spectrum(scene, tmp_path):
    """A lamp of the color of its spectrum lights as that does; one of another color is told of."""
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size, lamp.location = 100.0, 0.0, (0.0, 0.0, 20.0)
    scene.collection.objects.link(lamp)
    bpy.context.view_layer.update()
    x = (np.arange(8) - 3.5) / 2.0
    aslant = ((1.0 + (x[:, None] ** 2 + x**2) / 20.0**2) ** -2.0).mean()
    # What sixteen bands tell of a spectrum of lines is not all.
    for spectrum, tolerance in (("2700K", 5e-3), ("FL11", 0.06)):
        own = user_lamps.lamp_spectrum(spectrum)
        rgb = observer() @ own
        lamp.data[tags.LAMP_SPECTRUM], lamp.data.color = spectrum, rgb / rgb.max()
        lamp.data.energy = 100.0 * rgb.max()  # a lamp's color goes up to 1
        _, seen = traced(scene, tmp_path)
        # 100 / (4 pi^2) radiance of a white face at a distance of 1.
        expected = 100 / (4 * math.pi**2) / 20.0**2 * aslant * observer() @ (GREEN * own)
        np.testing.assert_allclose(seen, expected, rtol=tolerance)
        assert "its own color" not in " ".join(light_group.record_of(scene.world).lights)
    lamp.data.color = 1.0, 1.0, 1.0
    traced(scene, tmp_path)
    assert "Lamp: Cycles traces its own color" in " ".join(
        light_group.record_of(scene.world).lights
    )


def room():
    """A closed room of one material with a lamp in it, 4 x 3 x 2.5."""
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0.0, 0.0, 40.0))
    box = bpy.context.object
    box.scale = 4.0, 3.0, 2.5
    box.data.flip_normals()
    box.data.materials.append(bpy.data.materials.new("Walls"))
    lamp = bpy.data.objects.new("Inside", bpy.data.lights.new("Inside", "POINT"))
    lamp.data.energy, lamp.location = 60.0, (0.4, 0.3, 40.2)
    lamp.data[tags.LAMP_SPECTRUM] = "3000K"
    bpy.context.scene.collection.objects.link(lamp)
    return bpy.data.materials["Walls"]


@newest
def test_colors_are_those_in_all_light(scene):
    """In a closed room of one reflectance the light on its walls is the lamp's over 1 - rho."""
    walls = room()
    scene.camera = None  # which would see the room from outside
    bpy.context.view_layer.update()
    given = {walls: Assignment("ramp", RAMP), bpy.data.materials["Floor"]: Assignment("g", GREEN)}
    use_cases.make_spectral(scene, given, TRACED)
    shining = run(lighting.shining_on(scene, TRACED))
    found = run(traced_colors.finding(shining, "Linear Rec.709"))
    expected = prefiltered(RAMP, user_lamps.lamp_spectrum("3000K") / (1.0 - RAMP))
    # Sixteen bands of a smooth spectrum; the first reflection alone would be off by 0.04.
    np.testing.assert_allclose(found["Walls"], expected, atol=5e-3)
    alone = prefiltered(RAMP, user_lamps.lamp_spectrum("3000K"))
    assert np.abs(alone - expected).max() > 0.03
    node = spectral_material.surface_node(walls)
    shown = np.array(node.inputs[skylight_surface.COLOR].default_value)
    np.testing.assert_allclose(shown, found["Walls"], atol=1e-6)


@newest
def test_the_side_that_is_seen_counts(scene):
    """A single face that is turned away has the color in the light on the side that one sees."""
    bpy.context.object.data.flip_normals()
    camera = scene.camera
    camera.data.type, camera.location = "PERSP", (0.0, 0.0, 20.0)
    bpy.context.view_layer.update()
    floor = bpy.data.materials["Floor"]
    light = use_cases.make_spectral(scene, {floor: Assignment("test", GREEN)}, TRACED).light
    shown = np.array(
        spectral_material.surface_node(floor).inputs[skylight_surface.COLOR].default_value
    )
    of_sky = TRACED.transfer(light).matrices(GREEN) @ light.faces[0] / light.faces[0]
    np.testing.assert_allclose(shown, of_sky, rtol=5e-3)  # sixteen bands
    under = TRACED.transfer(light).matrices(GREEN) @ GROUND / GROUND
    assert np.abs(under - of_sky).max() > 0.03


def test_other_light_ends_it(scene, tmp_path):
    """Under the open sky Cycles shows the matrix again; a removed material has one output."""
    own = scene.world.cycles
    before = own.sampling_method, own.sample_map_resolution
    _, seen = traced(scene, tmp_path)
    surface = skylight_surface.find(scene.world)
    assert skylight_surface.is_traced(surface)
    assert (own.sampling_method, own.sample_map_resolution) == ("MANUAL", 256)
    _, opened = traced(scene, tmp_path, settings=Settings(occlusion="open"))
    assert not skylight_surface.is_traced(surface)
    assert (own.sampling_method, own.sample_map_resolution) == before
    # By the polynomial, which leaves 0.5 % at a hard horizon.
    np.testing.assert_allclose(opened, seen, rtol=0.01)
    material = bpy.data.materials["Floor"]
    traced(scene, tmp_path)
    spectral_material.remove(material)
    assert (own.sampling_method, own.sample_map_resolution) == before
    assert sum(node.type == "OUTPUT_MATERIAL" for node in material.node_tree.nodes) == 1


@newest
def test_a_clipped_sun_is_as_strong_as_estimated(tmp_path):
    """The lamp adds what the HDRI's disc has lost."""
    towards = directions(256, 512)
    sky = np.where(towards[..., 2:] > 0, BLUE_SKY, GROUND)
    sun = np.array([math.cos(0.9), 0.0, math.sin(0.9)])
    sky = np.where((towards @ sun > math.cos(math.radians(0.6)))[..., None], 400.0, sky)
    scene = floor_under(sky, tmp_path)
    light, seen = traced(scene, tmp_path, np.full(81, 0.5))
    assert light.sun is not None
    assert "clips" in " ".join(light_group.record_of(scene.world).lights)
    opened = traced(scene, tmp_path, np.full(81, 0.5), Settings(occlusion="open"))[1]
    assert opened.sum() > 1.5 * 0.5 * (light.faces[0] + light.sun.irradiance * sun[2]).sum()
    # What Cycles finds of a disc of some pixels, by chance.
    np.testing.assert_allclose(seen, opened, rtol=0.03)
    raw = replace(TRACED, camera="Nikon 5100 (NPL)")
    use_cases.set_sky(scene, tmp_path / "sky.exr", raw)
    given = {bpy.data.materials["Floor"]: Assignment("test", np.full(81, 0.5))}
    light = use_cases.make_spectral(scene, given, raw).light
    tree = sun_lamp.find(scene, sun_lamp.SUN).data.node_tree
    whole, lacking = (
        np.array(node.inputs["Color"].default_value)[:3]
        for node in tree.nodes
        if node.type == "EMISSION"
    )
    shown = np.pi * raw.transfer(light).to_working @ light.sun.irradiance
    probe = light_probe.STRENGTH * np.array([1.0, sun_lamp.FAINT, sun_lamp.FAINT])
    # Float32 of a difference.
    there = (whole / light_probe.CYCLES_STRENGTH - lacking) * probe
    np.testing.assert_allclose(there, shown, rtol=1e-3)


@newest
def test_cycles_traces_until_light_is_baked(scene, tmp_path):
    """In a scene that Cycles renders, a first light is there at once; the baked one takes over."""
    bpy.ops.mesh.primitive_cube_add(size=2, location=(0.0, 3.0, 1.0))
    bpy.context.object.data.materials.append(bpy.data.materials["Floor"])
    bpy.context.view_layer.update()
    scene.cycles.max_bounces = 8
    _, opened = traced(scene, tmp_path, settings=Settings(occlusion="open"))
    scene.render.engine = "CYCLES"
    surface = skylight_surface.find(scene.world)
    _, seen = traced(scene, tmp_path, settings=Settings())
    assert skylight_surface.is_traced(surface)
    assert "Cycles traces" in out_of_date.caption(scene)
    assert np.all(seen < 0.97 * opened)  # the cube hides some of the sky
    run(lighting.bake(scene, Settings()))
    assert not skylight_surface.is_traced(surface)
    assert "all light is baked" in out_of_date.caption(scene)
    baked = faces.picture(scene, tmp_path, "cycles")[..., :3].mean(axis=(0, 1))
    # In red, of which the paint has little, RGB × RGB is 0.4 % of the light off after a reflection.
    np.testing.assert_allclose(baked, seen, rtol=0.01, atol=1e-3)
    traced(scene, tmp_path, settings=Settings())
    assert not skylight_surface.is_traced(surface)  # another paint does not bring it back
    scene_bake.remove()
    assert out_of_date.caption(scene) == out_of_date.NOT_BAKED


@newest
def test_a_day_is_not_traced(scene):
    """Until all light of a day is baked its plans show the open sky, for colors do not move."""
    scene.render.engine = "CYCLES"
    given = {bpy.data.materials["Floor"]: Assignment("test", GREEN)}
    place = SkyPlace("2025-06-21", "10:30", "Europe/Berlin", 48.1, 11.6)
    found = run(animate.computing(scene, scene.world, place, 40.0, given, Settings()))
    assert found.plan.lights.occlusion == "baked"
    assert not found.plan.lights.traced


@newest
def test_the_open_scene_counts_of_two_under_one_world(scene):
    """Another one, that no window has shown yet, renders with Eevee and has a lamp."""
    other = bpy.data.scenes.new("A")
    other.world, other.render.engine = scene.world, renderer.engine_id("eevee")
    other.collection.objects.link(bpy.data.objects.new("Lamp", bpy.data.lights.new("L", "POINT")))
    assert lights.scenes_of(scene.world)[0] == other
    assert [one.name for one in rendered_lamps.of_scene(other)] == ["Lamp"]
    scene.render.engine = "CYCLES"
    given = {bpy.data.materials["Floor"]: Assignment("test", GREEN)}
    use_cases.make_spectral(scene, given, Settings())
    assert lights.is_traced(scene.world)
    assert not any(obj.get(tags.LAMP) == user_lamps.TWIN for obj in scene.objects)


@newest
def test_it_waits_only_for_the_same_light(scene):
    """Where Cycles would trace another light than what is to be baked, it shows the open sky; what
    follows a change has its colors again; a bake for another light does not end what is asked."""
    scene.render.engine = "CYCLES"
    floor, given = bpy.data.materials["Floor"], Assignment("test", GREEN)
    use_cases.make_spectral(scene, {floor: given}, Settings(ground="none"))
    surface = skylight_surface.find(scene.world)
    assert not skylight_surface.is_traced(surface)
    use_cases.make_spectral(scene, {floor: given}, Settings())
    assert skylight_surface.is_traced(surface)
    node = spectral_material.surface_node(floor)
    color = np.array(node.inputs[skylight_surface.COLOR].default_value)
    work = lighting.following(scene, Settings())
    while "about" not in next(work).line:  # until the bake begins
        pass
    work.close()
    assert skylight_surface.is_traced(surface)
    again = node.inputs[skylight_surface.COLOR].default_value
    np.testing.assert_allclose(again, color, rtol=1e-6)
    use_cases.make_spectral(scene, {floor: given}, TRACED)
    lights.show_baked(scene.world)  # as each bake does
    assert skylight_surface.is_traced(surface)


def test_a_sun_switched_off_shines_in_cycles(scene, tmp_path):
    """Cycles traces the HDRI with sun and ground: so do the colors, and that is said."""
    towards = directions(256, 512)
    sky = np.where(towards[..., 2:] > 0, BLUE_SKY, GROUND)
    sun = np.array([math.cos(0.6), 0.0, math.sin(0.6)])
    low = np.array([9.0, 5.0, 1.5]) * 2e3
    sky = np.where((towards @ sun > math.cos(math.radians(0.6)))[..., None], low, sky)
    write_panorama(tmp_path / "sunny.exr", sky)
    use_cases.set_sky(scene, tmp_path / "sunny.exr", Settings())
    floor, given = bpy.data.materials["Floor"], Assignment("test", GREEN)
    found = []
    for on in (True, False):
        ground = "auto" if on else "modelled"  # of which Cycles knows nothing either
        settings = Settings(occlusion="traced", sun=on, ground=ground)
        use_cases.make_spectral(scene, {floor: given}, settings)
        node = spectral_material.surface_node(floor)
        found.append(np.array(node.inputs[skylight_surface.COLOR].default_value))
        assert ("shines in Cycles all the same" in out_of_date.caption(scene)) is not on
        warnings = " ".join(light_group.record_of(scene.world).warnings)
        assert ("not that of the chosen ground" in warnings) is not on
    np.testing.assert_allclose(*found, rtol=1e-5)


@newest
def test_rgb_beside_it_has_the_color_under_D65(scene, tmp_path):
    """Today's way in traced light: the color under D65 times the sky's."""
    light, _ = traced(scene, tmp_path)
    found = explain(scene, bpy.data.materials["Floor"])
    assert "Color in traced light" in {step.name for step in found.steps}
    assert not any("press Update" in line for line in found.suspicious), found.suspicious
    rgb_comparison.show(rgb_comparison.RGB)
    seen = faces.picture(scene, tmp_path, "cycles")[..., :3].mean(axis=(0, 1))
    np.testing.assert_allclose(seen, rgb_albedo(GREEN) * light.faces[0], rtol=5e-3)
