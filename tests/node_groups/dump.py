"""What is inside of each node group, the same in all Blenders, and its digest in `trees.json`.

python -m spectral_skylight.tests.node_groups.dump          # adds digests of new versions
python -m spectral_skylight.tests.node_groups.dump --print  # all trees, to be compared by diff
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

from spectral_skylight.node_groups import (
    baked_light,
    day_sky,
    glazing,
    gloss,
    light_probe,
    sky_bake,
    sky_instance,
    sky_irradiance,
    skylight_surface,
    spectral_matrix,
    spectral_texture,
)
from spectral_skylight.node_groups import tree as groups

KEPT = Path(__file__).with_name("trees.json")
# Settings that say nothing of what a node computes.
LOOKS = {"location", "location_absolute", "width", "height", "color", "use_custom_color"}
LOOKS |= {"select", "hide", "mute", "show_options", "show_preview", "show_texture", "label"}
LOOKS |= {"warning_propagation", "bl_idname", "bl_label", "bl_icon", "bl_description"}
LOOKS |= {"bl_width_default", "bl_width_min", "bl_width_max", "bl_height_default"}
LOOKS |= {"bl_height_min", "bl_height_max", "name", "color_tag", "bl_static_type"}

ALWAYS = {"input_type"}  # settings whose default is another in Blender 4.5
RENAMED = {"Fac": "Factor"}  # sockets by their names from Blender 5.0 on


def every_tree() -> Iterator[bpy.types.NodeTree]:
    """One group of each kind and variant, in files of their own."""
    bpy.ops.wm.read_homefile(use_empty=True)
    for module in (
        baked_light,
        day_sky,
        glazing,
        light_probe,
        sky_bake,
        sky_instance,
        spectral_matrix,
        spectral_texture,
    ):
        yield module.ensure()
    yield sky_bake.ensure_day()
    for kind in gloss.KINDS:
        yield gloss.ensure(kind)
    yield sky_irradiance.ensure()
    yield sky_irradiance.ensure(None, sky_irradiance.GROUND, sky_irradiance.GROUND_DEGREE)
    for parts in itertools.product(("open", "baked", "dome"), *[(False, True)] * 2):
        bpy.ops.wm.read_homefile(use_empty=True)
        world = bpy.data.worlds.new("World")
        features = skylight_surface.Features(*parts)
        yield skylight_surface.ensure(world, "color[0]", "color", features=features)


def dump(tree: bpy.types.NodeTree) -> dict[str, Any]:
    """Sockets, nodes, settings, values, links and drivers; no descriptions and no places."""
    fresh = bpy.data.node_groups.new("Fresh", tree.bl_idname)
    content = {
        "kind": tree[groups.KIND],
        "version": tree[groups.VERSION],
        "variant": tree[groups.VARIANT],
        "sockets": [
            [item.in_out, item.name, item.socket_type, _plain(getattr(item, "default_value", None))]
            for item in tree.interface.items_tree
        ],
        "nodes": {node.name: _node(node, fresh) for node in tree.nodes},
        "links": sorted(
            [each for s in (link.from_socket, link.to_socket) for each in (s.node.name, _place(s))]
            for link in tree.links
        ),
        "drivers": sorted(map(_driver, tree.animation_data.drivers)) if tree.animation_data else [],
    }
    bpy.data.node_groups.remove(fresh)
    return content


def name_of(content: dict[str, Any]) -> str:
    """Kind, version and variant of a dumped group."""
    return f"{content['kind']} {content['version']} {content['variant']}".strip()


def digest(content: dict[str, Any]) -> str:
    """What differs where two dumps do."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def _node(node: bpy.types.Node, fresh: bpy.types.NodeTree) -> dict[str, Any]:
    """A node's type, and what it has otherwise than a new one of its type and settings."""
    new = fresh.nodes.new(node.bl_idname)
    settings = {}
    for setting in node.bl_rna.properties:
        name = setting.identifier
        if setting.is_readonly or name in LOOKS or setting.type in ("POINTER", "COLLECTION"):
            continue
        value = getattr(node, name)
        if name in ALWAYS or value != getattr(new, name):
            settings[name] = _plain(value)
            setattr(new, name, value)
    group = getattr(node, "node_tree", None)
    if group is not None:
        settings["group"] = group[groups.KIND]
        new.node_tree = group
    before = _values(new)
    linked = {_place(socket) for socket in node.inputs if socket.is_linked}
    values = {
        place: value
        for place, value in _values(node).items()
        if place not in linked and value != before.get(place)
    }
    return {"type": node.bl_idname, "settings": settings, "values": values}


def _values(node: bpy.types.Node) -> dict[str, Any]:
    used = (s for s in node.inputs if s.enabled and hasattr(s, "default_value"))
    return {_place(socket): _plain(socket.default_value) for socket in used}


def _place(socket: bpy.types.NodeSocket) -> str:
    """A socket's name and its number among those of that name: identifiers change with Blender."""
    side = socket.node.outputs if socket.is_output else socket.node.inputs
    like = (socket.name, socket.enabled)
    same = [each for each in side if (each.name, each.enabled) == like]
    return f"{RENAMED.get(socket.name, socket.name)} {same.index(socket)}"


def _driver(curve: bpy.types.FCurve) -> list[Any]:
    lines = [_plain(modifier.coefficients) for modifier in curve.modifiers]
    lines = [line for line in lines if line != [0.0, 1.0]]  # y = x, which each has in Blender 4.5
    target = curve.driver.variables[0].targets[0]
    return [curve.data_path, curve.array_index, curve.driver.type, target.data_path, lines]


def _plain(value: Any) -> Any:
    """What JSON can hold; floats as float32 shows them."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if hasattr(value, "__len__"):
        return [_plain(part) for part in value]
    return type(value).__name__


def main() -> None:
    kept = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    found = {}
    for tree in every_tree():
        content = dump(tree)
        if "--print" in sys.argv:
            print(json.dumps(content, indent=1, sort_keys=True))
        found[name_of(content)] = digest(content)
    changed = [name for name in found.keys() & kept.keys() if found[name] != kept[name]]
    for name in sorted(changed):
        print(f"{name} has changed: raise its VERSION, or remove its line if no file has it yet")
    if not changed and "--print" not in sys.argv:
        KEPT.write_text(json.dumps({**kept, **found}, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # Blender before 5.0 can crash at exit
