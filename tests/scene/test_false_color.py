"""Amounts of light on all surfaces: as meters read them, sharp at shadows, and as files."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.choices import QUANTITIES
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.meter import metered_picture, surface_light
from spectral_skylight.addon.scene.meter import places as meters
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.clear_sky import SCALE, WHITE_LUMINANCE, picture
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.tests import exr, faces
from spectral_skylight.tests.buildings import shown

pytestmark = [pytest.mark.blender, pytest.mark.slow]

SUN = 30.0
LUX = list(QUANTITIES).index("illuminance")
LUMINANCE = list(QUANTITIES).index("luminance")
SIZE = 48, 32


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A white floor with a wall that throws a shadow to the north, under an absolute sky, from
    above."""
    path = tmp_path_factory.mktemp("sky") / "sky.exr"
    rgb = picture(simulate(SUN), 256, 180.0, True, observer() * SCALE)
    write_panorama(path, rgb, {"whiteLuminance": WHITE_LUMINANCE})
    faces.empty_scene()
    shown("Floor", [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], [(0, 1, 2, 3)], None)
    shown("Wall", [(-2, 0, 0), (2, 0, 0), (2, 0, 2), (-2, 0, 2)], [(0, 1, 2, 3)], None)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Above", bpy.data.cameras.new("Above"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 9, (0, 0, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    use_cases.set_sky(scene, path, Settings())
    return scene


@pytest.fixture(scope="module")
def found(scene):
    return run(use_cases.light_on_surfaces(scene, Settings())).light


def test_what_falls_on_surfaces_is_what_meters_read_there(scene, found):
    places = [(x, y, 0.0) for x in (-3.0, 0.2, 2.6) for y in (-3.0, -1.1, 1.2, 3.7)]
    normals = [(0.0, 0.0, 1.0)] * len(places)
    read = run(use_cases.measuring(scene, Settings(), meters.single(places, normals))).readings
    above = np.add(places, (0.0, 0.0, 4.0))
    seen, far = surface_light.seen(found, above, np.tile([0.0, 0.0, -1.0], (len(places), 1)))
    assert np.allclose(far, 4.0, atol=1e-4)
    for name in ("illuminance", "melanopic"):
        mine = seen[:, list(QUANTITIES).index(name)]
        # Of 64 to 128 rays from each patch, smoothed, in the shade too, where light varies.
        assert np.abs(mine / read[name] - 1.0).max() < 0.06
        assert np.abs(mine / read[name] - 1.0).mean() < 0.02
    # What a matt surface of this reflectance sends: 0.8 gray has no material.
    assert seen[:, LUMINANCE] == pytest.approx(0.8 * seen[:, LUX] / np.pi, rel=1e-3)


def test_the_shadows_edge_is_where_the_sun_sets_it(found):
    """The wall is 2 high: its shadow reaches 2 / tan(elevation) to the north."""
    corners, amounts = found.triangles()
    floor = np.abs(corners[:, :, 2]).max(axis=1) < 1e-4
    at, lux = corners[floor].reshape(-1, 3), amounts[floor][:, 0, :, LUX].reshape(-1)
    middle = np.abs(at[:, 0]) < 1.0
    end = 2.0 / np.tan(np.radians(SUN))
    sunny = np.nanmedian(lux[middle & (at[:, 1] < -1.0)])
    cell = np.sqrt(2.0 * 64.0 / 4.0**surface_light.CUTS)  # at most, of a face of 8 x 8
    far = at[:, 1] - end
    lit = lux > 0.6 * sunny
    assert lit[middle & (far > cell)].all()
    assert not lit[middle & (at[:, 1] > 0.1) & (far < -cell)].any()
    assert len(corners) < surface_light.MOST


def test_what_is_drawn_is_in_order(scene):
    drawn = run(use_cases.light_on_surfaces(scene, Settings()))
    sides = drawn.sides("illuminance")
    assert sides.shape == (len(drawn.places), 2) and sides.min() >= -1.0
    up = np.abs(drawn.places[:, 2]) < 1e-4
    # No sun from below, where the sky's picture has lit ground.
    assert np.median(sides[up, 0]) > 3.0 * np.median(sides[up, 1])
    scale = drawn.scale("illuminance")
    assert scale.low < np.median(sides[up, 0]) < scale.high


