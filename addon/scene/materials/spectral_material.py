"""Putting the sky's spectral light on materials, and taking it off again without a trace.

Only the Surface input of the active Material Outputs is touched. What is needed to undo lies in the
material itself, as custom properties of the material and its nodes: they survive renaming, copying,
saving and undo. A copy of a managed material is managed too, on its own.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import skylight_surface, spectral_matrix, spectral_texture
from ....node_groups import tree as groups
from ...errors import InputError
from ..blend_data import nodes
from ..lights import lighting
from ..world import light_group
from . import saved_settings, shader_rewrite
from .shader_rewrite import OURS

OUTPUT = "spectral_skylight_output"  # on an output: the number under which …
SOURCE = "spectral_skylight_source"  # … the node that fed it remembers its socket

ENGINES = ("EEVEE", "CYCLES")


@dataclass(frozen=True)
class Managed:
    """What a managed material was given."""

    reflectance_name: str
    reflectance_hash: str
    version: int
    extra: dict[str, Any]
    matrix: list[list[float]]
    world: bpy.types.World | None


def apply(
    material: bpy.types.Material,
    world: bpy.types.World,
    matrix,
    *,
    reflectance_name: str,
    reflectance_hash: str,
    extra: dict[str, Any] | None = None,
    reflected: Mapping[str, Sequence[float]] | None = None,
    gloss: bool = False,
    textured: bool = False,
    group: bpy.types.NodeTree | None = None,
) -> None:
    """Light a material by the sky of a World through its matrix (3, 3); twice is once.

    Its Normal and Alpha stay what the replaced shader had. `extra` is kept with the material
    (anything that JSON can hold). ``reflected``: what it reflects of `skylight_surface.LIGHTS`, RGB
    each. ``gloss``: its gloss and metal stay too; ``textured``: the texture of its base colour
    makes its reflectance, by what `set_texture` is told. ``group``: the World's, just ensured, for
    many materials. Raises InputError for a linked or overridden material and where `hdri.sky_of`
    does; the material is untouched then.
    """
    check_editable(material)
    group = group or light_group.ensure(world)
    node = _surface_node(material)
    kept = material.get(nodes.MANAGED, {})
    shown = shader_rewrite.tops(material.node_tree, node).values() if node is not None else ()
    unplugged = node is not None and not any(socket.is_linked for socket in shown)
    other = (kept.get("gloss", False), kept.get("textured", False)) != (gloss, textured)
    if node is None or unplugged or other:
        remove(material, stays=group)
        node = _take_over(material, group, gloss, textured)
    groups.show(node, group)
    _set(node, matrix, reflected)
    _tell_engines_apart(material.node_tree, node)
    saved_settings.own(material)
    kept = material.get(nodes.MANAGED, {})
    material[nodes.MANAGED] = {
        "id": skylight_surface.KIND,
        "version": skylight_surface.VERSION,
        "reflectance": reflectance_name,
        "reflectance_hash": reflectance_hash,
        "extra": json.dumps(extra or {}),  # custom properties hold no nested lists
        "without_nodes": kept.get("without_nodes", False),
        "gloss": gloss,
        "textured": textured,
    }


def update(
    material: bpy.types.Material, matrix, reflected: Mapping[str, Sequence[float]] | None = None
) -> None:
    """Give a managed material another matrix, as after a change of sky or working space.

    ``reflected`` as in `apply`; what is not named there stays.

    Raises InputError if the material is not managed or not editable.
    """
    check_editable(material)
    node = _surface_node(material)
    if node is None:
        raise InputError(f'material "{material.name}"', "has no reflectance yet", "apply one first")
    _set(node, matrix, reflected)
    _tell_engines_apart(material.node_tree, node)


def look_of(material: bpy.types.Material) -> shader_rewrite.Look:
    """What a material looks like without us; to be used at once, for it holds nodes."""
    outputs = outputs_of(material)
    if not outputs:
        return shader_rewrite.Look(None, rgb=saved_settings.viewport_colour(material)[:3])
    shaders = [source_before(material.node_tree, output) for output in outputs]
    found = shader_rewrite.read(shaders[0])
    own = [o.target.title() for o, s in zip(outputs, shaders, strict=True) if s != shaders[0]]
    return replace(found, left_out=(*found.left_out, *(f"what {name} alone shows" for name in own)))


def outputs_of(material: bpy.types.Material) -> list[bpy.types.Node]:
    """The outputs that the engines showed before us; none of a material without nodes."""
    if material.node_tree is None or without_nodes(material):
        return []
    return [node for node in _outputs(material.node_tree) if OURS not in node]


def without_nodes(material: bpy.types.Material) -> bool:
    """Whether a material has no nodes but ours: Blender 4.5 shows its viewport colour then."""
    if nodes.MANAGED in material:
        return bool(material[nodes.MANAGED].get("without_nodes"))
    return bpy.app.version < (5, 0, 0) and not material.use_nodes


def set_texture(
    material: bpy.types.Material, values: Mapping[str, Any], to_rec709: Any = None
) -> None:
    """Tell a textured material what its texture's red, green and blue reflect of each light.

    ``values``: by the names of `spectral_texture.OUTPUTS`, (3, 3) each; ``to_rec709`` (3, 3): from
    the texture's colours to linear Rec.709.
    """
    node = shader_rewrite.texture_node(material)
    if node is not None:
        spectral_texture.set_values(node, values, to_rec709)


def remove(material: bpy.types.Material, stays: bpy.types.NodeTree | None = None) -> None:
    """Give a material back as it was before `apply`; one that is not managed stays as it is.

    An output that a user has plugged elsewhere since keeps that. The World's groups leave with the
    last material, all but one that ``stays``. Raises InputError for a linked or overridden one.
    """
    if nodes.MANAGED not in material:
        return
    check_editable(material)
    tree = material.node_tree
    node = _surface_node(material)
    for output in [n for n in tree.nodes if OUTPUT in n]:
        surface = output.inputs["Surface"]
        number = str(output[OUTPUT])
        lost = not surface.is_linked
        if lost or OURS in surface.links[0].from_node:
            for link in list(surface.links):
                tree.links.remove(link)
            _plug_back(tree, surface, number)
        del output[OUTPUT]
    group = node.node_tree if node else None
    for added in [n for n in tree.nodes if OURS in n]:
        tree.nodes.remove(added)
    for source in [n for n in tree.nodes if SOURCE in n]:
        del source[SOURCE]
    saved_settings.give_back(material)
    if material[nodes.MANAGED].get("without_nodes"):
        material.use_nodes = False  # Blender 4.5; its tree is then the one that Blender makes
    del material[nodes.MANAGED]
    if group not in (None, stays) and group.users == 0:
        world = skylight_surface.world_of(group)
        if world is not None:
            lighting.remove(world)
        light_group.remove(group)
    if stays is None:
        groups.prune(skylight_surface.KIND)


def is_managed(material: bpy.types.Material | None) -> bool:
    """Whether a material has our surface (also a copy, and one that is linked from a library)."""
    return (
        material is not None and nodes.MANAGED in material and _surface_node(material) is not None
    )


def ours() -> list[bpy.types.Material]:
    """All materials of the file that we changed: managed ones, and panes of glass."""
    return [material for material in bpy.data.materials if nodes.MANAGED in material]


def managed_materials(world: bpy.types.World | None = None) -> list[bpy.types.Material]:
    """All managed materials of the file, or those under one World's sky."""
    found = ((material, managed(material)) for material in bpy.data.materials)
    return [
        material
        for material, given in found
        if given is not None and (world is None or given.world == world)
    ]


