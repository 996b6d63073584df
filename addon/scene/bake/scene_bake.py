"""Baking what objects of managed materials see of the sky, and lighting that anew without a bake.

All is done by generators that yield how far they are: a button shows it, and whoever drops one
leaves the objects before it baked and the present one as without a bake. Harmonics are in world
space: a moved object is stale, as is one whose surroundings have changed.
"""

from __future__ import annotations

from collections.abc import Collection, Generator
from functools import partial

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import sky_visibility as names
from ...progress import Progress, mapped
from ...sky.harmonics import KEYS, HarmonicFit, rotate
from . import instance_proxies, object_bake, storage, surroundings, visibility
from . import raycast as casting

SHAPES = {"MESH", "CURVE", "SURFACE", "FONT"}
"""Kinds of objects that can have the modifier. For instances of collections objects of ours stand
in (`instances`); metaballs, and what faces, vertices and particles instance, keep the open sky."""


def targets(selected: bool = False) -> list[bpy.types.Object]:
    """The visible (or also selected) objects of the view layer that show managed materials.

    An Empty whose instances are to be baked stands for them until others stand in for it.
    """
    layer = bpy.context.view_layer
    showing, managed = _showing(), object_bake.is_managed
    found = []
    for obj in layer.objects:
        if not obj.visible_get(view_layer=layer) or obj.hide_render:
            continue
        chosen = obj if instance_proxies.modifier_of(obj) is None else obj.parent
        if selected and not chosen.select_get(view_layer=layer):
            continue
        itself = obj.type in SHAPES and obj in showing and obj.instance_type == "NONE"
        by = instance_proxies.shows(obj, managed) and not instance_proxies.is_spread(obj, managed)
        if itself or by:
            found.append(obj)
    return found


def _showing() -> set[bpy.types.Object]:
    """What shows managed materials in the view layer, itself or by instances that it makes."""
    return {
        (each.parent if each.is_instance else each.object).original
        for each in bpy.context.evaluated_depsgraph_get().object_instances
        if object_bake.is_managed(each.object) and each.particle_system is None
    }


def bake(
    objects: Collection[bpy.types.Object] | None = None,
    *,
    rays: int | None = None,
    tolerance: float = 0.05,
    changed_only: bool = True,
    slow: bool = False,
) -> Generator[Progress, None, list[str]]:
    """Bake objects of the view layer (None: all `targets`), yielding `Progress`; returns lines.

    Parameters
    ----------
    rays
        From each point, a multiple of 32; None: 1024, or 160 without `embreex`. Where the sky ends
        each is three, which about doubles them. In a street 1024 leave 1 % and 5 % at worst, 256
        leave 3 % and 19 % under a low sun.
    tolerance
        How far light in the middle of a cell may be from what its corners tell, as a part of it.
    changed_only
        Objects whose bake is not stale are left as they are.
    slow
        Without `embreex` also where it is installed.
    """
    if rays is None:
        rays = 1024 if casting.fast() and not slow else 160
    if rays % 32 or rays <= 0:
        raise ValueError(f"{rays} rays are no multiple of 32")
    chosen, lines = _real(targets() if objects is None else objects)
    around, found = _scene()
    if changed_only:
        chosen = [obj for obj in chosen if _stale(obj, around, found)]
    done = 0
    try:
        for number, obj in enumerate(chosen):
            hindrance = _hindrance(obj)
            if hindrance:
                lines.append(f'object "{obj.name}" {hindrance}: not baked')
                continue
            name, whole = f"{obj.name} ({number + 1} of {len(chosen)})", False
            work = object_bake.bake_object(obj, around, rays, tolerance, slow)
            try:
                at = partial(_progress, number, len(chosen), name)
                lines += yield from mapped(work, at)
                whole = True
            finally:
                if not whole:
                    storage.remove(obj)
            kept = storage.bake_of(obj)
            if kept is not None:
                surroundings.remember(kept, obj.name_full, found)
                done += 1
    finally:
        _gather()
    return [*lines, *_left_open(), f"{done} object(s) baked"]


def _progress(number: int, count: int, name: str, done: float) -> Progress:
    return Progress((number + done) / count, name)


def _real(
    objects: Collection[bpy.types.Object],
) -> tuple[list[bpy.types.Object], list[str]]:
    """Objects with stand-ins for the instances of Empties among them, and lines to say."""
    real: list[bpy.types.Object] = []
    lines = []
    for obj in objects:
        if instance_proxies.instances_of(obj) is None:
            real.append(obj)
        elif obj.is_editable and obj.library is None:
            real += instance_proxies.spread(obj, object_bake.is_managed)
        else:
            lines.append(f'object "{obj.name}" is linked from another file: its instances are open')
    return real, lines


