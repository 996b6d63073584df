"""What of ours has what something of the user's has: its link, its value, its motion."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
from bpy.types import NodeSocket as Socket

from ....node_groups.drivers import drive


def take(material: bpy.types.Material, old: Socket, new: Socket) -> None:
    """Link or set an input of a material's node as another one is.

    A muted link counts as none. A driven value gets the same driver, a keyframed one a driver that
    copies it: plain ones, which work in a file without the add-on.
    """
    tree = material.node_tree
    if old.is_linked and not old.links[0].is_muted:
        tree.links.new(old.links[0].from_socket, new)
        return
    new.default_value = old.default_value
    path, own = (socket.path_from_id("default_value") for socket in (old, new))
    driven = {d.array_index: d for d in _drivers(tree) if d.data_path == path}
    moving = {curve.array_index for curve in curves(tree) if curve.data_path == path}
    for axis in sorted(moving | driven.keys()):
        if axis in driven:
            tree.animation_data.drivers.from_existing(src_driver=driven[axis]).data_path = own
            continue
        several = hasattr(old.default_value, "__len__")
        source = f"node_tree.{path}" + (f"[{axis}]" if several else "")
        drive(new, "default_value", material, source, axis if several else -1)


def moves(socket: Socket) -> bool:
    """Whether an input's value is keyframed or driven."""
    tree = socket.id_data
    path = socket.path_from_id("default_value")
    return any(curve.data_path == path for curve in (*_drivers(tree), *curves(tree)))


def _drivers(tree: bpy.types.NodeTree) -> list[bpy.types.FCurve]:
    return list(tree.animation_data.drivers) if tree.animation_data else []


def curves(owner: bpy.types.ID) -> Iterator[bpy.types.FCurve]:
    """The keyframed values of a data-block, on its own action or in NLA strips."""
    data = owner.animation_data
    if data is None:
        return
    strips = (strip for track in data.nla_tracks for strip in track.strips)
    for action in (data.action, *(strip.action for strip in strips)):
        for layer in action.layers if action else ():
            for strip in layer.strips:
                for bag in strip.channelbags:
                    yield from bag.fcurves
