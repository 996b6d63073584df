"""Small questions to node trees that several rooms ask."""

from __future__ import annotations

import bpy

MANAGED = "spectral_skylight"  # on a material: what it was given


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
