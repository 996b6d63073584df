"""Baking the light on objects of managed materials, and lighting them anew without a ray.

All is done by generators that yield how far they are: a button shows it, and whoever drops one
keeps the last whole light. It is that of the scene as it stands: a moved object is stale, as is one
whose surroundings have changed.
"""

from __future__ import annotations

from collections.abc import Collection, Generator
from dataclasses import replace
from functools import partial

import bpy
import numpy as np

from ... import tags
from ...grouping import grouped
from ...progress import Progress, aside, mapped, run
from . import geometry, instance_proxies, session, storage, surroundings
from . import light as light_of_scene
from .estimate import estimate
from .how import How
from .least_light import LeastLight

NOTHING = "0 object(s) baked"
"""The line of a bake that found every object's light new."""

SHAPES = {"MESH", "CURVE", "SURFACE", "FONT"}
"""Kinds of objects that can have the modifier. For instances of collections objects of ours stand
in (`instances`); metaballs, and what faces, vertices and particles instance, keep the open sky."""


LATER = 400
"""Instances from how many on they are baked after all else."""


def is_managed(obj: bpy.types.Object) -> bool:
    """Whether an object, as it is or evaluated, has a managed material."""
    return any(map(_counts, obj.material_slots))


def _counts(slot: bpy.types.MaterialSlot) -> bool:
    return slot.material is not None and tags.MATERIAL in slot.material


def _shows_managed(obj: bpy.types.Object) -> bool:
    """Whether a face of an object has a managed material; True where only a bake can tell."""
    others = [each for each in obj.modifiers if each != storage.modifier_of(obj)]
    if obj.type not in SHAPES or any(each.type == "NODES" for each in others):
        return True
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    if obj.type != "MESH":
        mesh = shown.to_mesh()
        faces = mesh is not None and len(mesh.polygons) > 0
        shown.to_mesh_clear()
        return faces
    shown = shown if others else obj
    managed = np.array([_counts(slot) for slot in shown.material_slots], bool)
    used = np.empty(len(shown.data.polygons), np.int32)
    shown.data.polygons.foreach_get("material_index", used)
    return bool(managed[np.minimum(used, len(managed) - 1)].any()) if len(managed) else False


def targets(selected: bool = False) -> list[bpy.types.Object]:
    """The visible (or also selected) objects of the view layer that show managed materials.

    An Empty whose instances are to be baked stands for them until others stand in for it.
    """
    layer = bpy.context.view_layer
    showing, managed = _showing(), is_managed
    there = instance_proxies.all_stand_ins()
    found = []
    for obj in layer.objects:
        if not obj.visible_get(view_layer=layer) or obj.hide_render:
            continue
        chosen = obj if instance_proxies.modifier_of(obj) is None else obj.parent
        if selected and not chosen.select_get(view_layer=layer):
            continue
        itself = obj.type in SHAPES and obj in showing and obj.instance_type == "NONE"
        own = there.get(obj, ())
        by = instance_proxies.shows(obj, managed, own)
        if itself or (by and not instance_proxies.is_spread(obj, managed, own)):
            found.append(obj)
    return found


def _showing() -> set[bpy.types.Object]:
    """What shows managed materials in the view layer, itself or by instances that it makes."""
    return {
        (each.parent if each.is_instance else each.object).original
        for each in bpy.context.evaluated_depsgraph_get().object_instances
        if is_managed(each.object) and each.particle_system is None
    }


def bake(
    objects: Collection[bpy.types.Object] | None = None,
    *,
    light: light_of_scene.Light | None = None,
    rays: int | None = None,
    tolerance: float = 0.1,
    changed_only: bool = True,
    slow: bool = False,
    error: float | None = None,
    least: LeastLight | None = None,
) -> Generator[Progress, None, list[str]]:
    """Bake objects of the view layer (None: all `targets`), yielding `Progress`; returns lines.

    After each pass of rays all that is baked holds the whole light, with less error than before:
    whoever stops then keeps that.

    Parameters
    ----------
    light
        What shines, and what materials do; None: an even sky of radiance 1 on white faces, and
        nothing sent from one to the other.
    rays
        From each point at last; None: as its light asks for, see `passes`.
    tolerance
        How far light in the middle of a cell may be from what those around it tell, as a part.
    changed_only
        Only what is stale is laid out anew; where anything is, all is lit.
    slow
        Without `embreex` also where it is installed.
    error
        CIEDE2000 that points cast no more rays to get under; None: a tenth of what is seen.
    least
        The light that is enough for that; None: as much as can be had.
    """
    real, empties, lines = _real(targets() if objects is None else objects)
    own, others = instance_proxies.apart(real)
    # Of many instances first all else has a light: what they hide and send counts for it already.
    many = len(empties) + len(others) > LATER and bool(own)
    stages = [(own, []), (others, empties)] if many else [(real, empties)]
    done = 0
    try:
        for number, (some, spread) in enumerate(stages):
            chosen = some + (instance_proxies.spread(spread, is_managed) if spread else [])
            if changed_only and chosen:
                chosen = yield from _staling(chosen)
            refused = {obj: why for obj in chosen if (why := _hindrance(obj))}
            lines += grouped(((f'"{obj.name}"', why) for obj, why in refused.items()), "object")
            chosen = [obj for obj in chosen if obj not in refused]
            if not chosen:
                continue
            if not done:
                later = [obj for each, more in stages[number + 1 :] for obj in (*each, *more)]
                found = estimate([*chosen, *later], rays, slow, least)
                yield Progress(0.0, f"about {found.all:.0f} s")
            first_only = number + 1 < len(stages)
            how = How(rays, tolerance, slow, first_only, error, least)
            work = session.baking(chosen, light or light_of_scene.Light(), how)
            said, count = yield from mapped(work, partial(_part, number, len(stages)))
            lines += said
            done += count
    finally:
        _gather()
    return [*lines, *_left_open(), f"{done} object(s) baked"]


