"""Groups of earlier files get their tooltips when the add-on writes to them, and nothing else."""

from pathlib import Path

import bpy
import pytest

from spectral_skylight.node_groups import skylight_surface, spectral_matrix
from spectral_skylight.node_groups import tree as groups
from spectral_skylight.tests.node_groups import dump

pytestmark = pytest.mark.blender

FILES = Path(__file__).parents[1] / "files"


def tooltips(tree):
    return [item.description for item in tree.interface.items_tree]


def without_tooltips(tree):
    """A group as the add-on made it before sockets had descriptions."""
    for item in tree.interface.items_tree:
        item.description = ""
    return tree


@pytest.mark.parametrize("name", ["surface1", "surface2"])
def test_opening_an_old_file_adds_none_and_an_update_does(name):
    bpy.ops.wm.open_mainfile(filepath=str(FILES / f"{name}.blend"), load_ui=False)
    ours = [tree for tree in bpy.data.node_groups if groups.KIND in tree]
    assert ours and not any(any(tooltips(tree)) for tree in ours)
    world = bpy.context.scene.world
    surface = skylight_surface.ensure(world, None, None)
    parts = [surface, *(node.node_tree for node in surface.nodes if node.type == "GROUP")]
    assert all(all(tooltips(tree)) for tree in parts)


def test_a_group_of_this_version_gets_tooltips_and_stays_what_it_is():
    bpy.ops.wm.read_homefile(use_empty=True)
    tree = without_tooltips(spectral_matrix.ensure())
    nodes = [node.as_pointer() for node in tree.nodes]
    before = dump.dump(tree)
    identifiers = [item.identifier for item in tree.interface.items_tree]
    user = bpy.data.node_groups.new("User", "ShaderNodeTree")
    node = groups.add(user, "ShaderNodeGroup", node_tree=tree)
    spectral_matrix.set_matrix(node, [[1, 2, 3], [4, 5, 6], [7, 8, 9]])
    assert spectral_matrix.ensure() == tree and all(tooltips(tree))
    assert [n.as_pointer() for n in tree.nodes] == nodes
    assert [item.identifier for item in tree.interface.items_tree] == identifiers
    assert dump.dump(tree) == before
    assert spectral_matrix.get_matrix(node) == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]


@pytest.fixture
def linked(tmp_path):
    """A group of a library, without tooltips."""
    bpy.ops.wm.read_homefile(use_empty=True)
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {without_tooltips(spectral_matrix.ensure())})
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, loaded):
        loaded.node_groups = [spectral_matrix.KIND]
    return loaded.node_groups[0]


def test_a_linked_group_is_left_alone(linked):
    made = spectral_matrix.ensure()
    assert made != linked and made.library is None and all(tooltips(made))
    assert not any(tooltips(linked))


def test_a_group_that_overrides_a_linked_one_is_left_alone(linked):
    override = linked.override_create()
    if override is None:
        pytest.skip(f"Blender {bpy.app.version_string} makes no override of a node group")
    assert spectral_matrix.ensure() == override
    assert not any(tooltips(override)) and not any(tooltips(linked))
