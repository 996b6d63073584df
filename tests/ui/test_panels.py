"""What the panels show, drawn into a layout that records."""

import json
import pathlib

import bpy
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.ui import material_panel, panels, result
from spectral_skylight.tests.ui.stage import drawn, select

pytestmark = pytest.mark.blender


@pytest.fixture
def applied(scene, tmp_path):
    """Wall is brick."""
    bpy.ops.skylight.apply(filepath=str(tmp_path / "brick.csv"), column="brick")
    return scene


def edit(**values):
    """Change what is kept with the material Wall."""
    wall = bpy.data.materials["Wall"]
    extra = json.loads(wall[tags.MATERIAL]["extra"])
    wall[tags.MATERIAL]["extra"] = json.dumps({**extra, **values})


def test_the_sky_and_what_of_it_is_missing(applied):
    sky, numbers = drawn(panels.SKYLIGHT_PT_sky), drawn(panels.SKYLIGHT_PT_numbers)
    assert "Sky: sky.exr" in sky.text
    assert "no light is baked yet" in drawn(panels.SKYLIGHT_PT_result).text
    applied.world.skylight.occlusion = "open"
    bpy.ops.skylight.update()
    assert "open sky: no shadows but the sun's yet" in drawn(panels.SKYLIGHT_PT_result).text
    assert "the sun at" in drawn(panels.SKYLIGHT_PT_light).text
    assert "Irradiance of degree" in numbers.text
    assert "largest error" in numbers.text
    assert "Press Update" not in sky.text
    assert sky.operators == ["skylight.load_sky"]


def test_three_steps_from_top_to_bottom():
    steps = [p for p in panels.CLASSES if getattr(p, "bl_parent_id", "") == "SKYLIGHT_PT_main"]
    assert [step.bl_label for step in steps] == ["Sky", "Materials", "Result"]
    places = [panel.bl_order for panel in panels.CLASSES[1:]]
    assert places == sorted(places)


def test_a_world_without_an_HDRI(scene):
    scene.world = bpy.data.worlds.new("Grey")
    text = drawn(panels.SKYLIGHT_PT_sky).text
    assert "Sky: Grey" in text
    assert "baked once, for it" in text
    assert "open sky" not in text
    scene.world = None
    assert "has no World" in drawn(panels.SKYLIGHT_PT_sky).text
    assert not panels.SKYLIGHT_PT_numbers.poll(bpy.context)


def test_another_HDRI_asks_for_an_update(applied):
    image = applied.world.node_tree.nodes["Environment Texture"].image
    applied.world.node_tree.nodes["Environment Texture"].image = image.copy()
    assert "Press Update" in drawn(panels.SKYLIGHT_PT_sky).text


PANELS_OF_A_MATERIAL = [panels.SKYLIGHT_PT_material, material_panel.SKYLIGHT_PT_material_properties]


@pytest.mark.parametrize("panel", PANELS_OF_A_MATERIAL)
def test_a_spectral_material(applied, panel):
    shown = drawn(panel)
    found = spectral_material.managed(bpy.data.materials["Wall"]).details.result
    rgb, spectral = found.rgb_delta_E, found.matrix_delta_E
    assert f"Mean error: ΔE {rgb:.1f} with RGB × RGB, {spectral:.1f} spectral" in shown.text
    assert "brick" in shown.text
    assert "Out of gamut" not in shown.text
    assert shown.properties == ["kind", "filepath", "column", "unit", "behind", "swatch"]
    assert {"skylight.apply", "skylight.remove"} <= set(shown.operators)


@pytest.mark.parametrize("panel", PANELS_OF_A_MATERIAL)
def test_a_material_before_anything_was_chosen(scene, panel):
    shown = drawn(panel)
    assert shown.properties == ["kind", "filepath"]
    assert "skylight.choose_reflectance" in shown.operators
    assert "skylight.apply" not in shown.operators
    assert "skylight.remove" not in shown.operators


def test_no_material(scene):
    select()
    assert "Select an object with a material" in drawn(panels.SKYLIGHT_PT_material).text
    assert not material_panel.SKYLIGHT_PT_material_properties.poll(bpy.context)


def test_warnings_of_a_material(applied):
    edit(out_of_gamut=True, colour=[-0.5, 2.0, 4.0], white=1.0, rgb_delta_E=float("nan"))
    text = drawn(panels.SKYLIGHT_PT_material).text
    assert "Out of gamut: Blender clamps it" in text
    assert "Brighter than white. The swatch shows 25 % of it" in text
    assert "Error unknown: the sky is dark" in text
    bpy.data.materials["Wall"].skylight.column = "moss"
    assert "moss is not applied yet" in drawn(panels.SKYLIGHT_PT_material).text
    applied.world = applied.world.copy()
    assert "not by this scene's. Press Update" in drawn(panels.SKYLIGHT_PT_material).text


def test_a_file_that_cannot_be_read(scene):
    bpy.data.materials["Wall"].skylight.filepath = "/nowhere.csv"
    shown = drawn(panels.SKYLIGHT_PT_material)
    assert "nowhere.csv" in shown.text
    assert "column" not in shown.properties


def test_a_linked_material_says_so(scene, tmp_path):
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {bpy.data.materials["Wall"]}, fake_user=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.materials = ["Wall"]
    bpy.data.objects["Wall"].data.materials[0] = wanted.materials[0]
    shown = drawn(panels.SKYLIGHT_PT_material)
    assert "is linked from" in shown.text
    assert shown.operators == []


def test_the_table_of_all(applied, monkeypatch):
    assert "Wall: brick" in drawn(panels.SKYLIGHT_PT_all).text
    bpy.data.materials["Wall"].copy()  # a copy is spectral too
    monkeypatch.setattr(result, "ROWS", 1)
    assert "and 1 more" in drawn(panels.SKYLIGHT_PT_all).text
    bpy.ops.skylight.remove_all()
    assert "No material is spectral yet" in drawn(panels.SKYLIGHT_PT_all).text


def test_sky_numbers(applied):
    shown = ["basis", "sun_told", "camera", "white_balanced"]
    assert drawn(panels.SKYLIGHT_PT_numbers).properties == shown
    applied.world.skylight.white_balanced = True
    assert "white" in drawn(panels.SKYLIGHT_PT_numbers).properties


def test_drawing_opens_no_file(applied, monkeypatch):
    def refuse(*arguments, **options):
        raise AssertionError("draw() opens a file")

    monkeypatch.setattr(pathlib.Path, "open", refuse)
    monkeypatch.setattr("builtins.open", refuse)
    for panel in (*panels.CLASSES, *material_panel.CLASSES):
        drawn(panel)


def test_every_operator_in_a_panel_exists(applied):
    for panel in (*panels.CLASSES, *material_panel.CLASSES):
        for identifier in drawn(panel).operators:
            assert getattr(bpy.ops.skylight, identifier.split(".")[1]).get_rna_type()
