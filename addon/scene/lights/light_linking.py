"""Which objects the lamps of our light probe shine on: those whose materials are managed.

Light linking goes by objects, not by materials, and the probe's lamps would burn out whatever else
scatters their light.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ... import tags

_NO_DIFFUSE = {"BSDF_TRANSPARENT", "BSDF_REFRACTION", "BSDF_GLASS", "BSDF_GLOSSY", "BSDF_METALLIC"}
_NO_DIFFUSE |= {"BSDF_ANISOTROPIC", "EMISSION", "HOLDOUT", "MIX_SHADER", "ADD_SHADER"}
"""Shaders that a lamp without a specular share does not light in Eevee."""


_SOLID = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME"}


def find(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """The collection of a scene's receivers, None before it has one."""
    linked = (obj.light_linking.receiver_collection for obj in scene.objects if obj.type == "LIGHT")
    return next((c for c in linked if c is not None and tags.RECEIVERS in c), None)


def ensure(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The collection of a scene's receivers, brought up to date; it is in no scene itself."""
    collection = shared = find(scene)
    if collection is None or _is_anothers(collection, scene):
        collection = bpy.data.collections.new("Skylight Receivers")
        collection[tags.RECEIVERS] = True
        for lamp in _lamps(scene, shared) if shared is not None else ():
            lamp.light_linking.receiver_collection = collection
    wanted = {obj for obj, parts in _shown(scene).items() if _receives(parts)}
    for obj in set(collection.objects) - wanted:
        collection.objects.unlink(obj)
    for obj in wanted - set(collection.objects):
        collection.objects.link(obj)
    return collection


def _is_anothers(collection: bpy.types.Collection, scene: bpy.types.Scene) -> bool:
    """Whether lamps of another scene have this collection: before 5.2 a full copy's have."""
    own = set(_lamps(scene, collection))
    return any(set(_lamps(other, collection)) - own for other in bpy.data.scenes if other != scene)


def _lamps(scene: bpy.types.Scene, collection: bpy.types.Collection) -> list[bpy.types.Object]:
    lamps = (obj for obj in scene.objects if obj.type == "LIGHT")
    return [lamp for lamp in lamps if lamp.light_linking.receiver_collection == collection]


def mixed(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Objects that get neither sun nor lamps: beside managed materials they have others."""
    return [
        obj
        for obj, parts in _shown(scene).items()
        if any(map(_has_managed, parts)) and not _receives(parts)
    ]


def _shown(scene: bpy.types.Scene) -> dict[bpy.types.Object, set[bpy.types.Object]]:
    """Of each object of a scene what it shows: itself and its instances, whatever makes them.

    Light linking of an instance goes by the object that makes it. Only of the active scene are
    instances known that modifiers make.
    """
    shown = {obj: {obj} if obj.type in _SOLID else set() for obj in scene.objects}
    for obj, parts in shown.items():
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            inside = obj.instance_collection.all_objects
            parts.update(part for part in inside if part.type in _SOLID)
    if scene == bpy.context.scene:
        for instance in bpy.context.evaluated_depsgraph_get().object_instances:
            if instance.is_instance and instance.object.type in _SOLID:
                by = instance.parent.original
                shown.setdefault(by, set()).add(instance.object.original)
    return shown


def _receives(parts: set[bpy.types.Object]) -> bool:
    """Whether things that are shown have managed materials and no others."""
    return any(map(_has_managed, parts)) and not any(map(_burns, parts))


def _is_managed(material: bpy.types.Material | None) -> bool:
    return material is not None and tags.MATERIAL in material


def _has_managed(obj: bpy.types.Object) -> bool:
    return any(_is_managed(slot.material) for slot in _slots(obj))


def _slots(obj: bpy.types.Object) -> Sequence[bpy.types.MaterialSlot]:
    """Its slots as modifiers leave them, which may bring materials along."""
    if not obj.modifiers:
        return obj.material_slots
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).material_slots


def _burns(obj: bpy.types.Object) -> bool:
    """Whether an object shows a material that is not managed and scatters light."""
    if obj.type == "MESH" and not obj.data.polygons and not obj.modifiers:
        return False
    slots = [slot.material for slot in _slots(obj)]
    if not slots:
        return True  # Blender's grey
    shown = range(len(slots))
    if obj.type == "MESH" and obj.data.polygons and not obj.modifiers:
        index = np.empty(len(obj.data.polygons), np.int32)
        obj.data.polygons.foreach_get("material_index", index)
        shown = np.unique(np.minimum(index, len(slots) - 1)).tolist()
    return any(not _is_managed(slots[k]) and _scatters(slots[k]) for k in shown)


def _scatters(material: bpy.types.Material | None) -> bool:
    if material is None or material.node_tree is None:
        return True
    output = material.node_tree.get_output_node("EEVEE")
    shaders = {
        node.type
        for node in material.node_tree.nodes
        if any(socket.type == "SHADER" for socket in node.outputs)
    }
    return output is not None and bool(shaders - _NO_DIFFUSE)
