"""Baking what objects of managed materials see of the sky, and lighting that anew without a bake.

All is done by generators that yield how far they are: a button shows it, and whoever drops one
leaves the objects before it baked and the present one as without a bake. Harmonics are in world
space: a moved object is stale, as is one whose surroundings have changed.
"""

from __future__ import annotations

from collections.abc import Collection, Generator
from dataclasses import dataclass
from typing import TypeVar

import bpy
import numpy as np
from numpy.typing import NDArray

from ...node_groups import sky_visibility as names
from ..sky.harmonics import KEYS, HarmonicFit, rotate
from . import bake_mesh, bake_object, surroundings, visibility
from . import rays as casting

SHAPES = {"MESH", "CURVE", "SURFACE", "FONT"}
"""Kinds of objects that can have the modifier. Metaballs and instances of collections cannot, and
keep the open sky: make them real, and they are baked."""


Done = TypeVar("Done")


@dataclass(frozen=True)
class Progress:
    """How far a bake is: `done` from 0 to 1, and the object at work."""

    done: float
    line: str


def targets(selected: bool = False) -> list[bpy.types.Object]:
    """The visible (or also selected) objects of the view layer that show managed materials."""
    layer = bpy.context.view_layer
    return [
        obj
        for obj in layer.objects
        if obj.type in SHAPES and obj.visible_get(view_layer=layer) and not obj.hide_render
        if not selected or obj.select_get(view_layer=layer)
        if bake_object.managed_slots(obj)
    ]


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
        From each point, a multiple of 32; None: 1024, or 256 without `embreex`. In a courtyard
        2048, 1024 and 256 leave mean errors of 0.5, 0.8 and 3 %.
    tolerance
        How far light in the middle of a cell may be from what its corners tell, as a part of it.
    changed_only
        Objects whose bake is not stale are left as they are.
    slow
        Without `embreex` also where it is installed.
    """
    if rays is None:
        rays = 1024 if casting.fast() and not slow else 256
    if rays % 32 or rays <= 0:
        raise ValueError(f"{rays} rays are no multiple of 32")
    around, found = _scene()
    chosen = targets() if objects is None else list(objects)
    if changed_only:
        chosen = [obj for obj in chosen if _stale(obj, around, found)]
    lines, baked = [], 0
    for number, obj in enumerate(chosen):
        hindrance = _hindrance(obj)
        if hindrance:
            lines.append(f'object "{obj.name}" {hindrance}: not baked')
            continue
        name, whole = f"{obj.name} ({number + 1} of {len(chosen)})", False
        work = bake_object.bake_object(obj, around, rays, tolerance, slow)
        try:
            while True:
                try:
                    yield Progress((number + next(work)) / len(chosen), name)
                except StopIteration as end:
                    lines += end.value
                    break
            whole = True
        finally:
            if not whole:
                bake_mesh.remove(obj)
        kept = bake_mesh.bake_of(obj)
        if kept is not None:
            surroundings.remember(kept, obj.name_full, found)
            baked += 1
    return [*lines, *_instancers(), f"{baked} object(s) baked"]


def _instancers() -> list[str]:
    """A line for each object that shows a collection of spectral things: one mesh, many places."""
    return [
        f'object "{obj.name}" shows a collection under the open sky: make its instances real'
        for obj in bpy.context.view_layer.objects
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None
        if any(bake_object.managed_slots(part) for part in obj.instance_collection.all_objects)
    ]


def run(work: Generator[Progress, None, Done]) -> Done:
    """Run a generator that yields its progress to its end and return what it returns."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


def remove(objects: Collection[bpy.types.Object] | None = None) -> int:
    """Take the bakes of objects (None: of the file) away without a trace, and count them."""
    chosen = bpy.data.objects if objects is None else objects
    baked = [obj for obj in chosen if bake_mesh.modifier_of(obj) is not None]
    for obj in baked:
        bake_mesh.remove(obj)
    return len(baked)


def baked() -> list[bpy.types.Object]:
    """The objects of the file that have a bake, stale or not."""
    return [obj for obj in bpy.data.objects if bake_mesh.bake_of(obj) is not None]


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
    sky = visibility.Sky.of(rgb, turn)
    # One of a million keys for a sky as it stands: bakes tell by it whether they have seen it.
    digest = np.abs(fit.coefficients).sum() * 1e3 + np.cos(turn) * 10.0 + 50.0
    key = float(1 + round(digest * 7919.0) % 1_000_000)
    objects = baked()
    for obj in objects:
        bake = bake_mesh.bake_of(obj)
        assert bake is not None  # that is what makes it baked
        points = bake_mesh.points_of(obj)
        values = [bake_mesh.read_attribute(bake, names.attribute(n), points) for n in range(4)]
        transfer = np.stack(
            [values[n][:, c] for n, c in (names.PLACES[key] for key in KEYS)], axis=1
        )
        normals = bake_mesh.read_attribute(bake, bake_mesh.NORMAL, points)[:, :3]
        bits = bake_mesh.read_bits(bake, points)
        left = visibility.exact(sky, normals, bits) - rotate(transfer, turn) @ fit.coefficients
        colour = np.concatenate([left, np.full((points, 1), key)], axis=1)
        bake_mesh.write_attribute(bake, names.EXACT, colour)
        bake.data.update()
        bake.update_tag()
    names.set_exact(tree, key, (float(np.cos(turn)), float(np.sin(turn))))
    return objects


def _scene():
    around = casting.occluders(bpy.context.evaluated_depsgraph_get())
    return around, surroundings.signatures(around)


def _stale(obj, around, found):
    kept = bake_mesh.bake_of(obj)
    return kept is None or surroundings.changed(kept, obj.name_full, found, around.size)


def _hindrance(obj):
    if obj.library is not None or obj.override_library is not None or not obj.is_editable:
        return "is linked from another file (make it local, or bake it there)"
    if obj.mode != "OBJECT":
        return "is being edited (leave that mode first)"
    return ""
