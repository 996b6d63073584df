"""Putting the sky's spectral light on materials, and taking it off again without a trace.

Only the Surface input of the active Material Outputs is touched. What is needed to undo lies in the
material itself, as custom properties of the material and its nodes: they survive renaming, copying,
saving and undo. A copy of a managed material is managed too, on its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import skylight_surface, spectral_matrix, spectral_texture
from ....node_groups import tree as groups
from ... import tags
from ...errors import InputError
from ..blend_data import kept, nodes
from ..lights import lighting
from ..world import light_group
from . import material_outputs, saved_settings, shader_rewrite
from .record import Details, MaterialRecord


@dataclass(frozen=True, eq=False)
class Surface:
    """What a material's shader is to show, and what is kept of it.

    ``matrix`` (3, 3): of the working space; ``reflected``: what it reflects of
    `skylight_surface.LIGHTS`, RGB each; ``name``, ``hash`` and ``details``: of its reflectance, for
    the record; ``gloss``: its gloss and metal stay too; ``textured``: the texture of its base color
    makes its reflectance, by what `set_texture` is told.
    """

    matrix: NDArray[np.float64]
    name: str = ""
    hash: str = ""
    details: Details = field(default_factory=Details)
    reflected: Mapping[str, Sequence[float]] = field(default_factory=dict)
    gloss: bool = False
    textured: bool = False


@dataclass(frozen=True)
class Managed:
    """What a managed material was given, its matrix as its nodes hold it, and its World."""

    record: MaterialRecord
    matrix: list[list[float]]
    world: bpy.types.World | None

    @property
    def details(self) -> Details:
        """What its record holds beside names."""
        return self.record.details

    @property
    def values(self) -> NDArray[np.float64]:
        """Its reflectance, (81,); empty in files of the first version."""
        return np.array(self.details.values)


def apply(
    material: bpy.types.Material,
    world: bpy.types.World,
    surface: Surface,
    group: bpy.types.NodeTree | None = None,
) -> None:
    """Light a material by the sky of a World; twice is once.

    Its Normal and Alpha stay what the replaced shader had. ``group``: the World's, just ensured,
    for many materials. Raises InputError for a linked or overridden material and where
    `hdri.sky_of` does; the material is untouched then.
    """
    check_editable(material)
    group = group or light_group.ensure(world)
    node = surface_node(material)
    before = kept.mapping(material, tags.MATERIAL)
    wanted = surface.gloss, surface.textured
    if (
        node is None
        or not is_shown(material)
        or (before.get("gloss"), before.get("textured")) != wanted
    ):
        remove(material, stays=group)
        node = _take_over(material, group, *wanted)
    groups.show(node, group)
    _set(node, surface.matrix, surface.reflected)
    _tell_engines_apart(material.node_tree, node)
    saved_settings.own(material)
    MaterialRecord(
        surface.name,
        surface.hash,
        surface.details,
        without_nodes=bool(kept.mapping(material, tags.MATERIAL).get("without_nodes")),
        gloss=surface.gloss,
        textured=surface.textured,
    ).keep(material)


def update(
    material: bpy.types.Material, matrix, reflected: Mapping[str, Sequence[float]] | None = None
) -> None:
    """Give a managed material another matrix, as after a change of sky or working space.

    ``reflected`` as in `apply`; what is not named there stays.

    Raises InputError if the material is not managed or not editable.
    """
    check_editable(material)
    node = surface_node(material)
    if node is None:
        raise InputError(f'material "{material.name}"', "has no reflectance yet", "apply one first")
    _set(node, matrix, reflected)
    _tell_engines_apart(material.node_tree, node)


def set_color(material: bpy.types.Material, rgb: Sequence[float]) -> None:
    """Give a managed material the RGB (3,) that Cycles multiplies light by where it traces it."""
    node = surface_node(material)
    if node is not None:
        node.inputs[skylight_surface.COLOR].default_value = tuple(float(part) for part in rgb)


def look_of(material: bpy.types.Material) -> shader_rewrite.Look:
    """What a material looks like without us; to be used at once, for it holds nodes."""
    outputs = material_outputs.before(material)
    if not outputs:
        return shader_rewrite.Look(None, rgb=saved_settings.viewport_colour(material)[:3])
    shaders = [material_outputs.source_before(material.node_tree, output) for output in outputs]
    found = shader_rewrite.read(shaders[0])
    own = [o.target.title() for o, s in zip(outputs, shaders, strict=True) if s != shaders[0]]
    return replace(found, left_out=(*found.left_out, *(f"what {name} alone shows" for name in own)))


def set_texture(
    material: bpy.types.Material, values: Mapping[str, Any], to_rec709: Any = None
) -> None:
    """Tell a textured material what its texture's red, green and blue reflect of each light.

    ``values``: by the names of `spectral_texture.OUTPUTS`, (3, 3) each; ``to_rec709`` (3, 3): from
    the texture's colours to linear Rec.709.
    """
    node = shader_rewrite.texture_node(material)
    if node is None:
        return
    spectral_texture.set_values(node, values, to_rec709)
    surface = surface_node(material)
    if surface is None:
        return
    for name in spectral_texture.OUTPUTS:
        if not surface.inputs[name].is_linked:  # in a file of an earlier version
            material.node_tree.links.new(node.outputs[name], surface.inputs[name])


def remove(material: bpy.types.Material, stays: bpy.types.NodeTree | None = None) -> None:
    """Give a material back as it was before `apply`; one that is not managed stays as it is.

    An output that a user has plugged elsewhere since keeps that. The World's groups leave with the
    last material, all but one that ``stays``. Raises InputError for a linked or overridden one.
    """
    if tags.MATERIAL not in material:
        return
    check_editable(material)
    tree = material.node_tree
    node = surface_node(material)
    material_outputs.give_back(tree)
    group = node.node_tree if node else None
    for added in [n for n in tree.nodes if tags.NODE in n]:
        tree.nodes.remove(added)
    material_outputs.forget(tree)
    saved_settings.give_back(material)
    if kept.mapping(material, tags.MATERIAL).get("without_nodes"):
        material.use_nodes = False  # Blender 4.5; its tree is then the one that Blender makes
    del material[tags.MATERIAL]
    if group not in (None, stays) and group.users == 0:
        world = skylight_surface.world_of(group)
        if world is not None:
            lighting.remove(world)
        light_group.remove(group)
    if stays is None:
        groups.prune(skylight_surface.KIND)


def is_managed(material: bpy.types.Material | None) -> bool:
    """Whether a material has our surface (also a copy, and one that is linked from a library)."""
    return material is not None and managed(material) is not None


def ours() -> list[bpy.types.Material]:
    """All materials of the file that we changed: managed ones, and panes of glass."""
    return [material for material in bpy.data.materials if tags.MATERIAL in material]


def managed_materials(world: bpy.types.World | None = None) -> list[bpy.types.Material]:
    """All managed materials of the file, or those under one World's sky."""
    found = ((material, managed(material)) for material in bpy.data.materials)
    return [
        material
        for material, given in found
        if given is not None and (world is None or given.world == world)
    ]


