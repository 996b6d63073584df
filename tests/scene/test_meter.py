"""The meter in scenes: absolute in the open, calibrated, in rooms, and what cannot be measured."""

import csv
import io
import json

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import patches
from spectral_skylight.addon.scene.meter import places as meters
from spectral_skylight.addon.scene.meter import room_page
from spectral_skylight.addon.scene.meter.calibration import Told, keep_lux, kept_lux
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.clear_sky import SCALE, WHITE_LUMINANCE, picture
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.colour_temperature import cct_and_duv
from spectral_skylight.addon.spectra.grid import WEIGHTS
from spectral_skylight.addon.spectra.photometry import quantity
from spectral_skylight.addon.spectra.sensitivities import cmfs, observer
from spectral_skylight.tests import faces
from spectral_skylight.tests.buildings import shown
from spectral_skylight.tests.lanes import newest
from spectral_skylight.tests.transport import test_meter as closed_forms

pytestmark = [pytest.mark.blender, pytest.mark.slow]

SUN = 40.0


@pytest.fixture(scope="module", autouse=True)
def coarse_patches():
    """Scenes of a few faces need no more; what is compared comes straight from the sky and sun."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(patches, "PATCHES", (500, 2000))
        yield


@pytest.fixture(scope="module")
def sky():
    return simulate(SUN)


@pytest.fixture(scope="module")
def hdri(sky, tmp_path_factory):
    """The sky with its sun, absolute, as `sky` writes it; and one that does not say its unit."""
    folder = tmp_path_factory.mktemp("skies")
    rgb = picture(sky, 256, 180.0, True, observer() * SCALE)
    for name, attributes in (("said", {"whiteLuminance": WHITE_LUMINANCE}), ("unsaid", {})):
        write_panorama(folder / f"{name}.exr", rgb, attributes)
    return folder


def scene_under(path):
    """A scene under a sky with a gray floor whose room has a wall to the north."""
    faces.empty_scene()
    shown("Floor", [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)], [(0, 1, 2, 3)], None)
    use_cases.set_sky(bpy.context.scene, path, Settings())
    return bpy.context.scene


def measured(scene, at, normal=(0, 0, 1), told=None):
    places = meters.single([at], [normal])
    return run(use_cases.measuring(scene, Settings(), places, told))


@pytest.fixture(scope="module")
def outdoors(hdri):
    """What a meter a meter over the floor reads, twice: relative, and absolute."""
    relative = measured(scene_under(hdri / "unsaid.exr"), (0, 0, 1))
    return relative, measured(scene_under(hdri / "said.exr"), (0, 0, 1))


def test_in_the_open_it_reads_the_simulations_own_watts(sky, outdoors):
    """All spectral: nothing of HDRI, basis or bands is in the truth."""
    truth = sky.irradiance() + sky.direct * np.sin(np.radians(SUN))
    found = outdoors[1].readings
    # 2 % and 100 K are asked for; half is the picture's pixels and the sun's estimate.
    for name in ("illuminance", "melanopic", "s-cone-opic"):
        assert found[name][0] == pytest.approx(quantity(name).row @ truth, rel=0.01)
    T, _ = cct_and_duv(cmfs() * WEIGHTS @ truth)
    assert found.temperature[0][0] == pytest.approx(T, abs=50.0)
    seen = found.irradiance[0]
    assert np.abs(seen - truth).max() < 0.03 * truth.max()


def test_without_a_unit_it_says_relative(outdoors):
    relative, absolute = outdoors
    assert not relative.calibration.absolute and absolute.calibration.absolute
    assert relative.lines()[0].startswith("Light: relative")
    assert not any(" lx" in line for line in relative.lines()[1:])
    assert set(relative.plain()["units"].values()) == {"relative"}
    heads = [room_page.table(each).partition("\n")[0] for each in outdoors]
    assert "illuminance_relative" in heads[0] and "_lx" not in heads[0]
    assert "illuminance_lx" in heads[1] and "relative" not in heads[1]
    scale = WHITE_LUMINANCE
    assert absolute.readings["illuminance"][0] == pytest.approx(
        scale * relative.readings["illuminance"][0], rel=1e-3
    )


@newest
def test_one_measured_value_makes_it_absolute(hdri, sky):
    scene = scene_under(hdri / "unsaid.exr")
    assert measured(scene, (0, 0, 1), told=Told(lux=54_321.0)).readings["illuminance"][
        0
    ] == pytest.approx(54_321.0, rel=2e-3)  # nothing stands around: the level in the open
    zenith = quantity("luminance").row @ sky.radiance(np.radians(88.0), np.radians(180.0))
    spot = measured(scene, (0, 0, 1), told=Told(spot=(zenith, 0.0, 88.0)))
    truth = sky.irradiance() + sky.direct * np.sin(np.radians(SUN))
    lux = quantity("illuminance").row @ truth
    assert spot.readings["illuminance"][0] == pytest.approx(lux, rel=0.03)  # one cell's luminance
    for wrong in (Told(lux=-1.0), Told(spot=(0.0, 0, 45)), Told(white_luminance=float("nan"))):
        with pytest.raises(InputError, match="give a number above 0"):
            measured(scene, (0, 0, 1), told=wrong)
    keep_lux(scene.world, 10_000.0)
    assert kept_lux(scene.world) == 10_000.0
    assert measured(scene, (0, 0, 1)).readings["illuminance"][0] == pytest.approx(1e4, rel=2e-3)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5
    assert measured(scene, (0, 0, 1)).readings["illuminance"][0] == pytest.approx(1e4, rel=2e-3)
    keep_lux(scene.world, 0.0)
    assert kept_lux(scene.world) is None


@newest
def test_it_looks_where_it_is_turned(hdri, sky):
    """A wall in the sun's way shades it; as a luminance meter it sees the sky and the floor."""
    scene = scene_under(hdri / "said.exr")
    shown("Wall", [(-4, -1, 0), (4, -1, 0), (4, -1, 4), (-4, -1, 4)], [(3, 2, 1, 0)], None)
    some = meters.single(
        [(0, 0, 1), (0, 0, 1), (0, -3, 1), (0, -3, 0.001)],
        [(0, 0, 1), (0, 0, 2), (0, 0, -1), (0, 0, 1)],
    )
    found = run(use_cases.measuring(scene, Settings(), some)).readings
    truth = quantity("illuminance").row @ sky.irradiance()
    assert 0.2 * truth < found["illuminance"][0] < truth  # no sun, and half of the sky
    zenith = quantity("luminance").row @ sky.radiance(np.pi / 2, 0.0)
    assert found["luminance"][0] == pytest.approx(zenith, rel=0.03)
    np.testing.assert_allclose(found.irradiance[1], found.irradiance[0])
    # What has no material reflects 0.8.
    floor = 0.8 * found["illuminance"][3] / np.pi
    assert found["luminance"][2] == pytest.approx(floor, rel=0.02)  # of its cells' means
    inside = box_around((0, 0, 1))
    assert measured(scene, (0, 0, 1)).inside[0]
    bpy.data.objects.remove(inside)


