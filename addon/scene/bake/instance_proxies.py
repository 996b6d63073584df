"""Objects that stand in for the instances of a collection while those are baked.

Instances of one object have its mesh in common, and with it all that a bake could keep. So an Empty
that instances a collection is handed another one, of ours, without what is to be baked, and for
each such thing it gets a child: an object that shows the same geometry in the same place, live, and
that can be baked like any other. Lamps and whatever is not spectral stay instances. `gather` gives
the Empty its collection back and takes all of ours away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product

import bpy
from mathutils import Matrix

from ....node_groups import modifiers, sky_instance
from ....node_groups import tree as groups
from ....node_groups.drivers import drive
from ... import tags
from ..blend_data import kept
from . import storage

SHAPES = {"MESH", "CURVE", "SURFACE", "FONT"}
FLAGS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")

Wanted = Callable[[bpy.types.Object], bool]
Place = tuple[bpy.types.Object, Matrix]


def instances_of(
    obj: bpy.types.Object, there: Sequence[bpy.types.Object] | None = None
) -> bpy.types.Collection | None:
    """The collection that an object instances, as the user gave it; None for any other object.

    ``there``: its stand-ins, where they are known.
    """
    if obj.instance_type != "COLLECTION" or obj.instance_collection is None or tags.REST in obj:
        return None
    if not _is_handed_out(obj):
        return obj.instance_collection
    children = stand_ins(obj) if there is None else there
    found = (modifiers.get_input(modifier_of(child), "Collection") for child in children)
    name = kept.text(obj.instance_collection, tags.REST)
    return next(found, None) or next((c for c in bpy.data.collections if c.name_full == name), None)


def modifier_of(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """The `Sky Instance` modifier of an object, None if it stands in for none."""
    return modifiers.of_kind(obj, sky_instance.KIND)


def stand_ins(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects of ours that stand in for an Empty's instances."""
    # A list that Blender draws up from all objects: only Empties of ours have such children.
    return _sorted(obj.children) if _is_handed_out(obj) else []


def all_stand_ins() -> dict[bpy.types.Object, list[bpy.types.Object]]:
    """`stand_ins` of all Empties that have any: `children` of each would take quadratic time."""
    found: dict[bpy.types.Object, list[bpy.types.Object]] = {}
    for obj in bpy.data.objects:
        if obj.parent is not None and modifier_of(obj) is not None:
            found.setdefault(obj.parent, []).append(obj)
    return {root: _sorted(children) for root, children in found.items()}


def apart(
    objects: Sequence[bpy.types.Object],
) -> tuple[list[bpy.types.Object], list[bpy.types.Object]]:
    """Return those of some objects that are the user's, and those that stand in for instances."""
    ours = [modifier_of(obj) is not None for obj in objects]
    return (
        [obj for obj, our in zip(objects, ours, strict=True) if not our],
        [obj for obj, our in zip(objects, ours, strict=True) if our],
    )


def _sorted(children) -> list[bpy.types.Object]:
    found = [child for child in children if modifier_of(child) is not None]
    return sorted(found, key=lambda child: child.name_full)


def _is_handed_out(obj):
    """Whether an Empty shows a collection of ours instead of its own."""
    collection = obj.instance_collection
    return collection is not None and tags.REST in collection


def is_spread(
    obj: bpy.types.Object, wanted: Wanted, there: Sequence[bpy.types.Object] | None = None
) -> bool:
    """Whether stand-ins (``there``, where known) are all that an Empty's wanted instances need."""
    if not _is_handed_out(obj):
        return False
    children = stand_ins(obj) if there is None else there
    collection = instances_of(obj, children)
    if collection is None:
        return False
    now = [source for source, _ in _places(collection, wanted)]
    shown = [modifiers.get_input(modifier_of(child), "Source") for child in children]
    return sorted(o.name_full for o in now) == sorted(o.name_full if o else "" for o in shown)


def shows(
    obj: bpy.types.Object, wanted: Wanted, there: Sequence[bpy.types.Object] | None = None
) -> bool:
    """Whether an Empty instances something that is wanted."""
    collection = instances_of(obj, there)
    return collection is not None and any(True for _ in _places(collection, wanted))


def spread(objects: Sequence[bpy.types.Object], wanted: Wanted) -> list[bpy.types.Object]:
    """Let stand-ins show what of the instances of Empties is wanted, and return them."""
    there = all_stand_ins()
    old = [obj for obj in objects if not is_spread(obj, wanted, there.get(obj, ()))]
    gather(old)
    bpy.context.view_layer.update()  # once for all: each takes as long as the scene is large
    homes = _homes()
    rests: dict[bpy.types.Collection, bpy.types.Collection] = {}
    for obj in old:
        collection = obj.instance_collection
        made = _spread(obj, obj, collection, Matrix(), wanted, collection, rests)
        for child, home in product(made, homes.get(obj, ())):
            home.objects.link(child)
    bpy.context.view_layer.update()
    there = all_stand_ins()
    return [child for obj in objects for child in there.get(obj, ())]


def _homes() -> dict[bpy.types.Object, list[bpy.types.Collection]]:
    """The collections of the user that objects are in: `users_collection` searches all for each."""
    scenes = [scene.collection for scene in bpy.data.scenes]
    found: dict[bpy.types.Object, list[bpy.types.Collection]] = {}
    for collection in (*scenes, *bpy.data.collections):
        if tags.RECEIVERS not in collection and tags.REST not in collection:
            for obj in collection.objects:
                found.setdefault(obj, []).append(collection)
    return found