def managed(material: bpy.types.Material) -> Managed | None:
    """What a material was given, None if it is not managed."""
    node = _surface_node(material)
    if nodes.MANAGED not in material or node is None:
        return None
    record = material[nodes.MANAGED].to_dict()
    return Managed(
        reflectance_name=record["reflectance"],
        reflectance_hash=record["reflectance_hash"],
        version=record["version"],
        extra=json.loads(record["extra"]),
        matrix=spectral_matrix.get_matrix(node),
        world=skylight_surface.world_of(node.node_tree) if node.node_tree else None,
    )


def kept(material: bpy.types.Material) -> tuple[str, NDArray[np.float64]]:
    """Return a managed material's reflectance, name and values (81,); InputError for another."""
    record = managed(material)
    if record is None:
        raise InputError(f'material "{material.name}"', "has no reflectance yet", "apply one first")
    return record.reflectance_name, np.array(record.extra["values"])


def materials_of(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Material]:
    """The materials in the objects' slots, linked to object or data, each once, in order."""
    slots = (slot.material for obj in objects for slot in obj.material_slots)
    return list(dict.fromkeys(material for material in slots if material is not None))


def check_editable(material: bpy.types.Material) -> None:
    """Raise InputError for a material that cannot be changed in this file."""
    place = f'material "{material.name}"'
    if material.library is not None:
        raise InputError(
            place,
            f'is linked from "{material.library.filepath}"',
            "make it local, or edit it there",
        )
    if material.override_library is not None or not material.is_editable:
        raise InputError(
            place, "is a library override", "make it local, or edit it in its own file"
        )
    record = material.get(nodes.MANAGED, {})
    if record.get("version", 0) > skylight_surface.VERSION:
        raise InputError(place, "was made by a newer version of this add-on", "update the add-on")
    if material.grease_pencil is not None:
        raise InputError(place, "is for Grease Pencil", "choose a surface material")


