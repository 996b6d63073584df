"""The library of reflectances in Blender: folders, list, swatches, assigning, dropping files."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.spectra import formats
from spectral_skylight.addon.spectra.reflectance import read_one
from spectral_skylight.addon.transfer.assignment import ESTIMATED
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.nearest import NAME_COUNTS
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.ui import (
    choose_reflectance,
    drop,
    library,
    library_state,
    panels,
    preferences,
    preview_cache,
    swatch_grid,
)
from spectral_skylight.tests.ui import stage
from spectral_skylight.tests.ui.stage import drawn, error_of, given, material

pytestmark = pytest.mark.blender


@pytest.fixture
def enabled(scene):
    """The add-on as if it were enabled in the preferences; gone from there at the end."""
    entry = bpy.context.preferences.addons.new()
    entry.module = preferences.ADDON
    yield preferences.of(bpy.context)
    bpy.context.preferences.addons.remove(entry)
    library_state.put(None)


@pytest.fixture
def shown(enabled, tmp_path, brick):
    """The library with the folder of brick.csv and a broken file."""
    (tmp_path / "broken.csv").write_text("nm,a\n400,high\n")
    assert bpy.ops.skylight.add_folder(directory=str(tmp_path)) == {"FINISHED"}
    own = bpy.context.window_manager.skylight_library
    for name in ("search", "category", "order"):  # which other files' tests may leave
        own.property_unset(name)
    return own


def cells():
    """The buttons of the grid: what each is called, and what it gives to which material."""
    own = bpy.context.window_manager.skylight_library
    recorder = stage.Recorder()
    grid = SimpleNamespace(layout=recorder, material=own.material)
    swatch_grid.SKYLIGHT_OT_browse_library.draw(grid, bpy.context)
    return recorder


def choose(name):
    own = bpy.context.window_manager.skylight_library
    own.active = next(k for k, row in enumerate(own.spectra) if row.name == name)


class Rows(stage.Recorder):
    """A list that is asked for its filter."""

    bitflag_filter_item = 1 << 30


def listed(own):
    """Names in the order in which the list shows them."""
    flags, places = library.SKYLIGHT_UL_library.filter_items(Rows(), bpy.context, own, "spectra")
    order = sorted(range(len(places)), key=places.__getitem__)
    return [own.spectra[k].name for k in order if flags[k]]


def test_endings_are_those_of_the_formats():
    assert choose_reflectance.ENDINGS == formats.ENDINGS
    assert drop.SKYLIGHT_FH_reflectance.bl_file_extensions.split(";") == list(formats.ENDINGS)


def test_the_preferences_belong_to_the_extension_under_whatever_name_it_runs():
    assert preferences.ADDON == "spectral_skylight"
    assert "bl_ext.user_default.x.addon.ui".removesuffix(".addon.ui") == "bl_ext.user_default.x"


def test_folders_are_shown_with_the_checkers_and_what_is_broken_told(shown, tmp_path, capfd):
    names = [row.name for row in shown.spectra]
    assert names[:2] == ["dark skin", "light skin"] and names[-2:] == ["brick", "moss"]
    (problem,) = library_state.library.problems
    assert "broken.csv:2" in problem
    panel = drawn(library.SKYLIGHT_PT_library)
    assert "skylight.assign_to_active" in panel.operators
    assert "skylight.library_problems" in panel.operators and "This sky · D65" in panel.text
    assert len(preferences.folders(bpy.context)) == 1
    bpy.ops.skylight.add_folder(directory=str(tmp_path))  # a second time it is not there twice
    assert len(preferences.folders(bpy.context)) == 1
    capfd.readouterr()
    bpy.ops.skylight.library_problems()
    assert "broken.csv:2" in capfd.readouterr().out
    assert bpy.ops.skylight.remove_folder(number=0) == {"FINISHED"}
    bpy.ops.skylight.refresh_library()
    assert [row.name for row in shown.spectra][-1] != "moss"
    assert "has no folder 7" in error_of(bpy.ops.skylight.remove_folder, number=7)
    assert "is not a folder" in error_of(
        bpy.ops.skylight.add_folder, directory=str(tmp_path / "none")
    )


def test_search_and_order_as_one_types(shown):
    shown.search = "MOS"
    assert listed(shown) == ["moss"]
    shown.search = "brick.csv"
    shown.order = "NAME"
    assert listed(shown) == ["brick", "moss"]
    shown.order = "HUE"
    assert listed(shown) == ["brick", "moss"]
    shown.search = "colorchecker neutral"
    shown.order = "LIGHTNESS"
    assert [name.split()[1] for name in listed(shown)] == ["3.5", "5", "6.5", "8"]
    shown.search = "no such thing"
    assert listed(shown) == []


def test_swatches_under_this_sky_and_under_d65(shown, scene):
    white = next(row for row in shown.spectra if row.name.startswith("white"))
    sky, d65 = np.array(white.sky), np.array(white.daylight)
    assert d65.max() - d65.min() < 0.08
    assert sky[0] < sky[1] < sky[2] < 1  # the sky of the stage is blue
    assert sky @ [0.21, 0.72, 0.07] == pytest.approx(d65 @ [0.21, 0.72, 0.07], rel=0.02)
    brick = shown.spectra[-2]
    assert brick.name == "brick" and brick.daylight[0] > 2 * brick.daylight[2]
    choose("moss")
    lit = library_state.lit_by
    bpy.ops.skylight.assign_to_active()
    assert not library_state.is_stale(bpy.context)  # it is the same sky
    scene.world = None
    assert library_state.is_stale(bpy.context)
    drawn(library.SKYLIGHT_PT_library)  # in a window this asks for what follows
    library_state.light(bpy.context)
    assert not library_state.is_stale(bpy.context)
    assert library_state.under_sky is None and library_state.lit_by != lit
    assert shown.spectra[shown.active].name == "moss"
    assert (
        tuple(white.sky) == (0, 0, 0)
        and "the World has no sky" in drawn(library.SKYLIGHT_PT_library).text
    )


def test_assigning_makes_spectral_and_refreshing_keeps_it(shown, tmp_path, capfd):
    choose("moss")
    assert bpy.ops.skylight.assign_to_active() == {"FINISHED"}
    assert given("Wall") == "moss" and given("Roof") is None
    own = material("Wall").skylight
    assert (own.column, own.problem) == ("moss", "") and own.filepath.endswith("brick.csv")
    stage.select("Roof")
    choose("blue")
    assert bpy.ops.skylight.assign_to_selected() == {"FINISHED"}
    assert given("Roof") == "blue" and material("Roof").skylight.filepath.startswith("colour:")
    before = stage.matrix("Wall")
    (tmp_path / "moved").mkdir()
    (tmp_path / "brick.csv").rename(tmp_path / "moved" / "paints.csv")
    capfd.readouterr()
    bpy.ops.skylight.refresh_library()
    assert "Wall: its file was found at" in capfd.readouterr().out
    assert own.filepath.endswith("paints.csv") and given("Wall") == "moss"
    np.testing.assert_array_equal(stage.matrix("Wall"), before)
    file = tmp_path / "moved" / "paints.csv"
    file.write_text(file.read_text().replace("0.300", "0.290"))
    bpy.ops.skylight.refresh_library()
    assert "has changed: apply it again" in capfd.readouterr().out
    np.testing.assert_array_equal(stage.matrix("Wall"), before)
    file.unlink()
    bpy.ops.skylight.refresh_library()
    assert "Wall keeps its reflectance. " in capfd.readouterr().out
    np.testing.assert_array_equal(stage.matrix("Wall"), before)
    assert bpy.ops.skylight.update() == {"FINISHED"}


def test_nothing_is_assigned_that_is_not_seen(shown):
    choose("moss")
    shown.search = "colorchecker"
    assert "skylight.assign_to_active" not in drawn(library.SKYLIGHT_PT_library).operators
    for assign in (bpy.ops.skylight.assign_to_active, bpy.ops.skylight.assign_to_selected):
        with pytest.raises(RuntimeError, match="choose a row of its list first"):
            assign()
    assert given("Wall") is None
    shown.search = "brick.csv"
    assert bpy.ops.skylight.assign_to_active() == {"FINISHED"} and given("Wall") == "moss"


def test_a_grid_of_swatches_shows_what_is_near_and_gives_what_is_pressed(enabled, scene):
    """Without the library read before; each cell is a button of its own, and none is more."""
    wall = material("Wall")
    brick = read_one("building:USGS:Brick: Building, red").values[0]
    shader = wall.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*rgb_albedo(brick), 1.0)
    library_state.put(None)
    assert bpy.ops.skylight.browse_library(material="Wall") == {"FINISHED"}
    own = bpy.context.window_manager.skylight_library
    seen = cells()
    assert seen.operators == ["skylight.apply"] * swatch_grid.ROWS * swatch_grid.COLUMNS
    assert "more: search" in seen.text
    found = library_state.found(own)
    assert library_state.library.names[found[0]] == "Brick: Building, red"
    assert not preview_cache._wanted  # all swatches were there before they were drawn
    for number in found[:3]:
        color = library_state.swatch(number)
        pixels = preview_cache.pixels(("swatch", color))
        assert pixels[:3] == pytest.approx(np.array(color) / 255.0, abs=1e-6)
    assert library_state.swatch(found[0])[0] > library_state.swatch(found[0])[2]  # brick is red
    checkers = sum(path.startswith("colour:") for path in library_state.library.paths)
    assert len({*found}) == len(found) == len(library_state.library) - checkers > 90
    own.search = "colorchecker"
    assert len(library_state.found(own)) > 20  # asked for, they are there
    own.search = "backstein"
    assert {library_state.library.classes[k] for k in library_state.found(own)} == {"Brick"}
    own.search = ""
    own.category = "Wood"
    assert {library_state.library.classes[k] for k in library_state.found(own)} == {"Wood"}
    assert "more: search" not in cells().text
    own.search = "no such thing"
    assert cells().operators == [] and "Nothing has all these words" in cells().text


def test_without_a_sky_the_choice_is_kept_ready(shown, scene):
    scene.world = None
    choose("brick")
    assert bpy.ops.skylight.assign_to_active() == {"FINISHED"}
    assert given("Wall") is None and material("Wall").skylight.column == "brick"


def test_nothing_of_the_library_lies_in_a_file(shown, tmp_path):
    path = tmp_path / "saved.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    assert b"neutral 6.5" not in path.read_bytes()


def test_an_asset_library_is_written_and_made_spectral(shown, tmp_path, brick):
    folder = tmp_path / "assets"
    folder.mkdir()
    catalogues = folder / "blender_assets.cats.txt"
    mine = "VERSION 1\n\n11111111-2222-3333-4444-555555555555:Chairs:Chairs\n"
    catalogues.write_text(mine)
    shown.search = "brick.csv"
    before = len(bpy.data.materials)
    for _ in range(2):  # twice is once
        assert bpy.ops.skylight.write_assets(directory=str(folder)) == {"FINISHED"}
    assert len(bpy.data.materials) == before
    lines = catalogues.read_text().splitlines()
    assert "Chairs:Chairs" in lines[2] and len(lines) == 4 and "Reflectances/" in lines[3]
    assert sorted(file.name for file in folder.iterdir()) == [catalogues.name, "reflectances.blend"]
    with bpy.data.libraries.load(str(folder / "reflectances.blend"), assets_only=True) as (
        has,
        get,
    ):
        assert sorted(has.materials) == ["brick", "moss"]
        get.materials = ["moss"]
    (moss,) = get.materials
    assert moss.asset_data.catalog_id == lines[3].partition(":")[0]
    assert moss.skylight.column == "moss" and moss.skylight.filepath == brick
    assert tuple(moss.preview.image_size) == (32, 32)
    left, right = (
        np.array(moss.preview.image_pixels_float).reshape(32, 32, 4)[9, x] for x in (3, 28)
    )
    assert left[2] > right[2] and right[1] > right[0]  # bluer under the sky; moss is green
    bpy.data.objects["Wall"].data.materials[0] = moss
    bpy.ops.skylight.make_spectral()
    assert given("moss") == "moss"
    shown.search = "nothing like it"
    assert "matches no reflectance" in error_of(
        bpy.ops.skylight.write_assets, directory=str(folder)
    )


def test_a_list_without_its_library_asks_for_it(enabled):
    library_state.put(None)
    assert "skylight.refresh_library" in drawn(library.SKYLIGHT_PT_library).operators
    with pytest.raises(RuntimeError, match="Show the library"):
        bpy.ops.skylight.assign_to_active()


def test_what_was_read_is_shown(shown):
    choose("brick")
    text = drawn(library.SKYLIGHT_PT_library).text
    number = library_state.chosen(bpy.context)
    assert f"Read as {library_state.library.kinds[number]}" in text and "fraction" in text


def offers():
    """The buttons that the active material's panel has for measured reflectances: name, ΔE."""
    found = drawn(panels.SKYLIGHT_PT_material).drawn
    buttons = [(arguments[0], options) for kind, arguments, options in found if kind == "operator"]
    texts = [options.get("text", "") for name, options in buttons if name == "skylight.apply"]
    return [
        (name, float(off)) for name, _, off in (text.partition("   ΔE ") for text in texts) if off
    ]


