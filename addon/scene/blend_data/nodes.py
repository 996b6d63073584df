"""Small questions to node trees that several rooms ask."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

DEEPEST = 8
"""Groups inside of one another that are looked into."""


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


MIXES = {"MIX_SHADER": (1, 2), "ADD_SHADER": (0, 1)}
"""Shaders that mix others, and the inputs that those stand in."""


def leaves(shader: bpy.types.NodeSocket | None) -> Iterator[bpy.types.Node]:
    """The shaders that a shader mixes, itself if it mixes none."""
    if shader is None:
        return
    parts = MIXES.get(shader.node.type)
    if parts is None:
        yield shader.node
        return
    for k in parts:
        yield from leaves(source(shader.node.inputs[k]))


def shaders(shader: bpy.types.NodeSocket | None, depth: int = 0) -> Iterator[bpy.types.Node]:
    """The shaders that a shader mixes, a group's and those inside of it too."""
    for node in leaves(shader):
        yield node
        if node.type != "GROUP" or node.node_tree is None or depth >= DEEPEST:
            continue
        for end in (each for each in node.node_tree.nodes if each.type == "GROUP_OUTPUT"):
            for socket in end.inputs:
                if socket.type == "SHADER":
                    yield from shaders(source(socket), depth + 1)


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
