"""Making shader node groups from Python, and bringing old ones up to date in place."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import bpy

# Custom properties by which a group of ours is found again, whatever a user calls it.
KIND = "spectral_skylight_kind"
VERSION = "spectral_skylight_version"
VARIANT = "spectral_skylight_variant"
NODES = "spectral_skylight_nodes"
"""How many nodes were built: with fewer, somebody has taken some out."""


class Socket(NamedTuple):
    """An input or output of a group.

    `type`: "Vector" for Blender's NodeSocketVector, and so on. `description`: what Blender shows as
    its tooltip, and the group's page as its meaning. `default`: None leaves Blender's own.
    """

    name: str
    type: str
    description: str
    default: Any = None


def of_kind(kind: str) -> list[bpy.types.NodeTree]:
    """This file's own groups of a kind; those of linked libraries cannot be edited here."""
    return [t for t in bpy.data.node_groups if t.library is None and t.get(KIND) == kind]


def known(kind: str, version: int) -> bpy.types.NodeTree | None:
    """The first of this file's groups of a kind that is no newer than a version, None without."""
    return next((t for t in of_kind(kind) if not is_newer(t, version)), None)


def is_newer(tree: bpy.types.NodeTree, version: int) -> bool:
    """Whether a group was made by a newer version of its kind: it is to be left alone."""
    found = tree.get(VERSION, 0)
    return isinstance(found, int | float) and found > version


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
    inputs: Sequence[Socket],
    outputs: Sequence[Socket],
    build: Callable[[bpy.types.NodeTree], None],
    variant: str = "",
    tree_type: str = "ShaderNodeTree",
) -> bpy.types.NodeTree:
    """A group of a kind at this version: the given one, brought up to date in place, or a new one.

    An older group, or one of another variant (what of a kind is inside), keeps its identity and its
    sockets, and with them (`interface.clear()` would lose them) its users' values and links;
    missing sockets are added, those that are no more are taken away, the inside is built anew; so
    is that of a group that somebody has taken sockets or nodes out of. A whole group at this
    version gets the descriptions that it lacks, which changes no shader.
    """
    if tree is None:
        tree = bpy.data.node_groups.new(kind, tree_type)
        tree[KIND] = kind
        if tree_type == "GeometryNodeTree":
            tree.is_modifier = True
    current = tree.get(VERSION) == version and tree.get(VARIANT, "") == variant
    current = current and _is_whole(tree, inputs, outputs)
    for in_out, sockets in (("INPUT", inputs), ("OUTPUT", outputs)):
        for socket in sockets:
            item = _find(tree, in_out, socket.name)
            if item is not None:
                _describe(tree, item, socket.description)
            elif not current:
                _add_socket(tree, in_out, socket)
    if not current:
        known = {"INPUT": {s.name for s in inputs}, "OUTPUT": {s.name for s in outputs}}
        for item in list(tree.interface.items_tree):
            if item.item_type == "SOCKET" and item.name not in known[item.in_out]:
                tree.interface.remove(item)
        tree.nodes.clear()
        build(tree)
        arrange(tree)
        tree[VERSION], tree[VARIANT], tree[NODES] = version, variant, len(tree.nodes)
    return tree


def _is_whole(
    tree: bpy.types.NodeTree, inputs: Sequence[Socket], outputs: Sequence[Socket]
) -> bool:
    """Whether a group has all sockets and as many nodes, with their groups, as were built."""
    built = tree.get(NODES, 1)
    sockets = (("INPUT", s.name) for s in inputs), (("OUTPUT", s.name) for s in outputs)
    found = all(_find(tree, *each) is not None for some in sockets for each in some)
    found = found and all(n.node_tree is not None for n in tree.nodes if n.type == "GROUP")
    return found and len(tree.nodes) >= (built if isinstance(built, int) else 1)


def _find(
    tree: bpy.types.NodeTree, in_out: str, name: str
) -> bpy.types.NodeTreeInterfaceSocket | None:
    for item in tree.interface.items_tree:
        if item.item_type == "SOCKET" and item.in_out == in_out and item.name == name:
            return item
    return None


def _add_socket(tree: bpy.types.NodeTree, in_out: str, socket: Socket) -> None:
    name, kind, description, value = socket
    item = tree.interface.new_socket(
        name, description=description, in_out=in_out, socket_type=f"NodeSocket{kind}"
    )
    if value is not None:
        item.default_value = value
        for node in instances(tree):  # they have the new input already, at 0
            (node.inputs if in_out == "INPUT" else node.outputs)[name].default_value = value


def _describe(
    tree: bpy.types.NodeTree, item: bpy.types.NodeTreeInterfaceSocket, description: str
) -> None:
    """Set a tooltip; not again, for Blender then looks at all materials that show the group.

    A group that overrides a library's has the library's tooltips: what would be written here is
    lost when the file is opened again.
    """
    if item.description != description and tree.override_library is None:
        item.description = description


def instances(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """All group nodes in this file's materials, Worlds and groups that show a group."""
    owners = (*bpy.data.materials, *bpy.data.worlds)
    trees = (*(o.node_tree for o in owners if o.node_tree), *bpy.data.node_groups)
    return (n for t in trees for n in t.nodes if n.type == "GROUP" and n.node_tree == tree)


def show(node: bpy.types.Node, tree: bpy.types.NodeTree) -> None:
    """Let a group node show another group of its kind; links and values stay with their names.

    Blender itself goes by identifiers, which differ between a new group and an upgraded one.
    """
    if node.node_tree == tree:
        return
    links = node.id_data.links
    values = {s.name: _value(s) for s in node.inputs if hasattr(s, "default_value")}
    sources = {s.name: s.links[0].from_socket for s in node.inputs if s.is_linked}
    targets = [(s.name, link.to_socket) for s in node.outputs for link in s.links]
    node.node_tree = tree
    for name, value in values.items():
        if name in node.inputs:
            node.inputs[name].default_value = value
    for socket in node.inputs:
        for link in list(socket.links):
            links.remove(link)
        if socket.name in sources:
            links.new(sources[socket.name], socket)
    for name, target in targets:
        if name in node.outputs:
            links.new(node.outputs[name], target)


def _value(socket: bpy.types.NodeSocket) -> Any:
    value = socket.default_value
    return tuple(value) if hasattr(value, "__len__") else value


def add(
    tree: bpy.types.NodeTree,
    type_name: str,
    *sources: Any,
    into: Mapping[str, Any] | None = None,
    **settings: Any,
) -> bpy.types.Node:
    """A new node with its settings, its inputs linked or set: in order, and by name.

    A source is a socket, a `value.Value` or what an input can hold; None leaves the input as it is.
    Inputs that do not count under these settings are left out of the order: Blender 5.3 has put new
    ones before those of old nodes.
    """
    node = tree.nodes.new(type_name)
    for name, setting in settings.items():
        setattr(node, name, setting)
    for target, source in zip([s for s in node.inputs if s.enabled], sources, strict=False):
        _feed(tree, target, source)
    for name, source in (into or {}).items():
        _feed(tree, node.inputs[name], source)
    return node


def _feed(tree: bpy.types.NodeTree, target: bpy.types.NodeSocket, source: Any) -> None:
    source = getattr(source, "socket", source)
    if isinstance(source, bpy.types.NodeSocket):
        tree.links.new(source, target)
    elif source is not None:
        target.default_value = source


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