def test_a_camera_sees_surfaces_and_no_sky(scene):
    scene.camera.rotation_euler = (np.radians(90), 0, 0)
    scene.camera.location = (0, 0.5, 0.3)
    scene.camera.data.type = "PERSP"
    bpy.context.view_layer.update()
    origins, ways = metered_picture.rays_of(scene.camera, *SIZE)
    scene.camera.location, scene.camera.rotation_euler = (0, 0, 5), (0, 0, 0)
    scene.camera.data.type = "ORTHO"
    bpy.context.view_layer.update()
    assert ways.shape == (SIZE[1], SIZE[0], 3)
    assert np.allclose(ways[:, :, 1] > 0.0, True)
    assert ways[0, 0, 2] > 0.0 > ways[-1, 0, 2] and ways[0, 0, 0] < 0.0 < ways[0, -1, 0]
    light = run(use_cases.light_on_surfaces(scene, Settings())).light
    amounts, _ = surface_light.seen(light, origins.reshape(-1, 3), ways.reshape(-1, 3))
    none = np.isnan(amounts[:, LUX]).reshape(SIZE[::-1])
    assert none[0].all() and not none[-1].any()


def test_options_of_an_amount_need_one(tmp_path, capsys):
    arguments = ["render", "scene.blend", "--out", str(tmp_path / "a.exr"), "--lux", "100"]
    assert cli.main(arguments) == 2
    assert "--lux" in capsys.readouterr().err


def test_a_range_is_two_numbers_that_ascend(tmp_path, capsys):
    for wrong in ("5", "9,2", "a,b", "-1,2"):
        arguments = ["render", "s.blend", "--out", str(tmp_path / "a.exr"), f"--range={wrong}"]
        assert cli.main([*arguments, "--quantity", "luminance"]) == 2
        assert "LOW" in capsys.readouterr().err


def test_luminance_is_that_of_the_rendered_picture(scene, tmp_path):
    """A surface that shines of itself, and nothing else: its radiance is known."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.device = 1, "CPU"
    material = bpy.data.materials.new("Lamp")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (0.2, 0.5, 0.1, 1.0)
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    lamp = shown("Lamp", [(-9, -9, 3), (9, -9, 3), (9, 9, 3), (-9, 9, 3)], [(0, 1, 2, 3)], None)
    lamp.data.materials.clear()
    lamp.data.materials.append(material)
    work = use_cases.picture_of_light(scene, Settings(), "luminance", scene.camera, "cycles")
    amounts, known = run(work)
    bpy.data.objects.remove(lamp)
    expected = WHITE_LUMINANCE * ([0.2, 0.5, 0.1] @ np.array([0.2126, 0.7152, 0.0722]))
    assert known.absolute
    # Rec.709's luminances to four digits; the efficacy of white as the sky's file has it.
    assert np.allclose(amounts, expected, rtol=2e-3)


def test_render_writes_lux_and_false_colors(scene, tmp_path, capsys):
    """Last, for the command opens the file."""
    places = meters.single([(-4.0, -2.5, 0.0)], [(0.0, 0.0, 1.0)])
    read = run(use_cases.measuring(scene, Settings(), places)).readings["illuminance"][0]
    blend = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
    out = tmp_path / "lux.exr"
    arguments = ["render", str(blend), "--out", str(out), "--quantity", "illuminance"]
    assert cli.main([*arguments, "--range", "0,100000"]) == 0
    assert "absolute" in capsys.readouterr().err
    lux = exr.planes(out)["Y"]
    assert lux.shape == SIZE[::-1]
    # 9 units over 48 pixels, the middle at 0.
    column, row = round(24 - 4.0 * 48 / 9 + 0.5), round(16 + 2.5 * 48 / 9 - 0.5)
    assert lux[row, column] == pytest.approx(read, rel=0.03)
    assert out.with_suffix(".png").read_bytes().startswith(b"\x89PNG")
