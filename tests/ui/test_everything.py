"""One click: what is measured, what is estimated, what is left alone, and all told."""

import json

import bpy
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.transfer.assignment import ESTIMATED
from spectral_skylight.addon.ui import panels
from spectral_skylight.tests.ui.stage import drawn, given, material

pytestmark = pytest.mark.blender


@pytest.fixture
def lamp(scene):
    """A third cube, whose material shines."""
    shining = bpy.data.materials.new("Sign")
    if bpy.app.version < (5, 0, 0):
        shining.use_nodes = True
    shader = shining.node_tree.nodes["Principled BSDF"]
    shader.inputs["Emission Color"].default_value = (1, 0, 0, 1)
    shader.inputs["Emission Strength"].default_value = 5.0
    bpy.data.objects["Roof"].data.materials.append(shining)
    return shining


def test_one_click(scene, brick, lamp, capfd):
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="moss")
    material("Roof").node_tree.nodes["Principled BSDF"].inputs[0].default_value = (0.6, 0.2, 0.1, 1)
    assert bpy.ops.skylight.make_spectral() == {"FINISHED"}
    assert (given("Wall"), given("Roof")) == ("moss", ESTIMATED)
    assert not spectral_material.is_managed(lamp)
    assert use_cases.left_alone(scene) == [("Sign", "emits light")]
    said = capfd.readouterr().out
    assert "2 material(s) spectral, 1 of them estimated; 1 left alone" in said
    assert "Left alone: Sign: emits light" in said
    assert "1 measured, 1 estimated" in drawn(panels.SKYLIGHT_PT_main).text
    assert "Sign: emits light" in drawn(panels.SKYLIGHT_PT_all).text
    table = drawn(panels.SKYLIGHT_PT_all)
    names = {o["text"]: o["icon"] for kind, _, o in table.drawn if kind == "label" and "icon" in o}
    assert (names["Wall: moss"], names["Roof"]) == ("NONE", "QUESTION")  # of what is estimated
    # A second click changes nothing; a new base colour is what the estimate follows.
    before = spectral_material.managed(material("Roof")).matrix
    bpy.ops.skylight.make_spectral()
    assert spectral_material.managed(material("Roof")).matrix == before
    material("Roof").node_tree.nodes["Principled BSDF"].inputs[0].default_value = (0.1, 0.2, 0.6, 1)
    bpy.ops.skylight.make_spectral()
    assert spectral_material.managed(material("Roof")).matrix != before
    assert given("Wall") == "moss"


def test_only_what_was_measured(scene, brick, lamp):
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="moss")
    bpy.ops.skylight.make_spectral(estimate=False)
    assert (given("Wall"), given("Roof")) == ("moss", None)
    assert ("Roof", "no reflectance is chosen for it") in use_cases.left_alone(scene)


def test_a_scene_of_lamps_alone_stays_as_it_is(scene, lamp):
    for name in ("Wall", "Roof"):
        bpy.data.objects[name].data = bpy.data.meshes.new(name)
        bpy.data.objects[name].data.materials.append(lamp)
    before = len(bpy.data.objects), [t.name for t in bpy.data.node_groups]
    bpy.ops.skylight.make_spectral()
    assert use_cases.left_alone(scene) == [("Sign", "emits light")]
    assert (len(bpy.data.objects), [t.name for t in bpy.data.node_groups]) == before


def test_a_broken_file_spoils_only_its_material(scene, tmp_path, brick):
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="moss")
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="brick", material="Roof")
    broken = tmp_path / "broken.csv"
    broken.write_text("nm,moss\n400,-1\n")
    material("Wall").skylight.filepath = str(broken)
    bpy.ops.skylight.make_spectral()
    assert (given("Wall"), given("Roof")) == (None, "brick")
    ((name, why),) = use_cases.left_alone(scene)
    assert name == "Wall" and "broken.csv" in why


def test_without_a_sky_the_button_says_why(scene):
    scene.world = None
    with pytest.raises(RuntimeError, match="has no World"):
        bpy.ops.skylight.make_spectral()


def test_ended_halfway_what_is_done_is_whole(scene, lamp):
    """Esc closes the generator: materials before it are lit, those after it are untouched."""
    from spectral_skylight.addon.ui import properties

    work = use_cases.make_everything_spectral(scene, {}, properties.settings_of(scene.world))
    for progress in work:
        if progress.line == "Roof":
            break
    work.close()
    assert (given("Roof"), given("Wall")) == (ESTIMATED, None)
    assert json.loads(scene.get(tags.LEFT_ALONE, "[]")) == []
    assert "the sun" in drawn(panels.SKYLIGHT_PT_light).text
    bpy.ops.skylight.remove_all()
    work = use_cases.make_everything_spectral(scene, {}, properties.settings_of(scene.world))
    groups = len(bpy.data.node_groups)
    next(work)
    work.close()  # before the first: nothing has changed
    assert len(bpy.data.node_groups) == groups and given("Roof") is None


def test_the_only_material_keeps_its_light_as_gloss_comes_and_goes(scene, brick):
    """Its shader is built anew then; what lights it must not leave with the old one."""
    from spectral_skylight.addon.scene.world import light_group

    bpy.ops.skylight.apply(filepath=brick, column="brick")
    lamps = sorted(obj.name for obj in scene.objects)
    before = light_group.coefficients_of(scene.world)
    for gloss in (False, True):
        scene.world.skylight.gloss = gloss
        bpy.ops.skylight.update()
        assert (light_group.coefficients_of(scene.world) == before).all() and before.any()
        assert sorted(obj.name for obj in scene.objects) == lamps
