"""What a node tree would render, as a key: equal keys, equal pixels."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

_APART = {"rna_type", "id_data", "links", "internal_links", "from_node", "to_node", "node"}
"""What is no value of a node or socket, or is written down apart."""
_LOOKS = {"name", "label", "location", "location_absolute", "width", "height", "select", "parent"}
_LOOKS |= {"color", "use_custom_color", "dimensions", "color_tag", "warning_propagation", "hide"}
_LOOKS |= {"show_options", "show_preview", "show_texture"}
"""What of a node is for the eye alone."""

_DEPTH = 6  # of structures in structures: a curve's points have 4


def key(tree: bpy.types.NodeTree | None, *more: Any) -> str:
    """The key of all values, links, images and nested groups of a tree, and of ``more``."""
    digest = hashlib.sha256(repr(more).encode())
    for part in _tree(tree) if tree is not None else ():
        digest.update(part)
    return digest.hexdigest()


def moves(owner: bpy.types.ID) -> bool:
    """Whether a World or tree changes with the frame: animation, here and in groups, or a film."""
    data, tree = owner.animation_data, getattr(owner, "node_tree", None)
    if data is not None and (data.action or data.drivers or data.nla_tracks):
        return True
    inside = [tree] if tree is not None else []
    for node in getattr(owner, "nodes", ()):
        image = getattr(node, "image", None)
        if image is not None and image.source in ("SEQUENCE", "MOVIE"):
            return True
        if node.type == "GROUP" and node.node_tree is not None:
            inside.append(node.node_tree)
    return any(map(moves, inside))


def _tree(tree: bpy.types.NodeTree) -> Iterator[bytes]:
    number = {node: k for k, node in enumerate(tree.nodes)}
    for node in tree.nodes:
        yield node.bl_idname.encode()
        yield from _values(node, 0)
    for link in tree.links:
        ends = (link.from_node, link.from_socket), (link.to_node, link.to_socket)
        said = [(number[node], socket.identifier) for node, socket in ends]
        yield repr((said, link.is_muted)).encode()


def _values(thing: bpy.types.bpy_struct, depth: int) -> Iterator[bytes]:
    for prop in thing.bl_rna.properties:
        name = prop.identifier
        if name in _APART or depth > _DEPTH or (depth == 0 and name in _LOOKS):
            continue
        value = getattr(thing, name)
        yield name.encode()
        if prop.type == "COLLECTION":
            for item in value:
                if not _overruled(item):
                    yield from _values(item, depth + 1)
        elif isinstance(value, bpy.types.ID):
            yield from _block(value)
        elif isinstance(value, bpy.types.bpy_struct):
            yield from _values(value, depth + 1)
        elif getattr(prop, "is_array", False):
            yield repr(np.ravel(value).tolist()).encode()
        else:
            yield repr(value).encode()


def _overruled(thing: bpy.types.bpy_struct) -> bool:
    """Whether something is an input whose own value does not count."""
    if not isinstance(thing, bpy.types.NodeSocket) or thing.is_output or not thing.is_linked:
        return False
    return not thing.links[0].is_muted


def _block(block: bpy.types.ID) -> Iterator[bytes]:
    """What of a datablock that a node names decides its output."""
    if isinstance(block, bpy.types.NodeTree):
        yield from _tree(block)
    elif isinstance(block, bpy.types.Image):
        yield from _image(block)
    elif isinstance(block, bpy.types.Object):
        yield repr([list(row) for row in block.matrix_world]).encode()
    elif isinstance(block, bpy.types.Text):
        yield block.as_string().encode()
    else:
        yield block.name_full.encode()


def _image(image: bpy.types.Image) -> Iterator[bytes]:
    tag = image.colorspace_settings
    yield repr((image.source, tag.name, image.alpha_mode, list(image.size))).encode()
    if image.packed_file is not None:
        yield image.packed_file.data
    elif image.source == "GENERATED" or image.is_dirty:
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        yield pixels.tobytes()
    else:
        file = Path(bpy.path.abspath(image.filepath, library=image.library))
        found = file.stat() if file.is_file() else None
        yield repr((str(file), found and (found.st_mtime_ns, found.st_size))).encode()
