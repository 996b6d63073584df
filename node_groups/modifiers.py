"""Modifiers that show a group of ours, and their inputs by name, in all Blenders."""

from __future__ import annotations

from typing import Any

import bpy

from . import tree as groups


def of_kind(obj: bpy.types.Object, kind: str) -> bpy.types.NodesModifier | None:
    """The modifier of an object that shows a group of a kind, None without."""
    ours = (m for m in obj.modifiers if m.type == "NODES" and m.node_group is not None)
    return next((m for m in ours if m.node_group.get(groups.KIND) == kind), None)


def set_inputs(modifier: bpy.types.NodesModifier, **values: Any) -> None:
    """Write inputs of a modifier, by name."""
    for name, value in values.items():
        identifier = _identifier(modifier.node_group, name)
        if hasattr(modifier, "properties"):  # Blender 5.2
            getattr(modifier.properties.inputs, identifier).value = value
        else:
            modifier[identifier] = value


def get_input(modifier: bpy.types.NodesModifier, name: str) -> Any:
    """The value of an input of a modifier, by name."""
    identifier = _identifier(modifier.node_group, name)
    if hasattr(modifier, "properties"):
        return getattr(modifier.properties.inputs, identifier).value
    return modifier.get(identifier)


def _identifier(tree: bpy.types.NodeTree, name: str) -> str:
    return next(
        item.identifier
        for item in tree.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name == name
    )
