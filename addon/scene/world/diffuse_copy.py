"""A throw-away copy of a World to be baked: with the light that falls on diffuse surfaces.

To a camera a World may show a backdrop that lights nothing (the *Is Camera Ray* trick), and a bake
is a camera's picture.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy

from ....node_groups import tree as groups
from . import hdri as worlds

DIFFUSE_RAY = {
    "Is Camera Ray": 0.0,
    "Is Shadow Ray": 0.0,
    "Is Diffuse Ray": 1.0,
    "Is Glossy Ray": 0.0,
    "Is Singular Ray": 0.0,
    "Is Reflection Ray": 1.0,
    "Is Transmission Ray": 0.0,
    "Is Volume Scatter Ray": 0.0,
    "Ray Depth": 1.0,
    "Diffuse Depth": 1.0,
    "Glossy Depth": 0.0,
    "Transparent Depth": 0.0,
    "Transmission Depth": 0.0,
    "Portal Depth": 0.0,
}
"""What the Light Path node says where a diffuse surface looks at the sky, as Cycles has it."""


@contextlib.contextmanager
def as_diffuse_sees(world: bpy.types.World, sky: worlds.WorldSky) -> Iterator[bpy.types.World]:
    """A copy of a World as diffuse surfaces see it, gone afterwards with all that it needed."""
    copy = world.copy()
    made: list[bpy.types.ID] = [copy]
    try:
        if hasattr(copy, "cycles_visibility"):
            copy.cycles_visibility.camera = True
            copy.cycles.sampling_method = "NONE"  # of lamps' rays, of which a bake needs none
        output = worlds.output_of(copy)
        if output is not None:
            tree = copy.node_tree
            for other in [n for n in tree.nodes if n.type == "OUTPUT_WORLD" and n != output]:
                tree.nodes.remove(other)
            output.target = "ALL"
            for link in list(output.inputs["Volume"].links):
                tree.links.remove(link)
            _neutralize(tree, sky)
            _as_diffuse(tree, made)
        yield copy
    finally:
        bpy.data.batch_remove(made)


def _neutralize(tree: bpy.types.NodeTree, sky: worlds.WorldSky) -> None:
    """Strength 1, not turned, not developed: by links, which animation cannot overrule."""
    if sky.background is not None:
        one = groups.add(tree, "ShaderNodeValue")
        one.outputs[0].default_value = 1.0
        tree.links.new(one.outputs[0], tree.nodes[sky.background].inputs["Strength"])
    if sky.mapping is not None:
        none = groups.add(tree, "ShaderNodeCombineXYZ", 0.0, 0.0, 0.0)
        tree.links.new(none.outputs[0], tree.nodes[sky.mapping].inputs["Rotation"])
    if sky.texture is not None:
        texture, background = tree.nodes[sky.texture], tree.nodes[sky.background]
        tree.links.new(texture.outputs[0], background.inputs["Color"])


def _as_diffuse(tree: bpy.types.NodeTree, made: list[bpy.types.ID]) -> None:
    """Let Light Path nodes say what they say to a diffuse surface, in copies of groups too."""
    for node in list(tree.nodes):
        if node.type == "GROUP" and node.node_tree is not None and _asks_for_rays(node.node_tree):
            node.node_tree = node.node_tree.copy()
            made.append(node.node_tree)
            _as_diffuse(node.node_tree, made)
        elif node.type == "LIGHT_PATH":
            for socket in node.outputs:
                if socket.name in DIFFUSE_RAY and socket.is_linked:
                    said = groups.add(tree, "ShaderNodeValue").outputs[0]
                    said.default_value = DIFFUSE_RAY[socket.name]
                    for target in [link.to_socket for link in socket.links]:
                        tree.links.new(said, target)


def _asks_for_rays(tree: bpy.types.NodeTree) -> bool:
    return any(
        node.type == "LIGHT_PATH"
        or (node.type == "GROUP" and node.node_tree is not None and _asks_for_rays(node.node_tree))
        for node in tree.nodes
    )
