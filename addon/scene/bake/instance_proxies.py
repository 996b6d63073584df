"""Objects that stand in for the instances of a collection while those are baked.

Instances of one object have its mesh in common, and with it all that a bake could keep. So an Empty
that instances a collection is handed another one, of ours, without what is to be baked, and for
each such thing it gets a child: an object that shows the same geometry in the same place, live, and
that can be baked like any other. Lamps and whatever is not spectral stay instances. `gather` gives
the Empty its collection back and takes all of ours away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import bpy
from mathutils import Matrix

from ....node_groups import modifiers, sky_instance
from ....node_groups import tree as groups
from ....node_groups.drivers import drive
from ... import tags
from . import storage

SHAPES = {"MESH", "CURVE", "SURFACE", "FONT"}
FLAGS = ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow")

Wanted = Callable[[bpy.types.Object], bool]
Place = tuple[bpy.types.Object, Matrix]


def instances_of(obj: bpy.types.Object) -> bpy.types.Collection | None:
    """The collection that an object instances, as the user gave it; None for any other object."""
    if obj.instance_type != "COLLECTION" or obj.instance_collection is None or tags.REST in obj:
        return None
    if tags.REST not in obj.instance_collection:
        return obj.instance_collection
    found = (modifiers.get_input(modifier_of(child), "Collection") for child in stand_ins(obj))
    name = obj.instance_collection[tags.REST]
    return next(found, None) or next((c for c in bpy.data.collections if c.name_full == name), None)


def modifier_of(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """The `Sky Instance` modifier of an object, None if it stands in for none."""
    return modifiers.of_kind(obj, sky_instance.KIND)


def stand_ins(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects of ours that stand in for an Empty's instances."""
    found = [child for child in obj.children_recursive if modifier_of(child) is not None]
    return sorted(found, key=lambda child: child.name_full)


def is_spread(obj: bpy.types.Object, wanted: Wanted) -> bool:
    """Whether stand-ins are there for all that an Empty instances and that is wanted, no others."""
    collection = instances_of(obj)
    if collection is None:
        return False
    now = [source for source, _ in _places(collection, wanted)]
    there = [modifiers.get_input(modifier_of(child), "Source") for child in stand_ins(obj)]
    return sorted(o.name_full for o in now) == sorted(o.name_full if o else "" for o in there)


def shows(obj: bpy.types.Object, wanted: Wanted) -> bool:
    """Whether an Empty instances something that is wanted."""
    collection = instances_of(obj)
    return collection is not None and any(True for _ in _places(collection, wanted))


def spread(obj: bpy.types.Object, wanted: Wanted) -> list[bpy.types.Object]:
    """Let stand-ins show what of an Empty's instances is wanted, and return them."""
    if is_spread(obj, wanted):
        return stand_ins(obj)
    gather(obj)
    collection = obj.instance_collection
    bpy.context.view_layer.update()
    _spread(obj, obj, collection, Matrix(), wanted, collection)
    bpy.context.view_layer.update()
    return stand_ins(obj)


def gather(obj: bpy.types.Object) -> None:
    """Give an Empty its own collection back, and take away what stood in for it."""
    collection = instances_of(obj)
    if collection is None or tags.REST not in obj.instance_collection:
        return
    others = [child for child in obj.children_recursive if tags.REST in child]
    for child in [*stand_ins(obj), *others]:
        storage.remove(child)
        rest, mesh = child.instance_collection, child.data
        bpy.data.objects.remove(child)
        if mesh is not None:
            bpy.data.meshes.remove(mesh)
        if rest is not None:
            _forget(rest)
    rest = obj.instance_collection
    obj.instance_collection = collection
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


def _spread(parent, root, collection, at, wanted, kept) -> None:
    """Hand an Empty the rest of a collection, and put what is wanted of it under the root."""
    parent.instance_collection = _rest(collection, wanted)
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
            _spread(nested, root, inside, at @ source.matrix_world, wanted, kept)
        elif source.type in SHAPES and wanted(source):
            _stand_in(source, root, at, kept)


def _stand_in(source, root, at, kept) -> None:
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


def _place(obj, root, at) -> None:
    """Put an object under the root, which it follows in place and visibility."""
    for collection in root.users_collection:
        if tags.RECEIVERS not in collection:
            collection.objects.link(obj)
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
    if tags.REST not in rest or any(obj.instance_collection == rest for obj in bpy.data.objects):
        return
    for child in list(rest.children):
        _forget(child)
    bpy.data.collections.remove(rest)
