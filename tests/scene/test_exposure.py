"""Sun hours and sky view of a scene: on its surfaces, as tables, and as pictures."""

import csv
import io

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene.meter.exposure import Drawing, SunTimes, exposing

TIMES = SunTimes("2025-12-21", "00:00", "24:00", "Europe/Berlin", 48.1, 11.6, minutes=15.0)


@pytest.fixture(scope="module")
def found():
    """A floor of 20 m with a wall 4 m high from west to east in its middle."""
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.mesh.primitive_plane_add(size=20)
    bpy.context.object.name = "Floor"
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 2))
    bpy.context.object.name = "Wall"
    bpy.context.object.scale = (20.0, 0.2, 4.0)
    return run(exposing(TIMES))


def row(text, name):
    return next(each for each in csv.DictReader(io.StringIO(text)) if each["object"] == name)


def test_in_winter_the_floor_north_of_the_wall_has_no_sun(found):
    middles = found.cells.corners.mean(axis=1) + found.origin
    floor = found.owner == found.owners.index("Floor")
    near = (np.abs(middles[:, 1]) < 3.0) & (np.abs(middles[:, 1]) > 0.3) & floor
    sun = found.values["sun_hours"]
    inner = near & (np.abs(middles[:, 0]) < 4.0)
    # At noon the sun stands at 18.5°: the shadow is 12 m long.
    assert sun[inner & (middles[:, 1] > 0)].max() < 2.0
    assert sun[inner & (middles[:, 1] < 0)].min() > 8.0
    view = found.values["sky_view"]
    for side in (1.0, -1.0):
        beside = near & (side * middles[:, 1] < 1.0) & (side * middles[:, 1] > 0)
        assert 0.5 < view[beside].mean() < 0.75
    corner = floor & (np.abs(middles[:, 1]) > 9.0)
    assert view[corner].min() > 0.85


def test_the_table_has_a_row_for_each_object(found):
    wall, floor = row(found.table(), "Wall"), row(found.table(), "Floor")
    assert float(floor["area_m2"]) == pytest.approx(400.0, rel=0.001)
    assert 0.0 <= float(wall["sun_hours_min"]) <= float(wall["sun_hours_mean"])
    assert float(floor["sun_hours_max"]) == pytest.approx(8.25, abs=0.3)
    # Two sides see half of the sky, less nothing; the top all of it, the bottom none.
    assert float(wall["sky_view_max"]) == 1.0 and float(wall["sky_view_min"]) == 0.0
    points = list(csv.DictReader(io.StringIO(found.points())))
    assert len(points) == len(found.cells)


def test_what_views_show_is_a_triangle_for_each_cell(found):
    drawing = Drawing(found)
    assert drawing.places.shape == (3 * len(found.cells), 3)
    assert drawing.sides("sun_hours").shape == (3 * len(found.cells), 2)
    assert drawing.scale("sky_view").high == 1.0
    assert drawing.title("sun_hours") == "Sun Hours [h]"


def test_the_command(found, tmp_path, capsys):
    file, table = tmp_path / "scene.blend", tmp_path / "sun.csv"
    bpy.ops.object.camera_add(location=(0, -30, 15), rotation=(1.1, 0, 0))
    scene = bpy.context.scene
    scene.camera = bpy.context.object
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    bpy.ops.wm.save_as_mainfile(filepath=str(file), copy=True)
    where = ["--latitude", "48.1", "--longitude", "11.6", "--timezone", "Europe/Berlin"]
    command = ["sunlight", str(file), "--date", "2025-06-21", *where, "--minutes", "30"]
    picture = tmp_path / "sun.png"
    assert cli.main([*command, "--csv", str(table), "--png", str(picture)]) == 0
    assert "sky view factor: 0." in capsys.readouterr().out
    assert row(table.read_text(), "Floor")["area_m2"] == "400"
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert cli.main([*command, "--from", "20:00", "--to", "06:00"]) == 2
    assert "--to: 06:00 is not later than 20:00" in capsys.readouterr().err


def test_polar_night_is_one_line():
    night = SunTimes("2025-12-21", "00:00", "24:00", "UTC", 80.0, 0.0)
    with pytest.raises(InputError, match=r"the sun stays 13.* below the horizon"):
        night.suns()