def _part(number: int, stages: int, step: Progress) -> Progress:
    """How far a step of one of some stages is in all of them; the first of two is a tenth."""
    if stages == 1:
        return step
    return replace(step, done=0.1 * step.done if number == 0 else 0.1 + 0.9 * step.done)


def _real(
    objects: Collection[bpy.types.Object],
) -> tuple[list[bpy.types.Object], list[bpy.types.Object], list[str]]:
    """Objects that can be baked themselves, Empties of whose instances others can, and lines."""
    real: list[bpy.types.Object] = []
    empties: list[bpy.types.Object] = []
    linked = []
    there = instance_proxies.all_stand_ins()
    for obj in objects:
        if instance_proxies.instances_of(obj, there.get(obj, ())) is None:
            real.append(obj)
        elif obj.is_editable and obj.library is None:
            empties.append(obj)
        else:
            linked.append(
                (f'"{obj.name}"', "linked from another file: the open sky lights its instances")
            )
    return real, empties, grouped(linked, "object")


def _gather() -> None:
    """Give back their instances to Empties of whose stand-ins none is baked."""
    there = instance_proxies.all_stand_ins().items()
    bare = [root for root, own in there if all(storage.bake_of(each) is None for each in own)]
    if bare:
        instance_proxies.gather(bare)


def _left_open() -> list[str]:
    """Lines on objects that show spectral things under the open sky, for they have no mesh that a
    bake could belong to."""
    found = {}
    for each in bpy.context.evaluated_depsgraph_get().object_instances:
        by = (each.parent if each.is_instance else each.object).original
        if not is_managed(each.object):
            continue
        if each.particle_system is not None or by.instance_type in ("VERTS", "FACES"):
            found[f'"{by.name}"'] = "shows instances under the open sky: make them real"
        elif by.type == "META":
            found[f'"{by.name}"'] = "shows a metaball under the open sky: convert it to a mesh"
    return grouped(found.items(), "object")


def remove(objects: Collection[bpy.types.Object] | None = None) -> int:
    """Take the bakes of objects (None: of the file) away without a trace, and count them."""
    chosen = list(bpy.data.objects if objects is None else objects)
    if objects is not None:
        there = instance_proxies.all_stand_ins()
        chosen += [each for obj in chosen for each in there.get(obj, ())]
    baked = {obj for obj in chosen if storage.modifier_of(obj) is not None}
    storage.remove(baked)
    _gather()
    return len(baked)


def baked() -> list[bpy.types.Object]:
    """The objects of the file that have a bake, stale or not."""
    return [obj for obj in bpy.data.objects if storage.bake_of(obj) is not None]


def stale() -> list[bpy.types.Object]:
    """The `targets` without a bake, or whose bake is no longer what they would see.

    Those that cannot be baked are none, but for what is being edited. It evaluates the scene: for a
    button, not for a panel's drawing.
    """
    return [obj for obj in run(finding_stale()) if is_waiting(obj)]


def finding_stale() -> Generator[Progress, None, list[bpy.types.Object]]:
    """Find what is `stale`, and what cannot be baked either, yielding now and then."""
    return (yield from _staling(targets()))


def is_waiting(obj: bpy.types.Object) -> bool:
    """Whether an object could have a bake, now or after it was edited."""
    return obj.mode != "OBJECT" or not _hindrance(obj)


def relighting(light: light_of_scene.Light) -> Generator[Progress, None, list[str]]:
    """Give all that is baked another light, yielding `Progress`; returns lines to say.

    Without a ray where this Blender has baked the scene as it is; else rays are cast anew.
    """
    there, lines = lit()
    if there:
        lines += yield from session.relighting(there, light)
    return lines


def lit() -> tuple[list[bpy.types.Object], list[str]]:
    """The objects of the file that hold light and can have another, and lines on older bakes."""
    there = [obj for obj in baked() if storage.is_lit(obj) and not _hindrance(obj)]
    old = [obj for obj in baked() if not storage.is_lit(obj)]
    line = f"{len(old)} bake(s) of an earlier version hold no bounced light: bake again"
    return there, [line] if old else []


def _staling(
    objects: Collection[bpy.types.Object],
) -> Generator[Progress, None, list[bpy.types.Object]]:
    """Find those of some objects without a bake, or whose bake is not of what they see now."""
    lit = {obj.name_full: bake for obj in objects if (bake := storage.lit_bake_of(obj)) is not None}
    if not lit:
        return list(objects)
    around = yield from geometry.gathering()
    found = yield from aside(geometry.GATHERING, surroundings.signatures, around)
    changed = surroundings.changed(lit, found, around.whole)
    return [obj for obj in objects if obj.name_full not in lit or obj.name_full in changed]


def _hindrance(obj):
    if obj.library is not None or obj.override_library is not None or not obj.is_editable:
        return "not baked, for it is linked from another file: make it local, or bake it there"
    if obj.mode != "OBJECT":
        return "not baked, for it is being edited: leave that mode first"
    if abs(obj.matrix_world.determinant()) < 1e-20:
        return "not baked, for it has no size"
    return "" if _shows_managed(obj) else "not baked, for it has no faces of a spectral material"
