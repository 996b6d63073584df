"""Every operator as a script calls it, and that errors are one line and change nothing."""

import re

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from spectral_skylight.addon.scene import materials, settings, sky_light  # noqa: E402
from spectral_skylight.tests.ui.stage import select, write_sky  # noqa: E402

pytestmark = pytest.mark.blender


@pytest.fixture
def brick(tmp_path, scene):
    """A CSV with the columns brick and moss, as the operators take it."""
    return str(tmp_path / "brick.csv")


def material(name="Wall"):
    return bpy.data.materials[name]


def given(name="Wall"):
    managed = materials.managed(material(name))
    return managed and managed.reflectance_name


def matrix(name="Wall"):
    return np.array(materials.managed(material(name)).matrix)


def links(name="Wall"):
    """Every link of a material's tree, by names."""
    return sorted(
        (link.from_node.name, link.from_socket.name, link.to_node.name, link.to_socket.name)
        for link in material(name).node_tree.links
    )


def state():
    """What of the file an operator that fails must not have touched."""
    return (
        bpy.context.scene.world,
        [(m.name, given(m.name), m.skylight.filepath, links(m.name)) for m in bpy.data.materials],
        sorted(tree.name for tree in bpy.data.node_groups),
        sorted(world.name for world in bpy.data.worlds),
    )


def error_of(operator, **properties):
    """The one line that an operator which must fail reports; checks that nothing changed."""
    before = state()
    with pytest.raises(RuntimeError) as caught:
        operator(**properties)
    assert state() == before
    message = str(caught.value).strip()
    assert "\n" not in message
    assert message.startswith("Error: ")
    return message


def test_load_sky_lights_the_scene(scene, tmp_path):
    world = scene.world
    assert world.node_tree.nodes.get("Environment Texture").image.name == "sky.exr"
    assert "% of this sky's light" in sky_light.description_of(world)["caption"]


def test_load_sky_takes_the_spectral_materials_along(scene, brick, tmp_path):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    before = materials.managed(material()).extra["colour"]
    bpy.ops.skylight.load_sky(filepath=str(write_sky(tmp_path / "green.exr", turquoise=2.0)))
    managed = materials.managed(material())
    assert managed.world == scene.world
    assert managed.extra["colour"][1] > 1.5 * before[1]  # twice the green, less some blue's part
    assert given() == "brick"


def test_load_sky_that_is_none(scene, tmp_path):
    (tmp_path / "cut.exr").write_bytes((tmp_path / "sky.exr").read_bytes()[:3000])
    assert "cut.exr" in error_of(bpy.ops.skylight.load_sky, filepath=str(tmp_path / "cut.exr"))
    assert "no such file" in error_of(bpy.ops.skylight.load_sky, filepath=str(tmp_path / "no.exr"))


def test_load_sky_with_wrong_settings(scene, tmp_path):
    scene.world.skylight.camera = "Brownie"
    other = write_sky(tmp_path / "other.exr")
    assert "Brownie" in error_of(bpy.ops.skylight.load_sky, filepath=str(other))


def test_choose_reflectance_fills_the_columns(scene, brick):
    bpy.ops.skylight.choose_reflectance(filepath=brick)
    choice = material().skylight
    assert [column.name for column in choice.columns] == ["brick", "moss"]
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
    assert len(choice.columns) == 0
    choice.filepath = brick
    assert choice.problem == ""


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
    scene.world = bpy.data.worlds.new("Grey")
    with pytest.raises(RuntimeError, match='World "Grey"'):
        bpy.ops.skylight.apply(filepath=brick, column="brick")
    scene.world = None
    with pytest.raises(RuntimeError, match="has no World"):
        bpy.ops.skylight.apply(filepath=brick, column="brick")
    assert given() is None


def test_update_follows_the_HDRI(scene, brick, tmp_path):
    with pytest.raises(RuntimeError, match="No material is spectral yet"):
        bpy.ops.skylight.update()
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    (tmp_path / "brick.csv").unlink()  # the blend file knows the reflectance
    before = sky_light.coefficients_of(scene.world)
    image = bpy.data.images.load(str(write_sky(tmp_path / "no sun.exr", turquoise=2.0, sun=0)))
    scene.world.node_tree.nodes["Environment Texture"].image = image
    bpy.ops.skylight.update()
    after = sky_light.coefficients_of(scene.world)
    assert after[0, 1] == pytest.approx(2 * before[0, 1], rel=0.05)  # the sun's glow is not in it
    assert sky_light.description_of(scene.world)["caption"] == "open sky: no shadows yet"
    assert given() == "brick"


def test_update_moves_materials_to_the_World_of_the_scene(scene, brick):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    scene.world = scene.world.copy()
    bpy.ops.skylight.update()
    assert materials.managed(material()).world == scene.world


def test_sky_numbers_reach_the_matrix(scene, brick):
    numbers = scene.world.skylight
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    rayleigh = matrix()
    numbers.basis = "daylight"
    bpy.ops.skylight.update()
    daylight = matrix()
    # Two models of skylight differ in the matrix by some per cent of its largest entry.
    assert 0.001 < abs(daylight - rayleigh).max() / abs(rayleigh).max() < 0.3
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
    settings.store(scene.world, {"basis": "daylight", "white": [0.8, 1.0, 1.5], "camera": None})
    numbers = scene.world.skylight
    assert (numbers.basis, numbers.camera) == ("daylight", "")
    assert tuple(numbers.white) == pytest.approx((0.8, 1.0, 1.5))
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    assert settings.stored(scene.world) == {"basis": "daylight", "white": [0.8, 1.0, 1.5]}


def test_a_wrong_camera_is_one_line(scene, brick):
    scene.world.skylight.camera = "Brownie"
    message = error_of(bpy.ops.skylight.apply, filepath=brick, column="brick")
    assert re.search("'Brownie' is neither a file nor a known camera", message)


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
    with pytest.raises(RuntimeError, match="No material of the file is spectral"):
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
    assert not materials.is_managed(wanted.materials[0])
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


def test_the_swatch_is_the_colour_under_this_sky(scene, brick, tmp_path):
    bpy.ops.skylight.apply(filepath=brick, column="brick")
    choice = material().skylight
    colour = materials.managed(material()).extra["colour"]
    assert tuple(choice.swatch) == pytest.approx(colour, rel=1e-6)  # float32
    assert choice.swatch_scale == 1.0
    with pytest.raises(AttributeError, match="read-only"):
        choice.swatch = (1, 1, 1)
    bright = write_sky(tmp_path / "bright.exr", turquoise=40.0, sun=0)
    bpy.ops.skylight.load_sky(filepath=str(bright))
    assert max(choice.swatch) == pytest.approx(1.0)
    bright = np.array(materials.managed(material()).extra["colour"])
    assert bright.max() > 1
    assert choice.swatch_scale == pytest.approx(1 / bright.max(), rel=1e-6)
