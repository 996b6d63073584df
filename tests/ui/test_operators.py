"""Sky, choice of reflectance, update and the sky's numbers, as a script calls them."""

import re

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene import example_house
from spectral_skylight.addon.scene.materials import eligibility, spectral_material
from spectral_skylight.addon.scene.world import light_group, panorama, settings
from spectral_skylight.addon.ui import material_properties
from spectral_skylight.tests.ui.stage import (
    error_of,
    given,
    material,
    matrix,
    select,
    write_sky,
)

pytestmark = pytest.mark.blender


def test_load_sky_lights_the_scene(scene, tmp_path):
    scene.world.skylight.occlusion = "open"
    bpy.ops.skylight.load_sky(filepath=str(tmp_path / "sky.exr"))
    world = scene.world
    assert world.node_tree.nodes.get("Environment Texture").image.name == "sky.exr"
    assert "but the sun's yet" in light_group.record_of(world).caption


def test_load_sky_takes_the_spectral_materials_along(scene, brick, tmp_path):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    before = spectral_material.managed(material()).details.result.colour
    bpy.ops.skylight.load_sky(filepath=str(write_sky(tmp_path / "green.exr", turquoise=2.0)))
    managed = spectral_material.managed(material())
    assert managed.world == scene.world
    assert (
        managed.details.result.colour[1] > 1.5 * before[1]
    )  # twice the green, less some blue's part
    assert given() == "brick"


def test_load_sky_that_is_none(scene, tmp_path):
    (tmp_path / "cut.exr").write_bytes((tmp_path / "sky.exr").read_bytes()[:3000])
    assert "cut.exr" in error_of(bpy.ops.skylight.load_sky, filepath=str(tmp_path / "cut.exr"))
    assert "no such file" in error_of(bpy.ops.skylight.load_sky, filepath=str(tmp_path / "no.exr"))


def test_load_sky_with_wrong_settings(scene, tmp_path):
    scene.world.skylight.camera = "Brownie"
    other = write_sky(tmp_path / "other.exr")
    assert "Brownie" in error_of(bpy.ops.skylight.load_sky, filepath=str(other))


def test_choose_reflectance_looks_for_the_columns(scene, brick, capfd):
    bpy.ops.skylight.choose_reflectance(filepath=brick)
    choice = material().skylight
    assert "Wall: 2 column(s), choose a column" in capfd.readouterr().out
    assert material_properties._columns(choice, bpy.context, "") == ("brick", "moss")
    assert choice.column == ""  # two to choose from, none named as the material
    assert given() is None
    bpy.ops.skylight.choose_reflectance(filepath=brick, material="Roof", column="moss")
    assert material("Roof").skylight.column == "moss"


def test_choose_reflectance_finds_the_column_named_as_the_material(scene, brick):
    material().name = "moss"
    bpy.ops.skylight.choose_reflectance(filepath=brick)
    assert material("moss").skylight.column == "moss"


def test_choose_reflectance_that_is_none(scene, brick, tmp_path):
    (tmp_path / "empty.csv").write_text("")
    choose = bpy.ops.skylight.choose_reflectance
    assert "empty.csv" in error_of(choose, filepath=str(tmp_path / "empty.csv"))
    assert "no column 'slate'" in error_of(choose, filepath=brick, column="slate")
    select()
    assert "no active material" in error_of(choose, filepath=brick)


def test_a_path_that_was_typed_wrongly_says_so(scene, brick):
    choice = material().skylight
    choice.filepath = brick
    choice.filepath = "/nowhere.csv"
    assert "nowhere.csv" in choice.problem
    assert material_properties._columns(choice, bpy.context, "") == ()
    choice.filepath = brick
    assert choice.problem == ""


def test_update_follows_the_HDRI(scene, brick, tmp_path):
    with pytest.raises(RuntimeError, match="No material is spectral yet"):
        bpy.ops.skylight.update()
    scene.world.skylight.occlusion = "open"
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    (tmp_path / "brick.csv").unlink()  # the blend file knows the reflectance
    scene.world.skylight.ground = "none"  # else of a turquoise one its light is taken apart
    bpy.ops.skylight.update()
    before = light_group.coefficients_of(scene.world)
    image = bpy.data.images.load(str(write_sky(tmp_path / "no sun.exr", turquoise=2.0, sun=0)))
    scene.world.node_tree.nodes["Environment Texture"].image = image
    bpy.ops.skylight.update()
    after = light_group.coefficients_of(scene.world)
    assert after[0, 1] == pytest.approx(2 * before[0, 1], rel=0.05)  # the sun's glow is not in it
    assert light_group.record_of(scene.world).caption == "open sky: no shadows yet"
    assert given() == "brick"


