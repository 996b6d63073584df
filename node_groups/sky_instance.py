"""`Sky Instance`: the modifier by which an object of ours shows what an instance showed.

An instance has its mesh in common with others, so nothing can be baked for it alone. An object
stands in for it, whose geometry is that of the instanced object, live: its own modifiers, evaluated
where it stands itself.
"""

from __future__ import annotations

from functools import partial

import bpy

from . import tree as groups
from .tree import Socket
from .value import inputs

KIND = "Sky Instance"
VERSION = 1


INPUTS = (
    Socket("Geometry", "Geometry", "Geometry of the object itself, which is not shown"),
    Socket("Source", "Object", "Object whose geometry is shown"),
    Socket("Collection", "Collection", "Collection that the Empty shows again without the bake"),
)
OUTPUTS = (Socket("Geometry", "Geometry", "Geometry of the source"),)


def ensure() -> bpy.types.NodeTree:
    """The `Sky Instance` group of this file, made or updated."""
    tree = groups.known(KIND, VERSION)
    return groups.ensure(tree, KIND, VERSION, INPUTS, OUTPUTS, _build, tree_type="GeometryNodeTree")


def _build(tree: bpy.types.NodeTree) -> None:
    add = partial(groups.add, tree)
    info = add("GeometryNodeObjectInfo", inputs(tree)["Source"], transform_space="ORIGINAL")
    add("NodeGroupOutput", info.outputs["Geometry"])