def box_around(place):
    from spectral_skylight.tests.buildings import box

    return box("Solid", place, (0.5, 0.5, 0.5), None)


def test_grids_and_eyes():
    faces.empty_scene()
    floor = shown("Floor", [(0, 0, 1), (6, 0, 1), (6, 4, 1), (0, 4, 1)], [(0, 1, 2, 3)], None)
    grid = meters.over(floor)
    # EN 12464-1: d = 6 m, p = 0.2 * 5^log10(6) = 0.70 m: 9 by 6 points, of which the outer ring,
    # nearer than 0.5 m, is left out.
    assert grid.shape == (6, 9) and len(grid) == 4 * 7
    np.testing.assert_allclose(grid.points[:, 2], 1.85)
    assert grid.points[:, 0].min() >= 0.5 and grid.points[:, 1].max() <= 3.5
    in_mm = meters.over(floor, spacing=0.002, border=0.0005, meter=1000.0)
    assert in_mm.shape == (2, 3) and in_mm.points[0, 2] == pytest.approx(851.0)
    with pytest.raises(InputError, match="has no faces that look up"):
        meters.over(shown("Ceiling", [(0, 0, 3), (6, 0, 3), (6, 4, 3)], [(2, 1, 0)], None))
    with pytest.raises(InputError, match="is smaller than its border"):
        meters.over(floor, border=3.0)
    with pytest.raises(InputError, match="at most 20,000"):
        meters.over(floor, spacing=0.001)
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    bpy.context.scene.collection.objects.link(camera)
    camera.location, camera.rotation_euler = (1, 2, 1.6), (1.2, 0, 0)
    bpy.context.view_layer.update()
    eye = meters.eye(camera)
    np.testing.assert_allclose(eye.points, [(1, 2, 1.6)], atol=1e-6)
    np.testing.assert_allclose(eye.normals, [(0, 1, 0)], atol=1e-6)  # upright, though it looks down
    with pytest.raises(InputError, match="there is no camera 'Nobody'; there are 'Eye'"):
        meters.camera(bpy.context.scene, "Nobody")