def _gather() -> None:
    """Give back their instances to Empties of whose stand-ins none is baked."""
    for obj in [
        each for each in bpy.data.objects if instance_proxies.instances_of(each) is not None
    ]:
        there = instance_proxies.stand_ins(obj)
        if there and all(storage.bake_of(each) is None for each in there):
            instance_proxies.gather(obj)


def _left_open() -> list[str]:
    """A line for each object that shows spectral things under the open sky, for they have no mesh
    that a bake could belong to."""
    lines = {}
    for each in bpy.context.evaluated_depsgraph_get().object_instances:
        by = (each.parent if each.is_instance else each.object).original
        if not object_bake.is_managed(each.object):
            continue
        if each.particle_system is not None or by.instance_type in ("VERTS", "FACES"):
            lines[by.name] = "instances under the open sky: make them real"
        elif by.type == "META":
            lines[by.name] = "a metaball under the open sky: convert it to a mesh"
    return [f'object "{name}" shows {line}' for name, line in lines.items()]


def remove(objects: Collection[bpy.types.Object] | None = None) -> int:
    """Take the bakes of objects (None: of the file) away without a trace, and count them."""
    chosen = list(bpy.data.objects if objects is None else objects)
    if objects is not None:
        chosen += [each for obj in chosen for each in instance_proxies.stand_ins(obj)]
    baked = {obj for obj in chosen if storage.modifier_of(obj) is not None}
    for obj in baked:
        storage.remove(obj)
    _gather()
    return len(baked)


def baked() -> list[bpy.types.Object]:
    """The objects of the file that have a bake, stale or not."""
    return [obj for obj in bpy.data.objects if storage.bake_of(obj) is not None]


def stale() -> list[bpy.types.Object]:
    """The `targets` without a bake, or whose bake is no longer what they would see.

    It evaluates the scene: for a button, not for a panel's drawing.
    """
    around, found = _scene()
    return [obj for obj in targets() if _stale(obj, around, found)]


def light(
    tree: bpy.types.NodeTree, rgb: NDArray, fit: HarmonicFit, turn: float = 0.0
) -> list[bpy.types.Object]:
    """Light all bakes by a sky, without a ray: write harmonics, and what those leave out.

    `tree`: the World's `Sky Visibility` group. `rgb` (h, 2 h, 3): the sky without its sun, `fit`
    its harmonics, `turn` [rad]: the z of its Mapping's rotation now. The harmonics follow any turn
    live; what they leave out is exact for this turn, and fades within 5 degrees of another.
    Returns the objects. Call it again after a bake.
    """
    first = dict(zip(KEYS, fit.first.tolist(), strict=False))
    named = dict(zip(KEYS, fit.coefficients.tolist(), strict=True))
    names.set_coefficients(tree, named, first)
    sky = visibility.UpperSky.of(rgb, turn)
    # One of a million keys for a sky as it stands: bakes tell by it whether they have seen it.
    digest = np.abs(fit.coefficients).sum() * 1e3 + np.cos(turn) * 10.0 + 50.0
    key = float(1 + round(digest * 7919.0) % 1_000_000)
    objects = baked()
    for obj in objects:
        bake = storage.bake_of(obj)
        assert bake is not None  # that is what makes it baked
        points = storage.points_of(obj)
        values = [storage.read_attribute(bake, names.attribute(n), points) for n in range(4)]
        transfer = np.stack(
            [values[n][:, c] for n, c in (names.PLACES[key] for key in KEYS)], axis=1
        )
        normals, backed = np.split(storage.read_attribute(bake, storage.NORMAL, points), [3], 1)
        bits = storage.read_bits(bake, points)
        if not bits.size:
            continue  # an older bake, of harmonics alone
        left = visibility.exact(sky, normals, bits) - rotate(transfer, turn) @ fit.coefficients
        colour = np.concatenate([left, np.full((points, 1), key)], axis=1)
        storage.write_attribute(bake, names.EXACT, colour)
        behind = storage.read_bits(bake, points, storage.BEHIND)
        if behind.size:
            back = storage.read_attribute(bake, names.BACK, points)
            back[:, :3] = backed * (1.0 + visibility.passing(sky, -normals, behind))
            storage.write_attribute(bake, names.BACK, back)
        bake.data.update()
        bake.update_tag()
    names.set_exact(tree, key, (float(np.cos(turn)), float(np.sin(turn))))
    return objects


def _scene():
    around = casting.occluders(bpy.context.evaluated_depsgraph_get())
    return around, surroundings.signatures(around)


def _stale(obj, around, found):
    kept = storage.bake_of(obj)
    return kept is None or surroundings.changed(kept, obj.name_full, found, around.size)


def _hindrance(obj):
    if obj.library is not None or obj.override_library is not None or not obj.is_editable:
        return "is linked from another file (make it local, or bake it there)"
    if obj.mode != "OBJECT":
        return "is being edited (leave that mode first)"
    return ""
