"""What has changed since is noticed and listed: base colours, textures, files, bakes."""

import bpy
import pytest

from spectral_skylight.addon.scene import out_of_date
from spectral_skylight.addon.ui import panels, staleness_handlers
from spectral_skylight.tests.ui.stage import drawn, given, material, matrix, select

pytestmark = pytest.mark.blender


@pytest.fixture
def watched(scene):
    """The scene, watched as it is where there is a window; nothing is baked unasked."""
    scene.world.skylight.occlusion = "open"
    staleness_handlers.attach(background=True)
    yield scene
    staleness_handlers.detach()


def principled(name="Wall"):
    return material(name).node_tree.nodes["Principled BSDF"]


def problems():
    bpy.context.view_layer.update()  # as Blender does before it draws
    """What the panel says in red."""
    found = drawn(panels.SKYLIGHT_PT_main).drawn
    icons = "ERROR", "BLANK1"  # of a sentence's first line, and of the others
    said = [told for kind, _, told in found if kind == "label" and told.get("icon") in icons]
    return " ".join(told["text"] for told in said)


def test_a_base_colour_changed_later(watched):
    bpy.ops.skylight.make_spectral()
    assert problems() == ""
    before = principled().inputs["Base Color"].default_value[:]
    principled().inputs["Base Color"].default_value = (0.1, 0.5, 0.2, 1.0)
    assert "Wall: its base color has changed since it was estimated" in problems()
    assert out_of_date.colour(material("Roof")) == "" != out_of_date.colour(material())
    assert "base color has changed" in drawn(panels.SKYLIGHT_PT_material).text
    principled().inputs["Base Color"].default_value = before
    assert problems() == ""
    principled().inputs["Base Color"].default_value = (0.1, 0.5, 0.2, 1.0)
    old = matrix()
    bpy.ops.skylight.make_spectral()
    assert problems() == "" and abs(matrix() - old).max() > 0.05
    principled().inputs["Base Color"].default_value = before
    assert "Wall" in problems()
    bpy.ops.skylight.remove_all()
    assert problems() == ""


def test_a_colour_of_the_same_value_or_another_setting_is_no_change(watched):
    bpy.ops.skylight.make_spectral()
    principled().inputs["Roughness"].default_value = 0.1
    principled().inputs["Base Color"].default_value = (
        principled().inputs["Base Color"].default_value
    )
    material().name = "Renamed"
    assert problems() == ""


def test_another_texture(watched):
    tree = material().node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("tiles", 4, 4)
    tree.links.new(node.outputs[0], principled().inputs["Base Color"])
    bpy.ops.skylight.make_spectral()
    assert problems() == ""
    node.image = bpy.data.images.new("planks", 4, 4)
    assert "Wall: its base color has changed" in problems()


def test_a_measured_colour_has_none_to_change(watched, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    principled().inputs["Base Color"].default_value = (0, 1, 0, 1)
    assert problems() == ""


def test_it_is_known_again_after_saving_and_undo(watched, tmp_path):
    bpy.ops.skylight.make_spectral()
    bpy.ops.ed.undo_push(message="spectral")
    principled().inputs["Base Color"].default_value = (0, 1, 0, 1)
    bpy.ops.ed.undo_push(message="green")
    assert "Wall" in problems()
    bpy.ops.ed.undo()
    assert problems() == ""
    bpy.ops.ed.redo()
    assert "Wall" in problems()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "green.blend"))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert staleness_handlers.stale_materials() == []
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "green.blend"))
    assert "Wall" in problems()


def test_a_file_that_changed_on_disk_is_told_at_update(watched, brick, tmp_path, capfd):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    bpy.ops.skylight.update()
    assert problems() == ""
    text = (tmp_path / "brick.csv").read_text()
    (tmp_path / "brick.csv").write_text(text.replace("0.450", "0.460"))
    old = matrix()
    bpy.ops.skylight.update()
    assert "Wall: brick.csv has changed: apply it again" in problems()
    assert "brick.csv has changed" in capfd.readouterr().out
    assert matrix() == pytest.approx(old)  # the file's own copy holds until then
    bpy.ops.skylight.make_spectral()
    assert problems() == "" and given() == "brick"
    assert abs(matrix() - old).max() > 1e-4
    (tmp_path / "brick.csv").unlink()
    bpy.ops.skylight.update()
    assert problems() == ""
    assert "Wall keeps its reflectance" in capfd.readouterr().out


def test_bakes_that_are_missing_or_old_are_listed(watched, brick):
    for name in ("Wall", "Roof"):
        places = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        bpy.data.objects[name].data.from_pydata(places, [], [(0, 1, 2, 3)])
    bpy.data.objects["Roof"].location.x = 300.0  # far from one another
    bpy.ops.skylight.make_spectral()
    assert out_of_date.unbaked(watched) == []  # no bake is asked for
    select("Wall")
    bpy.ops.skylight.bake(rays=32, selected=True)
    assert "Old light: Roof" in problems()
    bpy.ops.skylight.bake(rays=32)
    assert problems() == ""
    bpy.data.objects["Wall"].rotation_euler.x = 0.5
    assert "Objects changed" in problems()
    bpy.ops.skylight.update()
    assert "Old light: Wall" in problems()
    bpy.ops.skylight.bake(rays=32)
    assert problems() == ""


def test_no_handler_runs_without_a_window(scene):
    for name, handler in staleness_handlers.HANDLERS.items():
        assert handler not in getattr(bpy.app.handlers, name)


def test_RGB_that_is_saved_or_rendered_is_told(watched, brick, tmp_path, capfd):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    bpy.ops.skylight.before_after()
    capfd.readouterr()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "before.blend"))
    assert "1 material(s) show RGB × RGB" in capfd.readouterr().out
