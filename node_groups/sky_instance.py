"""`Sky Instance`: the modifier by which an object of ours shows what an instance showed.

An instance has its mesh in common with others, so nothing can be baked for it alone. An object
stands in for it, whose geometry is that of the instanced object, live: its own modifiers, evaluated
where it stands itself.
"""

from __future__ import annotations

from functools import partial

import bpy

from . import tree as groups

KIND = "Sky Instance"
VERSION = 1


def ensure() -> bpy.types.NodeTree:
    """The `Sky Instance` group of this file, made or updated.

    Inputs: Geometry, which is not shown; Source, the object that is; Collection, what was instanced
    (kept here for when the instances come back). Output: Geometry.
    """
    tree = next(iter(groups.of_kind(KIND)), None)
    if tree is None:
        tree = bpy.data.node_groups.new(KIND, "GeometryNodeTree")
        tree[groups.KIND] = KIND
        tree.is_modifier = True
    inputs = [
        ("Geometry", "NodeSocketGeometry", None),
        ("Source", "NodeSocketObject", None),
        ("Collection", "NodeSocketCollection", None),
    ]
    outputs = [("Geometry", "NodeSocketGeometry", None)]
    return groups.ensure(tree, KIND, VERSION, inputs, outputs, _build)


def _build(tree: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    given = add("NodeGroupInput").outputs
    info = add("GeometryNodeObjectInfo", given["Source"], transform_space="ORIGINAL")
    add("NodeGroupOutput", info.outputs["Geometry"])
    groups.arrange(tree)