def test_update_moves_materials_to_the_World_of_the_scene(scene, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    scene.world = scene.world.copy()
    bpy.ops.skylight.update()
    assert spectral_material.managed(material()).world == scene.world


def test_sky_numbers_reach_the_matrix(scene, brick):
    numbers = scene.world.skylight
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    numbers.tolerance = 0.0
    bpy.ops.skylight.update()
    first = matrix()
    numbers.basis = "daylight"
    bpy.ops.skylight.update()
    daylight = matrix()
    # Two models of skylight differ in the matrix by some per cent of its largest entry.
    assert 0.001 < abs(daylight - first).max() / abs(first).max() < 0.3
    numbers.white_balanced = True
    numbers.white = (0.8, 1.0, 1.5)
    bpy.ops.skylight.update()
    white = np.array([0.8, 1.0, 1.5])
    # D M D^-1 with D = diag(1 / white), design section 2; float32 sockets.
    assert matrix() == pytest.approx(daylight * white / white[:, None], abs=1e-6)
    numbers.white_balanced = False
    bpy.ops.skylight.update()
    assert matrix() == pytest.approx(daylight, abs=1e-7)


def test_sky_numbers_are_those_that_the_materials_were_made_with(scene, brick):
    """Whoever made them: the panel must not undo by Update what the command line set."""
    settings.store(scene.world, settings.Settings("daylight", white=(0.8, 1.0, 1.5)))
    numbers = scene.world.skylight
    assert (numbers.basis, numbers.camera) == ("daylight", "")
    assert tuple(numbers.white) == pytest.approx((0.8, 1.0, 1.5))
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    stored = settings.stored(scene.world)
    assert (stored.basis, stored.white, stored.camera) == ("daylight", (0.8, 1.0, 1.5), None)


def test_the_tolerance_chooses_the_least_model(scene, brick):
    numbers = scene.world.skylight
    assert numbers.tolerance == 0.5 and numbers.basis == "simplest"  # what a new World starts with
    numbers.tolerance = 0.02
    numbers.white_balanced = True  # by (1, 1, 1): this small sky only looks so
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    found = spectral_material.managed(material()).details.result
    assert found.model == "3x3" and found.bound > 0.0
    numbers.tolerance = 10.0
    bpy.ops.skylight.update()
    found = spectral_material.managed(material()).details.result
    assert found.model == "diagonal" and found.bound <= 10.0
    M = matrix()
    assert abs(M - np.diag(np.diag(M))).max() < 1e-6  # float32 sockets
    assert light_group.record_of(scene.world).degree <= 1
    assert "basis rayleigh" in light_group.record_of(scene.world).model


def test_a_wrong_camera_is_one_line(scene, brick):
    scene.world.skylight.camera = "Brownie"
    message = error_of(bpy.ops.skylight.apply, filepath=brick, column="brick")
    assert re.search("'Brownie' is neither a file nor a known camera", message)


def test_the_swatch_is_the_colour_under_this_sky(scene, brick, tmp_path):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    choice = material().skylight
    found = spectral_material.managed(material()).details
    upward = light_group.record_of(scene.world).upward
    assert found.white == pytest.approx(np.dot([0.2126, 0.7152, 0.0722], upward), rel=1e-3)
    colour = np.array(found.result.colour) / found.white  # white is 1, however dim the sky
    assert tuple(choice.swatch) == pytest.approx(colour, rel=1e-6)  # float32
    assert choice.swatch_scale == pytest.approx(1.0)
    choice.swatch = (1, 1, 1)  # what a person picks there changes nothing
    assert tuple(choice.swatch) == pytest.approx(colour, rel=1e-6)
    bright = write_sky(tmp_path / "bright.exr", turquoise=40.0, sun=0)
    bpy.ops.skylight.load_sky(filepath=str(bright))
    found = spectral_material.managed(material()).details
    bright = np.array(found.result.colour) / found.white
    assert tuple(choice.swatch) == pytest.approx(np.maximum(bright, 0) / max(1, *bright), rel=1e-6)


def test_solid_mode_shows_the_swatch_and_gets_its_colour_back(scene, brick):
    wall = material()
    wall.diffuse_color = (0.1, 0.2, 0.3, 0.4)
    before = tuple(wall.diffuse_color)
    for column in ("moss", "brick"):
        bpy.ops.skylight.apply(filepath=brick, column=column)
        assert tuple(wall.diffuse_color)[:3] == pytest.approx(tuple(wall.skylight.swatch))
        assert wall.diffuse_color[3] == before[3]
    bpy.ops.skylight.remove()
    assert tuple(wall.diffuse_color) == before
    bpy.ops.skylight.apply(filepath=brick, column="moss")
    wall.diffuse_color = (1, 0, 1, 1)  # what a person chose meanwhile stays
    bpy.ops.skylight.remove()
    assert tuple(wall.diffuse_color) == (1, 0, 1, 1)


def test_the_example_is_a_scene_of_its_own(scene):
    before = [obj.name for obj in scene.objects], scene.world.name
    bpy.ops.skylight.open_example()
    example = bpy.data.scenes[example_house.NAME]
    assert ([obj.name for obj in scene.objects], scene.world.name) == before
    assert all(eligibility.reason(material) == "" for material in eligibility.materials_of(example))
    assert {m.name for m in eligibility.materials_of(example)} == set(example_house.PAINTS)
    assert panorama.light_of(
        example.world, settings.Settings().sensors
    ).sun.elevation == pytest.approx(8.6, abs=1.0)
    assert example.camera is not None