def hash_of(material: bpy.types.Material) -> str:
    """The hash of a material's reflectance, empty where it has none of ours."""
    record = MaterialRecord.of(material)
    return "" if record is None else record.reflectance_hash


def managed(material: bpy.types.Material) -> Managed | None:
    """What a material was given, None if it is not managed."""
    record, node = MaterialRecord.of(material), surface_node(material)
    if record is None or node is None or not spectral_matrix.is_whole(node):
        return None
    world = skylight_surface.world_of(node.node_tree) if node.node_tree else None
    return Managed(record, spectral_matrix.get_matrix(node), world)


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
    version = kept.mapping(material, tags.MATERIAL).get("version", 0)
    if kept.is_number(version) and version > skylight_surface.VERSION:
        raise InputError(place, "was made by a newer version of this add-on", "update the add-on")
    if material.grease_pencil is not None:
        raise InputError(place, "is for Grease Pencil", "choose a surface material")


def _set(node: bpy.types.Node, matrix, reflected: Mapping[str, Sequence[float]] | None) -> None:
    spectral_matrix.set_matrix(node, matrix)
    for name, rgb in (reflected or {}).items():
        node.inputs[name].default_value = tuple(float(part) for part in rgb)


def is_shown(material: bpy.types.Material) -> bool:
    """Whether our surface feeds an output; a user may have plugged in another shader."""
    node = surface_node(material)
    if node is None:
        return False
    return any(top.is_linked for top in shader_rewrite.tops(material.node_tree, node).values())


def surface_node(material: bpy.types.Material) -> bpy.types.Node | None:
    """The `Skylight Surface` node of a material, None without."""
    tree = material.node_tree
    found = (n for n in tree.nodes if n.get(tags.NODE) == "surface") if tree else ()
    return next((node for node in found if node.type == "GROUP"), None)


def _take_over(
    material: bpy.types.Material, group: bpy.types.NodeTree, gloss: bool, textured: bool
) -> bpy.types.Node:
    outputs = material_outputs.remember(material)
    tree = material.node_tree
    node = groups.add(tree, "ShaderNodeGroup", node_tree=group, name=group.name, label=group.name)
    node[tags.NODE] = "surface"
    node.location = outputs[0].location.x - 40, outputs[0].location.y + 260
    before = shader_rewrite.read(nodes.source(outputs[0].inputs["Surface"]))
    shader_rewrite.dress(material, node, before, None if gloss else shader_rewrite.MATT, textured)
    return node


def _tell_engines_apart(tree: bpy.types.NodeTree, node: bpy.types.Node) -> None:
    """Give Cycles an output of its own where the light probe, which only Eevee knows, is in use,
    where it traces the light, and over gloss, of which Eevee alone lacks some."""
    apart = skylight_surface.features_of(node.node_tree).probe
    apart |= skylight_surface.is_traced(node.node_tree)
    apart |= any(n.get(tags.NODE) == "gloss" and "Base" in n.inputs for n in tree.nodes)
    outputs = material_outputs.shown(tree)
    added = next((n for n in tree.nodes if n.get(tags.NODE) == "Cycles"), None)
    if not apart and added is not None:
        tree.nodes.remove(added)
    elif apart and added is None and len(outputs) == 1 and outputs[0].target == "ALL":
        added = groups.add(tree, "ShaderNodeOutputMaterial", target="CYCLES")
        added[tags.NODE] = "Cycles"
        added.location = outputs[0].location.x, outputs[0].location.y + 160
        for name in ("Volume", "Displacement"):
            if (fed := outputs[0].inputs[name]).is_linked:
                tree.links.new(fed.links[0].from_socket, added.inputs[name])
    for output in material_outputs.shown(tree):
        if tags.OUTPUT in output or tags.NODE in output:
            name = "Cycles" if output.target == "CYCLES" else "Shader"
            tree.links.new(shader_rewrite.tops(tree, node)[name], output.inputs["Surface"])
