"""What the panels show, drawn into a layout that records."""

import json
import math
import pathlib

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import registration, tags
from spectral_skylight.addon.scene import portraits
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world import hdri
from spectral_skylight.addon.ui import all_materials, material_panel, materials_box, panels, sky_box
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
    sky, numbers = drawn(panels.SKYLIGHT_PT_main), drawn(panels.SKYLIGHT_PT_numbers)
    assert "Sky: sky.exr" in sky.text
    assert "No light is baked yet" in drawn(panels.SKYLIGHT_PT_main).text
    applied.world.skylight.occlusion = "open"
    bpy.ops.skylight.update()
    assert "Open sky: no shadows but the sun's yet" in drawn(panels.SKYLIGHT_PT_main).text
    assert "the sun at" in drawn(panels.SKYLIGHT_PT_light).text
    assert "Irradiance of degree" in numbers.text
    assert "largest error" in numbers.text
    assert "has changed" not in sky.text
    assert sky.operators[0] == "skylight.load_sky" and "skylight.update" not in sky.operators


def test_what_a_measurement_would_change_most_has_its_button(scene):
    """As long as anything estimated would: what is measured, or close as it is, has no row."""
    for name, color in (("Wall", (0.1, 0.1, 0.5, 1.0)), ("Roof", (0.5, 0.5, 0.5, 1.0))):
        shader = bpy.data.materials[name].node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = color
    bpy.ops.skylight.make_spectral()
    name, change = portraits.unsure()
    assert name == "Wall" and change > materials_box.CLOSE
    panel = drawn(panels.SKYLIGHT_PT_main)
    assert f"ΔE {change:.1f} unsure: Wall" in panel.text
    assert "skylight.browse_library" in panel.operators
    bpy.ops.skylight.apply(material="Wall", filepath="building:USGS", column="Paint: Cobalt blue")
    name, change = portraits.unsure()
    assert name == "Roof" and change < materials_box.CLOSE
    assert "unsure" not in drawn(panels.SKYLIGHT_PT_main).text


def test_three_boxes_then_closed_panels_and_the_way_back():
    """All that a scene needs is one panel; nothing else is open by itself."""
    found = [cls for cls in registration.CLASSES if issubclass(cls, bpy.types.Panel)]
    below = [cls for cls in found if getattr(cls, "bl_parent_id", "") == "SKYLIGHT_PT_main"]
    below.sort(key=lambda cls: cls.bl_order)
    *closed, last = below
    assert [cls.bl_label for cls in closed] == [
        *("Selected Material", "Library of Reflectances", "All Materials"),
        *("Light Meter", "Batch", "Advanced"),
    ]
    assert all("DEFAULT_CLOSED" in cls.bl_options for cls in closed)
    assert last is panels.SKYLIGHT_PT_last and "HIDE_HEADER" in last.bl_options
    within = [cls for cls in found if getattr(cls, "bl_parent_id", "") == "SKYLIGHT_PT_advanced"]
    assert len(within) == 5 and all("DEFAULT_CLOSED" in cls.bl_options for cls in within)


def test_before_a_sky_is_chosen_only_its_box_is_lit(scene):
    scene.world = bpy.data.worlds.new("Grey")
    assert not sky_box.is_chosen(scene.world)
    assert drawn(panels.SKYLIGHT_PT_main).operators[:2] == [
        "skylight.load_sky",
        "skylight.use_world",
    ]
    bpy.ops.skylight.use_world()
    assert sky_box.is_chosen(scene.world)
    assert "skylight.use_world" not in drawn(panels.SKYLIGHT_PT_main).operators


def test_the_sky_is_turned_and_made_brighter_in_the_panel(scene):
    numbers, nodes = scene.world.skylight, scene.world.node_tree.nodes
    numbers.exposure = 1.0
    assert nodes["Background"].inputs["Strength"].default_value == pytest.approx(2.0)
    towards = hdri.in_world(hdri.sky_of(scene.world), np.array([1.0, 0.0, 0.0]))
    assert towards == pytest.approx([1.0, 0.0, 0.0])
    numbers.rotation = math.radians(90)
    assert numbers.rotation == pytest.approx(math.radians(90))
    towards = hdri.in_world(hdri.sky_of(scene.world), np.array([1.0, 0.0, 0.0]))
    assert towards == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)  # counterclockwise from above


def test_a_world_without_an_HDRI(scene):
    scene.world = bpy.data.worlds.new("Grey")
    bpy.ops.skylight.use_world()
    text = drawn(panels.SKYLIGHT_PT_main).text
    assert "Sky: Grey" in text
    assert "baked once, for it" in text
    assert "open sky" not in text
    scene.world = None
    assert "skylight.load_sky" in drawn(panels.SKYLIGHT_PT_main).operators
    assert not panels.SKYLIGHT_PT_numbers.poll(bpy.context)


def test_another_HDRI_asks_for_an_update(applied):
    image = applied.world.node_tree.nodes["Environment Texture"].image
    applied.world.node_tree.nodes["Environment Texture"].image = image.copy()
    shown = drawn(panels.SKYLIGHT_PT_main)
    assert "The sky has changed" in shown.text and "skylight.update" in shown.operators


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
    monkeypatch.setattr(all_materials, "ROWS", 1)
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