def test_an_estimate_becomes_a_measurement_in_one_click(shown, scene):
    """The nearest of the library to its base color and its name, with what choosing it changes."""
    wall = material("Wall")
    shader = wall.node_tree.nodes["Principled BSDF"]
    rgb = rgb_albedo(read_one(library_state.library.paths[-1] + ":moss").values[0])
    shader.inputs["Base Color"].default_value = (*(1.1 * rgb), 1.0)
    before = offers()  # a painted material, not spectral yet
    bpy.ops.skylight.make_spectral()
    assert given("Wall") == ESTIMATED
    (best, off), *others = offers()
    assert best == "moss" == before[0][0] and others and off <= others[0][1]
    assert off == pytest.approx(float(delta_E(rgb, 1.1 * rgb, np.ones(3))), abs=0.06)
    found = library_state.library
    second, farther = others[0]
    assert farther - off < NAME_COUNTS
    wall.name = second  # the words of its name count
    assert offers()[0] == (second, farther)
    wall.name = "Wall"
    number = found.names.index("moss")
    bpy.ops.skylight.apply(material="Wall", filepath=found.paths[number], column="moss")
    assert given("Wall") == "moss"
    np.testing.assert_allclose(spectral_material.managed(wall).values, found.values[number])
    assert offers() == []  # it is measured now


def test_without_a_library_it_is_looked_for_first(scene):
    library_state.put(None)
    assert "skylight.refresh_library" in drawn(panels.SKYLIGHT_PT_material).operators
    shader = material("Wall").node_tree.nodes["Principled BSDF"]
    shader.inputs["Transmission Weight"].default_value = 1.0  # a reflectance is none of glass
    assert "skylight.refresh_library" not in drawn(panels.SKYLIGHT_PT_material).operators
