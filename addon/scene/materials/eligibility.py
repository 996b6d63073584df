"""Which materials can be made spectral without asking, and why the others are left alone.

An emitter's light, what glass and volumes let through and the hole of a holdout have no diffuse
reflectance that a base colour could tell. Only node trees are read; nothing changes.
"""

from __future__ import annotations

import bpy
from bpy.types import Node
from bpy.types import NodeSocket as Socket

from ...errors import InputError
from ..blend_data import nodes
from . import material_outputs, shader_rewrite, spectral_material

VOLUMES = {"PRINCIPLED_VOLUME", "VOLUME_ABSORPTION", "VOLUME_SCATTER", "VOLUME_COEFFICIENTS"}
HAIR = {"BSDF_HAIR", "BSDF_HAIR_PRINCIPLED"}
THROUGH = {"BSDF_TRANSPARENT"}


def materials_of(scene: bpy.types.Scene) -> list[bpy.types.Material]:
    """The materials that a scene shows: of its objects and of what these instance, each once.

    Only of the active scene is known what modifiers make.
    """
    objects = list(scene.objects)
    for obj in scene.objects:
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            objects += obj.instance_collection.all_objects
    made = set()
    if scene == bpy.context.scene:
        for each in bpy.context.evaluated_depsgraph_get().object_instances:
            data, slots = each.object.data, each.object.material_slots
            used = [*getattr(data, "materials", ()), *(slot.material for slot in slots)]
            made.update(material.original for material in used if material is not None)
    by_name = sorted(made, key=lambda material: material.name_full)
    return list(dict.fromkeys([*spectral_material.materials_of(objects), *by_name]))


def may_show_materials(scene: bpy.types.Scene) -> bool:
    """Whether a scene's objects have materials, or instance or make what may have them.

    Nothing is evaluated, so that a panel can ask at every redraw.
    """
    return any(
        obj.material_slots
        or obj.instance_type != "NONE"
        or any(modifier.type in ("NODES", "PARTICLE_SYSTEM") for modifier in obj.modifiers)
        for obj in scene.objects
    )


def reason(material: bpy.types.Material) -> str:
    """Why a material is left alone, empty where a reflectance can stand for its surface.

    Of a managed one: of what it was before.
    """
    if why := unchangeable(material):
        return why
    outputs = material_outputs.before(material)
    if not outputs:
        return "" if material_outputs.without_nodes(material) else "has no surface shader"
    if any(nodes.source(output.inputs["Volume"]) is not None for output in outputs):
        return "is a volume"
    found = [reason_of(material_outputs.source_before(material.node_tree, out)) for out in outputs]
    return next(filter(None, found), "")


def emits(material: bpy.types.Material) -> bool:
    """Whether a material sends out light of its own, spectral or not."""
    sources = (
        material_outputs.source_before(material.node_tree, output)
        for output in material_outputs.before(material)
    )
    return any(_shines(node) for source in sources for node in nodes.shaders(source))


def unchangeable(material: bpy.types.Material) -> str:
    """Why this file cannot change a material, empty where it can."""
    try:
        spectral_material.check_editable(material)
    except InputError as error:
        return error.problem
    return ""


def reason_of(shader: Socket | None) -> str:
    """Why the shader that feeds an output is none to replace, empty where it is."""
    if shader is None:
        return "has no surface shader"
    leaves = list(nodes.shaders(shader))
    for why, holds in (
        ("is a holdout", lambda node: node.type == "HOLDOUT"),
        ("emits light", _shines),
        ("is glass: choose a transmittance for it", _is_glass),
        ("is a volume", lambda node: node.type in VOLUMES),
        ("is hair", lambda node: node.type in HAIR),
    ):
        if any(holds(node) for node in leaves):
            return why
    seen = shader_rewrite.read(shader)
    if not seen.targets:
        clear = bool(leaves) and all(node.type in THROUGH for node in leaves)
        return "is clear" if clear else "has no base color to estimate a reflectance from"
    if (
        all(node.type in shader_rewrite.METALS for node in seen.targets)
        or seen.kind == shader_rewrite.gloss.METAL
    ):
        return "is a metal: choose a file with its n and k"
    if shader_rewrite.colour_input(seen.targets[0]) is None:
        return f'its "{seen.targets[0].name}" has no base color to estimate a reflectance from'
    return ""


def _shines(node: Node) -> bool:
    if node.type == "BACKGROUND":
        return True
    if node.type == "EMISSION":
        return shader_rewrite.shows(node, "Strength") and _coloured(node.inputs["Color"])
    if "Emission Strength" not in node.inputs:
        return node.type == "EEVEE_SPECULAR" and _coloured(node.inputs["Emissive Color"])
    return shader_rewrite.shows(node, "Emission Strength") and _coloured(
        node.inputs["Emission Color"]
    )


def _coloured(socket: Socket) -> bool:
    return nodes.source(socket) is not None or any(part > 0 for part in socket.default_value[:3])


def _is_glass(node: Node) -> bool:
    return node.type in shader_rewrite.GLASSES or shader_rewrite.shows(node, "Transmission Weight")
