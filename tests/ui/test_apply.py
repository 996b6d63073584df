"""Apply and remove on active, selected and all materials; what fails is one line, no change."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.transfer.assignment import ESTIMATED
from spectral_skylight.tests.ui.stage import (
    error_of,
    given,
    links,
    material,
    matrix,
    select,
)

pytestmark = pytest.mark.blender


def test_apply_on_a_named_material(scene, brick):
    select()
    bpy.ops.skylight.apply(material="Roof", filepath=brick, column="moss")
    assert (given("Roof"), given("Wall")) == ("moss", None)
    choice = material("Roof").skylight
    assert (choice.filepath, choice.column) == (brick, "moss")


def test_apply_on_the_active_material_by_what_was_chosen(scene, brick):
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="moss")
    bpy.ops.skylight.apply()
    assert (given("Roof"), given("Wall")) == (None, "moss")


def test_apply_twice_is_once(scene, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    once = (links(), matrix().tolist(), len(bpy.data.node_groups), len(material().node_tree.nodes))
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    twice = (links(), matrix().tolist(), len(bpy.data.node_groups), len(material().node_tree.nodes))
    assert twice == once


def test_what_was_measured_is_kept_and_forgotten_with_the_reflectance(scene, brick, tmp_path):
    file = tmp_path / "short.csv"
    file.write_text("nm,slate\n" + "".join(f"{nm},0.{nm}\n" for nm in range(400, 701, 10)))
    bpy.ops.skylight.apply(filepath=str(file))
    bpy.ops.skylight.update()
    assert spectral_material.managed(material()).details.measured == (400.0, 700.0)
    bpy.ops.skylight.estimate()
    assert spectral_material.managed(material()).details.measured is None


def test_apply_on_the_selection(scene, brick):
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="brick")
    select("Wall", "Roof")
    bpy.ops.skylight.apply_selected()
    assert (given("Wall"), given("Roof")) == ("brick", None)  # Roof has no CSV: skipped and said
    bpy.ops.skylight.apply_selected(filepath=brick, column="moss")
    assert (given("Wall"), given("Roof")) == ("moss", "moss")
    select()
    with pytest.raises(RuntimeError, match="Select objects with materials"):
        bpy.ops.skylight.apply_selected()


def test_apply_on_all_that_have_a_reflectance(scene, brick):
    with pytest.raises(RuntimeError, match="Choose a reflectance CSV"):
        bpy.ops.skylight.apply_all()
    bpy.data.materials.new("Bare")
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="brick")
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="moss", material="Roof")
    select()
    bpy.ops.skylight.apply_all()
    assert (given("Wall"), given("Roof"), given("Bare")) == ("brick", "moss", None)


def test_apply_in_percent(scene, brick, tmp_path):
    """1.5 may be 1.5 % or a mistake: the file is refused until the unit is said."""
    file = tmp_path / "dark.csv"
    file.write_text("nm,soot\n" + "".join(f"{nm},1.5\n" for nm in range(380, 781, 10)))
    assert "percent or fraction" in error_of(bpy.ops.skylight.apply, filepath=str(file))
    bpy.ops.skylight.apply(filepath=str(file), unit="PERCENT")
    # A grey reflectance c is c times the identity in a colorimetric HDRI; float32 sockets.
    assert matrix() == pytest.approx(0.015 * np.eye(3), abs=1e-8)
    assert material().skylight.unit == "PERCENT"


@pytest.mark.parametrize(
    "text, says",
    [
        ("nm,brick\n400,0.1\n700,much\n", "'much' is not a number"),
        ("nm,brick\n400,0.1\n700,0.2\n", "a gap from 400 to 700 nm"),
        ("nm,brick,moss\n", "no row of numbers"),
    ],
)
def test_apply_a_broken_file(scene, brick, tmp_path, text, says):
    file = tmp_path / "broken.csv"
    file.write_text(text)
    message = error_of(bpy.ops.skylight.apply, filepath=str(file))
    assert says in message
    assert "broken.csv" in message


def test_apply_is_all_or_nothing(scene, brick, tmp_path):
    """Wall's file is good and Roof's is broken since it was chosen: neither is touched."""
    file = tmp_path / "roof.csv"
    file.write_text((tmp_path / "brick.csv").read_text())
    bpy.ops.skylight.choose_reflectance(filepath=brick, column="brick")
    bpy.ops.skylight.choose_reflectance(filepath=str(file), column="moss", material="Roof")
    file.write_text("nm,moss\n400,-1\n")
    assert "roof.csv" in error_of(bpy.ops.skylight.apply_all)


def test_apply_needs_a_column_and_a_file(scene, brick):
    assert "holds 2 materials; choose a column" in error_of(bpy.ops.skylight.apply, filepath=brick)
    assert "no column 'slate'" in error_of(bpy.ops.skylight.apply, filepath=brick, column="slate")
    assert "choose a CSV" in error_of(bpy.ops.skylight.apply)
    assert "has no material 'Door'" in error_of(bpy.ops.skylight.apply, material="Door")


def test_a_world_without_an_HDRI(scene, brick):
    scene.world = None
    with pytest.raises(RuntimeError, match="has no World"):
        bpy.ops.skylight.apply(filepath=brick, column="brick")
    assert given() is None
    scene.world = bpy.data.worlds.new("Grey")
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    assert given() == "brick"


def test_remove_gives_the_material_back(scene, brick):
    before = {name: links(name) for name in ("Wall", "Roof")}
    groups = len(bpy.data.node_groups)
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    bpy.ops.skylight.apply(filepath=brick, column="moss", material="Roof")
    bpy.ops.skylight.remove()
    assert (given("Wall"), given("Roof")) == (None, "moss")
    assert links("Wall") == before["Wall"]
    assert material().skylight.filepath == brick  # the choice stays, to apply again
    bpy.ops.skylight.remove(material="Roof")
    assert links("Roof") == before["Roof"]
    assert len(bpy.data.node_groups) < groups + 1


def test_remove_from_selection_and_all(scene, brick):
    select("Wall", "Roof")
    with pytest.raises(RuntimeError, match="No selected object has a spectral material"):
        bpy.ops.skylight.remove_selected()
    with pytest.raises(RuntimeError, match="No material is spectral yet"):
        bpy.ops.skylight.remove_all()
    bpy.ops.skylight.apply_selected(filepath=brick, column="moss")
    select("Roof")
    bpy.ops.skylight.remove_selected()
    assert (given("Wall"), given("Roof")) == ("moss", None)
    bpy.ops.skylight.apply_selected(filepath=brick, column="moss")
    bpy.ops.skylight.remove_all()
    assert (given("Wall"), given("Roof")) == (None, None)


def test_a_linked_material_is_skipped_and_said(scene, brick, tmp_path, capfd):
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {bpy.data.materials["Roof"]}, fake_user=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.materials = ["Roof"]
    bpy.data.objects["Roof"].data.materials[0] = wanted.materials[0]
    select("Wall", "Roof")
    bpy.ops.skylight.apply_selected(filepath=brick, column="brick")
    assert given("Wall") == "brick"
    assert not spectral_material.is_managed(wanted.materials[0])
    assert 'skipped: material "Roof": is linked from' in capfd.readouterr().out
    select("Roof")
    with pytest.raises(RuntimeError, match="is linked from .*library.blend"):
        bpy.ops.skylight.apply(filepath=brick, column="brick")


def test_a_step_back_undoes_apply(scene, brick):
    before = links()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.skylight.apply("EXEC_DEFAULT", True, filepath=brick, column="brick")
    assert given() == "brick"
    bpy.ops.ed.undo()
    assert (given(), links(), material().skylight.filepath) == (None, before, "")
    bpy.ops.ed.redo()
    assert (given(), material().skylight.column) == ("brick", "brick")
    bpy.ops.skylight.update()


def test_a_table_gives_a_re_imported_model_what_it_had(scene, brick, tmp_path):
    """Two materials, one estimated; then new materials of the same names, and one that is gone."""
    table = tmp_path / "house.materials.csv"
    with pytest.raises(RuntimeError, match="No material is spectral yet"):
        bpy.ops.skylight.write_assignments(filepath=str(table))
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    bpy.ops.skylight.estimate(material="Roof")
    before = {name: matrix(name) for name in ("Wall", "Roof")}
    bpy.ops.skylight.write_assignments(filepath=str(table))
    assert table.read_text().splitlines()[1:] == [
        "Roof,estimate,,,,,",
        "Wall,brick.csv:brick,,,,,fraction",
    ]
    bpy.ops.skylight.remove_all()
    for name in ("Wall", "Roof"):
        old = bpy.data.materials[name]
        old.name = "Old"
        fresh = old.copy()
        fresh.name = name
        old.user_remap(fresh)
    table.write_text(table.read_text() + "Gutter,estimate,,,,,\n")
    bpy.ops.skylight.read_assignments(filepath=str(table))
    assert (given("Wall"), given("Roof")) == ("brick", ESTIMATED)
    for name, values in before.items():
        assert matrix(name) == pytest.approx(values, abs=1e-7)
    table.write_text("material,reflectance\nGutter,estimate\n")
    error = error_of(bpy.ops.skylight.read_assignments, filepath=str(table))
    assert "names no material of this scene" in error
