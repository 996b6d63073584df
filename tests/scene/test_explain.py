"""Every step of a material's color is told, and each thing that spoils it is found."""

import json
import re
from pathlib import Path

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.blend_data import nodes
from spectral_skylight.addon.scene.explain import explain
from spectral_skylight.addon.scene.materials import rgb_comparison, spectral_material
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.scene.world.settings import Settings
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.addon.transfer import assignment
from spectral_skylight.tests import faces

pytestmark = pytest.mark.blender

PAGE = Path(__file__).parents[2] / "examples" / "why_is_this_color_wrong.md"
SETTINGS = Settings(basis="simplest", tolerance=0.5, white=(1.0, 1.0, 1.0))


@pytest.fixture
def scene(tmp_path):
    """A brick wall and a door, by a CSV in percent, under a sky with its sun."""
    scene = faces.empty_scene()
    scene.view_settings.view_transform = "Standard"
    rgb = faces.smooth_sky(3, 64)
    rgb[24, 50] = (9000.0, 8000.0, 6000.0)
    write_panorama(tmp_path / "sky.exr", rgb)
    rows = [f"{nm},{20 + nm / 20},{80 - nm / 20}" for nm in range(380, 781, 10)]
    (tmp_path / "paint.csv").write_text("\n".join(["nm,brick,door", *rows]))
    use_cases.set_sky(scene, tmp_path / "sky.exr", SETTINGS)
    mesh = faces.add_faces(scene, faces.directions(4)).data
    mesh.materials.clear()
    given = {}
    for name in ("Brick", "Door"):
        material = bpy.data.materials.new(name)
        nodes.use(material)
        mesh.materials.append(material)
        given[material] = assignment.read(f"{tmp_path / 'paint.csv'}:{name.lower()}")
    use_cases.make_spectral(scene, given, SETTINGS)
    return scene


def brick():
    return bpy.data.materials["Brick"]


def values(found, name):
    return next(step.values for step in found.steps if step.name == name)


def test_each_step_with_its_numbers(scene, tmp_path):
    found = explain(scene, brick())
    assert values(found, "File") == f"{tmp_path / 'paint.csv'}:brick"
    assert values(found, "Unit") == {"unit": "percent", "measured": [380.0, 780.0]}
    assert values(found, "Reflectance")[0] == pytest.approx(0.39)
    description = light_group.record_of(scene.world)
    assert values(found, "Sky") == pytest.approx(description.upward, rel=1e-6)
    assert values(found, "Sun elevation") == pytest.approx(description.rest["sun"]["elevation"])
    shown = spectral_material.managed(brick()).matrix
    np.testing.assert_allclose(values(found, "Matrix"), shown, atol=1e-6)
    # Independent of the sockets: what the file's reflectance makes of the sky that was read.
    np.testing.assert_allclose(
        values(found, "Shown color"), values(found, "Predicted color"), rtol=0.02
    )  # the polynomial may be 1 % off on a face
    assert not any("press Update" in line for line in found.suspicious), found.suspicious
    assert {step.name for step in found.steps if step.name.startswith("Socket ")} == {
        "Socket Sun",
        "Socket Ground",
    }


def spoilt(scene, tmp_path):
    """By what is done, words of what is found."""
    node = spectral_material.surface_node(brick())
    yield lambda: rgb_comparison.show(True), "shows RGB × RGB"
    rgb_comparison.show(False)
    keep = tuple(node.inputs["Row R"].default_value)
    yield (
        lambda: setattr(node.inputs["Row R"], "default_value", (1, 0, 0)),
        "sockets hold a different matrix",
    )
    node.inputs["Row R"].default_value = keep
    keep = tuple(node.inputs["Sun"].default_value)
    yield lambda: setattr(node.inputs["Sun"], "default_value", (1, 0, 0)), "socket Sun"
    node.inputs["Sun"].default_value = keep
    background = scene.world.node_tree.nodes["Background"]
    yield lambda: setattr(background.inputs["Strength"], "default_value", 0.0), "Strength is 0"
    background.inputs["Strength"].default_value = 1.0
    world = scene.world
    yield lambda: setattr(scene, "world", world.copy()), "not this scene's"
    scene.world = world
    view = scene.view_settings
    yield lambda: setattr(view, "view_transform", "AgX"), "the view changes colors"
    view.view_transform = "Standard"
    file = tmp_path / "paint.csv"
    text = file.read_text()
    yield lambda: file.write_text(text.replace("380,39", "380,49")), "has changed since"
    yield lambda: file.unlink(), "is missing"
    file.write_text(text)
    tree = brick().node_tree
    outputs = [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"]
    links = [link for output in outputs for link in output.inputs["Surface"].links]
    yield lambda: [tree.links.remove(link) for link in links], "not connected"


def test_what_spoils_a_color_is_found(scene, tmp_path):
    usual = set(explain(scene, brick()).suspicious)
    for spoil, words in spoilt(scene, tmp_path):
        spoil()
        found = set(explain(scene, brick()).suspicious) - usual
        assert any(words in line for line in found), (words, found)


def test_a_material_that_is_not_spectral(scene):
    with pytest.raises(InputError, match='"Plain": is not spectral'):
        explain(scene, bpy.data.materials.new("Plain"))


def test_the_command_and_the_button_say_the_same(scene, addon, tmp_path, capsys):
    path = tmp_path / "house.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    lines = explain(scene, brick()).lines
    assert bpy.ops.skylight.explain(material="Brick") == {"FINISHED"}
    capsys.readouterr()
    assert cli.main(["explain", str(path), "--material", "Brick"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert [line for line in said if line in lines] == lines
    assert cli.main(["explain", str(path), "--material", "Brick", "--json"]) == 0
    text = capsys.readouterr().out
    told = json.loads(text[text.index("{") :])
    assert told["material"] == "Brick" and len(told["steps"]) + len(told["suspicious"]) >= 15
    assert cli.main(["explain", str(path), "--material", "Roof"]) == 2


def test_the_page_names_every_step(scene):
    page = re.findall(r"^\| ([A-Z][^|]*?) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    names = {re.sub(r"^Socket .*", "Socket …", s.name) for s in explain(scene, brick()).steps}
    assert names == set(page) - {"step"}