def black():
    made = bpy.data.materials.new("Black")
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    shader = next(n for n in made.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    return made


@newest
def test_a_rooms_daylight_factor_is_cie_171s(hdri, tmp_path):
    """A black room with an opening in its roof, 5.9: whatever the scene's own sky."""
    scene = scene_under(hdri / "unsaid.exr")
    bpy.data.objects.remove(bpy.data.objects["Floor"])
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.data.energy, lamp.location = 1e5, (2.0, 2.0, 2.9)
    scene.collection.objects.link(lamp)
    corners = closed_forms.room(2, (1.5, 1.5), (2.5, 2.5)).reshape(-1, 3)
    faces_of = np.arange(len(corners)).reshape(-1, 3).tolist()
    shown("Room", corners.tolist(), faces_of, black())
    grid = meters.rectangle((0.0, 0.0, 4.0, 4.0), 0.0, 1.0, 1.0)
    found = run(use_cases.surveying(scene, Settings(), grid))
    opening = closed_forms.rectangle((1.5, 1.5), (2.5, 2.5), 2, 3.0)
    expected = [
        closed_forms.through(opening, at, np.array([0.0, 0.0, 1.0]), closed_forms.overcast)
        / (7 / 9)
        for at in grid.points
    ]
    np.testing.assert_allclose(found.daylight_factor, expected, rtol=0.01)
    assert (
        not found.measured.calibration.absolute and found.measured.readings["illuminance"].min() > 0
    )
    with pytest.raises(InputError, match="the sky's light is only relative"):
        run(use_cases.surveying(scene, Settings(), grid, threshold=100.0))
    mean, low, high, uniformity = found.figures(found.daylight_factor)
    assert low <= mean <= high and uniformity == pytest.approx(low / mean)
    page, table = room_page.write(tmp_path / "room.html", found, "Room <1>")
    text = page.read_text(encoding="utf-8")
    assert "<title>Room &lt;1&gt;</title>" in text and text.count("data:image/png") == 3
    assert f"{100 * mean:.1f} %" in text and "relative" in text
    rows = list(csv.DictReader(io.StringIO(table.read_text(encoding="utf-8"))))
    assert len(rows) == 16
    for row, factor in zip(rows, found.daylight_factor, strict=True):
        assert float(row["daylight_factor_percent"]) == pytest.approx(100 * factor, rel=1e-4)


def test_the_command(hdri, tmp_path, capsys):
    scene_under(hdri / "said.exr")
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    capsys.readouterr()

    def told(*options):
        code = cli.main(["measure", file, *options])
        out, error = capsys.readouterr()
        return code, out, error.strip().splitlines()

    code, out, _ = told("--at", "-1,0,1", "--json")
    found = json.loads(out)
    point = found["points"][0]
    assert code == 0 and point["at"] == [-1.0, 0.0, 1.0] and found["absolute"]
    lux = np.array(point["spectrum"]) @ quantity("illuminance").row
    assert point["illuminance"] == pytest.approx(lux) and 5000 < point["cct"] < 7000
    code, out, _ = told("--grid", "-1,-1,1,1", "--height", "1", "--spacing", "1", "--csv")
    table = list(csv.DictReader(io.StringIO(out[out.index("x,y,z") :])))
    assert code == 0 and len(table) == 4
    for row in table:
        assert float(row["illuminance_lx"]) == pytest.approx(lux, rel=0.01)
    for options, line in (
        ((), "measure: where is not told; give one of --at, --camera and --grid"),
        (("--at", "1,1", "--json"), "'1,1' is not three numbers"),
        (("--at", "1,1,1", "--normal", "0,0,0"), "--normal: has no direction"),
        (("--at", "1,1,1", "--lux", "0"), "--lux: 0; give a number above 0"),
        (("--camera",), "--camera: the scene has none; add a camera"),
        (("--grid", "Cellar"), "--grid: there is no object 'Cellar'"),
        (("--grid", "Floor", "--spacing", "-1"), "--spacing: -1 m; give a number above 0"),
        (("--grid", "0,0,1,x"), "--grid: '0,0,1,x' is not four numbers"),
        (("--camera", "--height", "2"), "--height: is of a grid"),
        (("--camera", "--report", str(tmp_path / "a.html")), "--report: is of a grid"),
        (("--grid", "Floor", "--threshold", "5"), "--threshold: is of a report"),
        (("--grid", "Floor", "--report", str(tmp_path / "a.txt")), "is no .html"),
    ):
        code, _, error = told(*options)
        assert code == 2 and line in error[-1], error