def _set(node: bpy.types.Node, matrix, reflected: Mapping[str, Sequence[float]] | None) -> None:
    spectral_matrix.set_matrix(node, matrix)
    for name, rgb in (reflected or {}).items():
        node.inputs[name].default_value = tuple(float(part) for part in rgb)


def _surface_node(material: bpy.types.Material) -> bpy.types.Node | None:
    tree = material.node_tree
    found = (n for n in tree.nodes if n.get(OURS) == "surface") if tree else ()
    return next((node for node in found if node.type == "GROUP"), None)


def _outputs(tree: bpy.types.NodeTree) -> list[bpy.types.Node]:
    """The outputs that the engines show: one for both, or one each."""
    found = (tree.get_output_node(engine) for engine in ENGINES)
    return list(dict.fromkeys(node for node in found if node is not None and node.id_data == tree))


def remember(material: bpy.types.Material) -> list[bpy.types.Node]:
    """Keep what `remove` needs to give a material back; return its outputs, still as they were.

    One that has none, or in Blender 4.5 no nodes, is given them.
    """
    bare = without_nodes(material)
    nodes.use(material)
    material[nodes.MANAGED] = {"without_nodes": bare}
    tree = material.node_tree
    outputs = _outputs(tree)
    if not outputs:
        outputs = [groups.add(tree, "ShaderNodeOutputMaterial")]
        outputs[0][OURS] = "output"
    for number, output in enumerate(outputs):
        surface = output.inputs["Surface"]
        output[OUTPUT] = number
        if surface.is_linked:
            link = surface.links[0]
            memory = dict(link.from_node.get(SOURCE, {}))
            memory[str(number)] = [link.from_socket.identifier, str(int(link.is_muted))]
            link.from_node[SOURCE] = memory
    return outputs


def _take_over(
    material: bpy.types.Material, group: bpy.types.NodeTree, gloss: bool, textured: bool
) -> bpy.types.Node:
    outputs = remember(material)
    tree = material.node_tree
    node = groups.add(tree, "ShaderNodeGroup", node_tree=group, name=group.name, label=group.name)
    node[OURS] = "surface"
    node.location = outputs[0].location.x - 40, outputs[0].location.y + 260
    before = shader_rewrite.read(nodes.source(outputs[0].inputs["Surface"]))
    shader_rewrite.dress(material, node, before, None if gloss else shader_rewrite.MATT, textured)
    return node


def _tell_engines_apart(tree: bpy.types.NodeTree, node: bpy.types.Node) -> None:
    """Give Cycles an output of its own where the light probe, which only Eevee knows, is in use."""
    apart = skylight_surface.features_of(node.node_tree).probe
    outputs = _outputs(tree)
    added = next((n for n in tree.nodes if n.get(OURS) == "Cycles"), None)
    if not apart and added is not None:
        tree.nodes.remove(added)
    elif apart and added is None and len(outputs) == 1 and outputs[0].target == "ALL":
        added = groups.add(tree, "ShaderNodeOutputMaterial", target="CYCLES")
        added[OURS] = "Cycles"
        added.location = outputs[0].location.x, outputs[0].location.y + 160
        for name in ("Volume", "Displacement"):
            if (fed := outputs[0].inputs[name]).is_linked:
                tree.links.new(fed.links[0].from_socket, added.inputs[name])
    for output in _outputs(tree):
        if OUTPUT in output or OURS in output:
            name = "Cycles" if output.target == "CYCLES" else "Shader"
            tree.links.new(shader_rewrite.tops(tree, node)[name], output.inputs["Surface"])


def source_before(tree: bpy.types.NodeTree, output: bpy.types.Node) -> bpy.types.NodeSocket | None:
    """What feeds an output, or fed it before we did."""
    number = str(output.get(OUTPUT))
    for source in tree.nodes:
        if number in source.get(SOURCE, {}):
            identifier = source[SOURCE][number][0]
            return next((s for s in source.outputs if s.identifier == identifier), None)
    return nodes.source(output.inputs["Surface"])


def _plug_back(tree: bpy.types.NodeTree, surface: bpy.types.NodeSocket, number: str) -> None:
    for source in tree.nodes:
        if number not in source.get(SOURCE, {}):
            continue
        identifier, muted = source[SOURCE][number]
        for socket in source.outputs:
            if socket.identifier == identifier:
                tree.links.new(socket, surface).is_muted = muted == "1"
                return
