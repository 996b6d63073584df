"""A group's inside changes with its version alone: saved files hold it, and a new one compiles."""

import json

import bpy
import pytest

from spectral_skylight.tests.node_groups import dump

pytestmark = pytest.mark.blender


def test_no_tree_has_changed_without_its_version():
    kept = json.loads(dump.KEPT.read_text())
    made = {
        dump.name_of(content): dump.digest(content) for content in map(dump.dump, dump.every_tree())
    }
    cure = f"raise its VERSION, then run `python -m {dump.__name__}`"
    assert {name for name in made if made[name] != kept.get(name)} == set(), cure
    assert len(made) == 26  # 14 kinds and variants, and 12 of Features


def test_a_dump_sees_each_change():
    bpy.ops.wm.read_homefile(use_empty=True)
    tree = dump.spectral_matrix.ensure()
    before = dump.digest(dump.dump(tree))
    assert dump.digest(dump.dump(tree)) == before
    dot = next(node for node in tree.nodes if node.type == "VECT_MATH")
    seen = {before}
    dot.operation = "CROSS_PRODUCT"
    seen.add(dump.digest(dump.dump(tree)))
    dot.operation = "DOT_PRODUCT"
    dot.location.x += 10.0
    assert dump.digest(dump.dump(tree)) == before
    link = dot.inputs[1].links[0]
    tree.links.remove(link)
    seen.add(dump.digest(dump.dump(tree)))
    dot.inputs[1].default_value = (0.0, 2.0, 0.0)
    seen.add(dump.digest(dump.dump(tree)))
    next(item for item in tree.interface.items_tree if item.name == "Row G").default_value[0] = 1.0
    seen.add(dump.digest(dump.dump(tree)))
    assert len(seen) == 5
    bpy.data.node_groups.remove(tree)
