"""One Ctrl-Z takes back whatever a button did, and redo does it again: the file's data is equal."""

import bpy
import pytest

from spectral_skylight.addon import tags
from spectral_skylight.addon.scene.world import view_transform
from spectral_skylight.tests.ui.stage import material, select, write_sky

pytestmark = pytest.mark.blender

GROUPS = ("materials", "worlds", "node_groups", "objects", "meshes", "lights", "collections")


def plain(value):
    """A value of blend data as Python's own, so that a step back does not change it."""
    if hasattr(value, "to_dict"):
        value = value.to_dict()
    if hasattr(value, "to_list"):
        value = value.to_list()
    if isinstance(value, dict):
        return {key: plain(each) for key, each in sorted(value.items())}
    return getattr(value, "name", value)


def of_tree(tree):
    """Nodes, values and links of a tree."""
    values = [
        (s.name, plain(s.default_value[:] if s.type in ("VECTOR", "RGBA") else s.default_value))
        for node in tree.nodes
        for s in node.inputs
        if s.type in ("VECTOR", "RGBA", "VALUE")
    ]
    kinds = [(node.name, node.type, plain(dict(node.items()))) for node in tree.nodes]
    links = [(n.from_node.name, n.to_node.name, n.to_socket.name) for n in tree.links]
    return sorted(map(str, kinds)), sorted(map(str, values)), sorted(links)


def state():
    """All that the add-on writes to."""
    found = {name: sorted(each.name for each in getattr(bpy.data, name)) for name in GROUPS}
    for owner in (*bpy.data.materials, *bpy.data.worlds, *bpy.data.scenes):
        found[owner.bl_rna.identifier, owner.name] = plain(
            {key: owner[key] for key in owner.keys() if key not in ("cycles", "skylight")}  # noqa: SIM118
        )
        if getattr(owner, "node_tree", None) is not None:
            found["tree of", owner.name] = of_tree(owner.node_tree)
    for each in bpy.data.materials:
        choice = each.skylight
        found["chosen", each.name] = (choice.filepath, choice.column, choice.unit, choice.kind)
        found["shown", each.name] = tuple(each.diffuse_color)
    for obj in bpy.data.objects:
        found["object", obj.name] = [modifier.name for modifier in obj.modifiers]
    scene = bpy.context.scene
    found["world"] = scene.world.name
    found["view"] = [getattr(scene.view_settings, name) for name in view_transform.WHITE]
    return found


def differing(found, wanted):
    keys = found.keys() | wanted.keys()
    return {k: (found.get(k), wanted.get(k)) for k in keys if found.get(k) != wanted.get(k)}


def check(act, *, changes=True):
    """Do it as a button does; a step back and a step forth must bring the same states."""
    before = state()
    bpy.ops.ed.undo_push(message="before")
    assert act("EXEC_DEFAULT", True) == {"FINISHED"}
    after = state()
    assert bool(differing(after, before)) == changes, differing(after, before)
    bpy.ops.ed.undo()
    assert differing(state(), before) == {}
    bpy.ops.ed.redo()
    assert differing(state(), after) == {}


def test_each_button_is_one_step(scene, brick, tmp_path):
    ops = bpy.ops.skylight

    def told(operator, **properties):
        return lambda *how: operator(*how, **properties)

    mesh = bpy.data.objects["Wall"].data
    places = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)]
    mesh.from_pydata(places, [], [(0, 1, 2, 3), (0, 1, 5, 4)])
    check(told(ops.choose_reflectance, filepath=brick, column="brick"))
    check(told(ops.apply))
    check(told(ops.make_spectral))
    assert tags.VIEWPORT_COLOR in material("Roof")
    check(told(ops.neutral_white))
    check(told(ops.before_after))
    check(told(ops.before_after))
    check(told(ops.bake, rays=32))
    other = write_sky(tmp_path / "other.exr", turquoise=1.4)
    check(told(ops.load_sky, filepath=str(other)))
    check(told(ops.update), changes=False)
    check(told(ops.remove, material="Roof"))
    check(told(ops.apply, material="Roof", filepath=brick, column="moss", kind="GLASS"))
    check(told(ops.estimate, material="Roof"))
    check(told(ops.remove_bakes))
    select("Wall", "Roof")
    check(told(ops.remove_selected))
    check(told(ops.apply_selected, filepath=brick, column="moss"))
    check(told(ops.remove_all))
    assert not any(tags.MATERIAL in each for each in bpy.data.materials)


def test_all_of_ours_leaves_by_one_step(scene, tmp_path):
    """Bakes, lamps, groups and the World in place of the user's: one click, and one step back."""
    bpy.data.worlds.remove(scene.world)
    scene.world = bpy.data.worlds.new("Dusk")
    mesh = bpy.data.objects["Wall"].data
    places = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)]
    mesh.from_pydata(places, [], [(0, 1, 2, 3), (0, 1, 5, 4)])
    before = state()
    other = write_sky(tmp_path / "other.exr", turquoise=1.4)
    bpy.ops.skylight.load_sky(filepath=str(other))
    bpy.ops.skylight.make_spectral()
    assert bpy.data.objects["Wall"].modifiers and scene.world.name != "Dusk"
    check(lambda *how: bpy.ops.skylight.remove_all(*how))
    assert bpy.context.scene.world.name == "Dusk"
    assert differing(state(), before) == {}
