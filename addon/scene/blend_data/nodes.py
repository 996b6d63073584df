"""Small questions to node trees that several rooms ask."""

from __future__ import annotations

from collections.abc import Iterator

import bpy


def source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """What feeds an input, seen through reroutes and muted nodes; None if nothing does."""
    while socket is not None and socket.is_linked:
        link = socket.links[0]
        if link.is_muted:
            return None
        node = link.from_node
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.mute:
            passing = (
                i.from_socket for i in node.internal_links if i.to_socket == link.from_socket
            )
            socket = next(passing, None)
        else:
            return link.from_socket
    return None


def use(owner: bpy.types.Material | bpy.types.World) -> None:
    """Give a material or World its node tree; from 5.0 each has one."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True


def feeding(node: bpy.types.Node) -> Iterator[bpy.types.Node]:
    """A node and all that feed it, also from within groups; each once."""
    waiting, seen = [node], set()
    while waiting:
        node = waiting.pop()
        if node in seen:
            continue
        seen.add(node)
        yield node
        waiting += [link.from_node for socket in node.inputs for link in socket.links]
        if node.type == "GROUP" and node.node_tree is not None:
            waiting += [inside for inside in node.node_tree.nodes if inside.type == "GROUP_OUTPUT"]
