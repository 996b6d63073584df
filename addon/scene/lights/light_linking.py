"""Which objects the lamps of our light probe shine on: those whose materials are managed.

Light linking goes by objects, not by materials, and the probe's lamps would burn out whatever else
scatters their light. What only mirrors it or lets it through is left dark by them, as they have no
specular share: a pane in a house's mesh takes nothing from the house.
"""

from __future__ import annotations

import bpy
import numpy as np

from ... import tags
from ..blend_data import drivers, kept, nodes
from . import rendered_lamps

_NO_DIFFUSE = {"BSDF_TRANSPARENT", "BSDF_REFRACTION", "BSDF_GLASS", "BSDF_GLOSSY", "BSDF_METALLIC"}
_NO_DIFFUSE |= {"BSDF_ANISOTROPIC", "EMISSION", "HOLDOUT", "BACKGROUND", "GROUP"}
"""Shaders that a lamp without a specular share does not light in Eevee; of a group what is inside
counts."""

_OURS = (tags.RECEIVERS, tags.LINKED, tags.PANES)
"""Tags of collections that lamps of ours are linked to."""

_SOLID = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME"}


def find(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """The collection of a scene's receivers, None before it has one."""
    lamps = (obj for obj in scene.objects if obj.type == "LIGHT")
    return next((c for c in map(_receivers_of, lamps) if c is not None), None)


def _receivers_of(lamp: bpy.types.Object) -> bpy.types.Collection | None:
    """The collection of ours that a lamp shines on, or on a part of; None of a user's lamp."""
    own = lamp.light_linking.receiver_collection
    if own is None or tags.RECEIVERS in own:
        return own
    return kept.data(own, tags.LINKED, bpy.types.Collection)


def ensure(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The collection of a scene's receivers, brought up to date; it is in no scene itself."""
    collection = shared = find(scene)
    if collection is None or _is_anothers(collection, scene):
        collection = bpy.data.collections.new("Skylight Receivers")
        collection[tags.RECEIVERS] = True
        for lamp in _lamps(scene, shared) if shared is not None else ():
            lamp.light_linking.receiver_collection = collection
    _fill(collection, {obj for obj, parts in _shown(scene).items() if _receives(parts)}, scene)
    for lamp in _lamps(scene, collection):
        _narrow(lamp, collection, scene)
    return collection


def _fill(
    collection: bpy.types.Collection, wanted: set[bpy.types.Object], scene: bpy.types.Scene
) -> None:
    """Let a collection hold these objects alone, or a lamp: Blender takes an empty one for none."""
    wanted = wanted or {obj for obj in scene.objects if tags.LAMP in obj}
    for obj in set(collection.objects) - wanted:
        collection.objects.unlink(obj)
    for obj in wanted - set(collection.objects):
        collection.objects.link(obj)


def _narrow(
    lamp: bpy.types.Object, receivers: bpy.types.Collection, scene: bpy.types.Scene
) -> None:
    """Let a twin shine on those receivers alone that its user's lamp is linked to."""
    own = lamp.light_linking.receiver_collection
    user = rendered_lamps.followed(lamp)
    linked = None if user is None else user.light_linking.receiver_collection
    if linked is None:
        if own != receivers:
            lamp.light_linking.receiver_collection = receivers
            bpy.data.collections.remove(own)
        return
    if own == receivers:
        own = bpy.data.collections.new(f"{receivers.name} {lamp.name}")
        own[tags.LINKED] = receivers
        lamp.light_linking.receiver_collection = own
    _fill(own, {obj for obj in receivers.objects if _is_linked(linked, obj)}, scene)


def block(scene: bpy.types.Scene, panes: set[bpy.types.Object]) -> None:
    """Let panes cast no shadow in the light of our lamps, nor what a user's lamp is not linked to.

    In place of what was told before.
    """
    _forget_blockers(scene)
    shared = None
    for lamp in (obj for obj in scene.objects if obj.type == "LIGHT" and tags.LAMP in obj):
        user = rendered_lamps.followed(lamp)
        linked = None if user is None else user.light_linking.blocker_collection
        if linked is not None:
            lamp.light_linking.blocker_collection = _blockers(scene, linked, panes)
        elif panes:
            shared = shared or _blockers(scene, None, panes)
            lamp.light_linking.blocker_collection = shared


def _blockers(
    scene: bpy.types.Scene, linked: bpy.types.Collection | None, panes: set[bpy.types.Object]
) -> bpy.types.Collection:
    """A collection of what blocks: all that a user's does, less panes."""
    made = bpy.data.collections.new("Skylight Panes")
    made[tags.PANES] = scene.name
    included, excluded = ({}, {}) if linked is None else _links(linked)
    if included:
        _fill(made, set(included) - set(excluded) - panes, scene)
        return made
    for obj in {*excluded, *panes}:
        made.objects.link(obj)
    for entry in made.collection_objects:
        entry.light_linking.link_state = "EXCLUDE"
    return made


def _forget_blockers(scene: bpy.types.Scene) -> None:
    told = [c for c in bpy.data.collections if c.get(tags.PANES) == scene.name]
    bpy.data.batch_remove(told)


def forget_unused() -> None:
    """Take away collections of ours that no lamp is linked to any more."""
    used = set()
    for lamp in (obj for obj in bpy.data.objects if obj.type == "LIGHT"):
        linking = lamp.light_linking
        used |= {linking.receiver_collection, linking.blocker_collection, _receivers_of(lamp)}
    ours = (c for c in bpy.data.collections if any(tag in c for tag in _OURS))
    bpy.data.batch_remove([each for each in ours if each not in used])


def _is_linked(collection: bpy.types.Collection, obj: bpy.types.Object) -> bool:
    """Whether light that is linked to a collection reaches an object: what is excluded it never
    does, and if anything is included, nothing else."""
    included, excluded = _links(collection)
    return obj not in excluded and (not included or obj in included)


def _links(
    collection: bpy.types.Collection,
) -> tuple[dict[bpy.types.Object, None], dict[bpy.types.Object, None]]:
    """The objects that a collection includes and those that it excludes, in order."""
    found: dict[str, dict[bpy.types.Object, None]] = {"INCLUDE": {}, "EXCLUDE": {}}
    for obj, entry in zip(collection.objects, collection.collection_objects, strict=True):
        found[entry.light_linking.link_state][obj] = None
    for child, entry in zip(collection.children, collection.collection_children, strict=True):
        found[entry.light_linking.link_state].update(dict.fromkeys(child.all_objects))
    return found["INCLUDE"], found["EXCLUDE"]


def _is_anothers(collection: bpy.types.Collection, scene: bpy.types.Scene) -> bool:
    """Whether lamps of another scene have this collection: before 5.2 a full copy's have."""
    own = set(_lamps(scene, collection))
    return any(set(_lamps(other, collection)) - own for other in bpy.data.scenes if other != scene)


def _lamps(scene: bpy.types.Scene, collection: bpy.types.Collection) -> list[bpy.types.Object]:
    lamps = (obj for obj in scene.objects if obj.type == "LIGHT")
    return [lamp for lamp in lamps if _receivers_of(lamp) == collection]


def mixed(scene: bpy.types.Scene) -> dict[bpy.types.Object, list[str]]:
    """Objects that get neither sun nor lamps, and the names of what they show beside managed
    materials that scatters light, sorted; "" for a face without a material."""
    found = {}
    for obj, parts in _shown(scene).items():
        if any(map(_has_managed, parts)):
            burnt = {name for part in parts for name in _burnt(part)}
            if burnt:
                found[obj] = sorted(burnt)
    return found


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
    """Whether things that are shown have managed materials and none that the lamps burn out."""
    return any(map(_has_managed, parts)) and not any(map(_burnt, parts))


def _is_managed(material: bpy.types.Material | None) -> bool:
    return material is not None and tags.MATERIAL in material


def _has_managed(obj: bpy.types.Object) -> bool:
    return any(_is_managed(slot.material) for slot in _as_shown(obj).material_slots)


def _as_shown(obj: bpy.types.Object) -> bpy.types.Object:
    """An object as modifiers leave it, which may bring materials along."""
    if not obj.modifiers:
        return obj
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get())


def _burnt(obj: bpy.types.Object) -> set[str]:
    """Names of what an object shows that is not managed and scatters light."""
    shown = _as_shown(obj)
    faces = shown.data.polygons if shown.type == "MESH" and shown.data is not None else None
    slots = [slot.material for slot in shown.material_slots]
    if faces is not None and not len(faces):
        return set()
    if not slots:
        return {""}  # Blender's grey
    used = range(len(slots))
    if faces is not None:
        index = np.empty(len(faces), np.int32)
        faces.foreach_get("material_index", index)
        used = np.unique(np.minimum(index, len(slots) - 1)).tolist()
    found = (slots[k] for k in used if not _is_managed(slots[k]) and _scatters(slots[k]))
    return {"" if material is None else material.name for material in found}


def _scatters(material: bpy.types.Material | None) -> bool:
    """Whether a material shows a lamp that has no specular share, in Eevee."""
    if material is None or material.node_tree is None:
        return True
    output = material.node_tree.get_output_node("EEVEE")
    shader = None if output is None else nodes.source(output.inputs["Surface"])
    return any(map(_is_diffuse, nodes.shaders(shader)))


def _is_diffuse(shader: bpy.types.Node) -> bool:
    if shader.type != "BSDF_PRINCIPLED":
        return shader.type not in _NO_DIFFUSE
    if _at_least(shader.inputs["Sheen Weight"], 1e-6, or_moves=True):
        return True
    return not any(_at_least(shader.inputs[name], 1.0) for name in _WITHOUT_BASE)


_WITHOUT_BASE = ("Metallic", "Transmission Weight")
"""Inputs of a Principled that leave nothing of its diffuse base where they are 1."""


def _at_least(socket: bpy.types.NodeSocket, value: float, or_moves: bool = False) -> bool:
    if nodes.source(socket) is not None or drivers.moves(socket):
        return or_moves
    return socket.default_value >= value
