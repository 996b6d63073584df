"""Making shader node groups from Python, and bringing old ones up to date in place."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import bpy

# Custom properties by which a group of ours is found again, whatever a user calls it.
KIND = "spectral_skylight_kind"
VERSION = "spectral_skylight_version"
VARIANT = "spectral_skylight_variant"

# name, socket type ("NodeSocketVector", …), default value or None
Socket = tuple[str, str, Any]


def of_kind(kind: str) -> list[bpy.types.NodeTree]:
    """This file's own groups of a kind; those of linked libraries cannot be edited here."""
    return [t for t in bpy.data.node_groups if t.library is None and t.get(KIND) == kind]


def kind_of(node: bpy.types.Node) -> str | None:
    """The kind of the group of ours that a node shows, None for any other node."""
    tree = node.node_tree if node.type == "GROUP" else None
    return None if tree is None else tree.get(KIND)


def prune(kept: str) -> None:
    """Take out of the file all groups of ours that nothing shows, but those of one kind."""
    while unused := [
        tree
        for tree in bpy.data.node_groups
        if KIND in tree and tree[KIND] != kept and tree.users == 0 and tree.library is None
    ]:
        bpy.data.batch_remove(unused)


def ensure(
    tree: bpy.types.NodeTree | None,
    kind: str,
    version: int,
    inputs: list[Socket],
    outputs: list[Socket],
    build: Callable[[bpy.types.NodeTree], None],
    variant: str = "",
) -> bpy.types.NodeTree:
    """A group of a kind at this version: the given one, brought up to date in place, or a new one.

    An older group, or one of another variant (what of a kind is inside), keeps its identity and its
    sockets, and with them (`interface.clear()` would lose them) its users' values and links;
    missing sockets are added, the inside is built anew.
    """
    if tree is None:
        tree = bpy.data.node_groups.new(kind, "ShaderNodeTree")
        tree[KIND] = kind
    if tree.get(VERSION) == version and tree.get(VARIANT, "") == variant:
        return tree
    for in_out, sockets in (("INPUT", inputs), ("OUTPUT", outputs)):
        for name, socket_type, value in sockets:
            _ensure_socket(tree, in_out, name, socket_type, value)
    tree.nodes.clear()
    build(tree)
    tree[VERSION], tree[VARIANT] = version, variant
    return tree


def _ensure_socket(
    tree: bpy.types.NodeTree, in_out: str, name: str, socket_type: str, value: Any
) -> None:
    for item in tree.interface.items_tree:
        if item.item_type == "SOCKET" and item.in_out == in_out and item.name == name:
            return
    socket = tree.interface.new_socket(name, in_out=in_out, socket_type=socket_type)
    if value is not None:
        socket.default_value = value
        for node in instances(tree):  # they have the new input already, at 0
            (node.inputs if in_out == "INPUT" else node.outputs)[name].default_value = value


def instances(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """All group nodes in this file's materials, Worlds and groups that show a group."""
    owners = (*bpy.data.materials, *bpy.data.worlds)
    trees = (*(o.node_tree for o in owners if o.node_tree), *bpy.data.node_groups)
    return (n for t in trees for n in t.nodes if n.type == "GROUP" and n.node_tree == tree)


def add(tree: bpy.types.NodeTree, type_name: str, *sources: Any, **settings: Any) -> bpy.types.Node:
    """A new node with its settings, its inputs in order linked (a socket) or set (a value).

    None leaves an input as it is.
    """
    node = tree.nodes.new(type_name)
    for name, value in settings.items():
        setattr(node, name, value)
    for socket, source in zip(node.inputs, sources, strict=False):
        if isinstance(source, bpy.types.NodeSocket):
            tree.links.new(source, socket)
        elif source is not None:
            socket.default_value = source
    return node


def arrange(tree: bpy.types.NodeTree) -> None:
    """Lay the nodes out in columns by how far they stand from the output, for whoever opens it."""
    depth: dict[str, int] = {}
    for node in reversed(tree.nodes):  # builders add a node after what feeds it
        depth.setdefault(node.name, 0)
        for socket in node.inputs:
            for link in socket.links:
                name = link.from_node.name
                depth[name] = max(depth.get(name, 0), depth[node.name] + 1)
    rows: dict[int, int] = {}
    for node in tree.nodes:
        column = depth[node.name]
        node.location = (-220 * column, -180 * rows.get(column, 0))
        rows[column] = rows.get(column, 0) + 1
