"""One group of a kind in a file: appending and making local bring further ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import bpy

from ....node_groups import glazing, gloss, skylight_surface, spectral_matrix, spectral_texture
from ....node_groups import tree as groups
from ..lights import lighting
from ..world import light_group, own_worlds

SHARED: dict[str, Callable[[], bpy.types.NodeTree]] = {
    spectral_matrix.KIND: spectral_matrix.ensure,
    spectral_texture.KIND: spectral_texture.ensure,
    glazing.KIND: glazing.ensure,
    **{kind: partial(gloss.ensure, kind) for kind in gloss.KINDS},
}
"""Kinds of which all materials can show the same group."""


def merge() -> None:
    """Let all nodes of this file show one group of each shared kind, at its version.

    Links and values stay. Groups of Worlds that light no scene and no material leave, and what
    nothing shows with them; so do Worlds that we made.
    """
    kinds = [tree[groups.KIND] for tree in bpy.data.node_groups if groups.KIND in tree]
    several = {kind for kind in SHARED if kinds.count(kind) > 1}
    for tree in _own_trees() if several else ():
        for node in tree.nodes:
            if (kind := groups.kind_of(node)) is not None and kind in several:
                groups.show(node, SHARED[kind]())
    for surface in groups.of_kind(skylight_surface.KIND):
        world = skylight_surface.world_of(surface)
        if surface.users == 0 and (world is None or not lighting.scenes_of(world)):
            if world is not None:
                lighting.remove(world)
            light_group.remove(surface)
    groups.prune(skylight_surface.KIND)
    own_worlds.remove_unused()


def _own_trees() -> Iterator[bpy.types.NodeTree]:
    """Node trees that this file may change."""
    for owner in (*bpy.data.materials, *bpy.data.worlds):
        if owner.node_tree is not None and owner.library is None and owner.is_editable:
            yield owner.node_tree
    yield from (tree for tree in bpy.data.node_groups if tree.library is None)