def gather(objects: Sequence[bpy.types.Object]) -> None:
    """Give Empties their own collections back, and take away what stood in for them."""
    there = all_stand_ins()
    handed_out = {obj for obj in objects if _is_handed_out(obj)}
    nested = [obj for obj in bpy.data.objects if obj.parent in handed_out and tags.REST in obj]
    rests, gone = set(), []
    for obj in handed_out:
        collection = instances_of(obj, there.get(obj, ()))
        if collection is None:
            continue
        rests.add(obj.instance_collection)
        obj.instance_collection = collection
        gone += there.get(obj, [])
    storage.remove(gone)
    rests |= {obj.instance_collection for obj in nested if obj.instance_collection is not None}
    meshes = [obj.data for obj in gone if obj.data is not None]
    bpy.data.batch_remove([*gone, *nested])
    bpy.data.batch_remove(meshes)
    for rest in rests:
        _forget(rest)
    for tree in groups.of_kind(sky_instance.KIND):
        if tree.users == 0:
            bpy.data.node_groups.remove(tree)


def _places(collection: bpy.types.Collection, wanted: Wanted) -> Iterator[Place]:
    """Yield what of a collection is wanted, and where it stands in it, instances inside followed.

    Of an Empty inside the place holds as it stands now; objects themselves are followed live.
    """
    offset = Matrix.Translation(-collection.instance_offset)
    for source in _shown(collection):
        inside = source.instance_collection if source.instance_type == "COLLECTION" else None
        if inside is not None:
            at = offset @ source.matrix_world
            yield from ((o, at @ m) for o, m in _places(inside, wanted))
        elif source.type in SHAPES and wanted(source):
            yield source, offset


def _shown(collection: bpy.types.Collection) -> Iterator[bpy.types.Object]:
    """Yield the objects of a collection and its children that renders show."""
    if collection.hide_render:
        return
    yield from (obj for obj in collection.objects if not obj.hide_render)
    for child in collection.children:
        yield from _shown(child)


def _spread(parent, root, collection, at, wanted, kept, rests) -> Iterator[bpy.types.Object]:
    """Hand an Empty the rest of a collection, and yield what is put under the root instead.

    ``rests``: those that other Empties were handed just now, by their collections.
    """
    if collection not in rests:
        rests[collection] = _rest(collection, wanted)
    parent.instance_collection = rests[collection]
    at = at @ Matrix.Translation(-collection.instance_offset)
    for source in _shown(collection):
        inside = source.instance_collection if source.instance_type == "COLLECTION" else None
        if inside is not None:
            if not any(True for _ in _places(inside, wanted)):
                continue
            nested = bpy.data.objects.new(source.name, None)
            nested.instance_type, nested.empty_display_size = (
                "COLLECTION",
                source.empty_display_size,
            )
            nested[tags.REST] = source.name_full
            _place(nested, root, at @ source.matrix_world)
            yield nested
            yield from _spread(nested, root, inside, at @ source.matrix_world, wanted, kept, rests)
        elif source.type in SHAPES and wanted(source):
            yield _stand_in(source, root, at, kept)


def _stand_in(source, root, at, kept) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(f"{sky_instance.KIND} {source.name}")
    obj = bpy.data.objects.new(mesh.name, mesh)
    for slot in source.material_slots:
        mesh.materials.append(slot.material)
    _place(obj, root, at)
    # Where the source stands in its collection, now and when it moves.
    constraint = obj.constraints.new("COPY_TRANSFORMS")
    constraint.target, constraint.owner_space = source, "LOCAL"
    for slot, own in zip(source.material_slots, obj.material_slots, strict=True):
        own.link = slot.link
        own.material = slot.material
    for flag in FLAGS:
        setattr(obj, f"visible_{flag}", getattr(source, f"visible_{flag}"))
    obj.is_holdout, obj.is_shadow_catcher = source.is_holdout, source.is_shadow_catcher
    obj.pass_index, obj.color = source.pass_index, source.color
    modifier = obj.modifiers.new(sky_instance.KIND, "NODES")
    modifier.node_group = sky_instance.ensure()
    modifiers.set_inputs(modifier, Source=source, Collection=kept)
    return obj


def _place(obj, root, at) -> None:
    """Put an object under the root, which it follows in place and visibility."""
    obj.parent, obj.matrix_parent_inverse = root, at
    obj.hide_select = True
    for path in ("hide_render", "hide_viewport"):
        drive(obj, path, root, path)


def _rest(collection: bpy.types.Collection, wanted: Wanted) -> bpy.types.Collection:
    """A collection of ours that has all of another one but what is wanted."""
    rest = bpy.data.collections.new(f"{sky_instance.KIND} {collection.name}")
    rest[tags.REST] = collection.name_full
    rest.instance_offset = collection.instance_offset
    rest.hide_render, rest.hide_viewport = collection.hide_render, collection.hide_viewport
    for obj in collection.objects:
        inside = obj.instance_collection if obj.instance_type == "COLLECTION" else None
        spread = inside is not None and any(True for _ in _places(inside, wanted))
        if not spread and not (obj.type in SHAPES and not obj.hide_render and wanted(obj)):
            rest.objects.link(obj)
    for child in collection.children:
        rest.children.link(_rest(child, wanted))
    return rest


def _forget(rest: bpy.types.Collection) -> None:
    """Take a collection of ours away, and its children, but where another Empty still has it."""
    if tags.REST not in rest or rest.users:
        return
    children = list(rest.children)
    bpy.data.collections.remove(rest)
    for child in children:
        _forget(child)
