"""Light by way of neighbours: one bounce from baked faces, for what is baked.

A ray that does not reach the sky meets a face; what that face sees of the sky, known from its
bake, comes along it, times the face's reflectance. The reflectance is left to the materials: for
each receiving material neighbours are two kinds, the one that sends most light and all others, and
each kind's harmonics lie apart (`node_groups.sky_visibility.BOUNCES`). Light that met two walls
is not in it, nor light from what is not baked, from backs of faces, or from the ground's share.
"""

from __future__ import annotations

import json
from collections.abc import Generator
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import modifiers, sky_bake
from ....node_groups import sky_visibility as names
from ...sky.harmonics import KEYS
from . import object_bake, storage, visibility
from . import raycast as casting

NEIGHBOURS = "spectral_skylight_neighbours"  # on the modifier's group, as JSON
SUN = "spectral_skylight_bounced_sun"  # beside it: where the sun stood
TERMS = 9
MOVED = 3.0
"""[degrees] that the sun may move until its bounced light is out of date: a quarter of an hour."""


@dataclass(frozen=True)
class Neighbours:
    """Whose light a receiving material gets, by the materials' names."""

    first: str
    """The one that sends most of it."""
    others: dict[str, float]
    """All others, with their parts of the rest (sum 1); empty where there is none."""


def neighbours() -> dict[str, Neighbours]:
    """What the last `bounce` of the file has found, by the names of receiving materials."""
    trees = names.groups.of_kind(sky_bake.KIND)
    kept = json.loads(trees[0].get(NEIGHBOURS, "{}")) if trees else {}
    return {name: Neighbours(**each) for name, each in kept.items()}


def is_stale(sun: NDArray | None) -> bool:
    """Whether the sun, (3,) or None, stands elsewhere than when bounces were last baked."""
    trees = names.groups.of_kind(sky_bake.KIND)
    before = list(trees[0].get(SUN, ())) if trees else []
    if sun is None or not before:
        return (sun is None) != (not before)
    cosine = np.dot(sun, before) / np.linalg.norm(sun) / np.linalg.norm(before)
    return bool(cosine < np.cos(np.radians(MOVED)))


def bounce(
    sun: NDArray | None = None, rays: int = 256
) -> Generator[float, None, dict[str, Neighbours]]:
    """Add one bounce to all bakes, yielding 0 to 1; return each receiving material's neighbours.

    `sun` (3,): the direction to the sun, whose light bounces too; None: no sun. To be called
    after each bake, and, where there is a sun, after each move of it. What a material reflects
    of either kind is its surface's to say: without, nothing is added.
    """
    materials: list[str] = []
    around = casting.occluders(bpy.context.evaluated_depsgraph_get())
    objects = [_Baked(obj, materials, around) for obj in bpy.data.objects if _shown(obj)]
    if not objects:
        return {}
    scene = _Faces(objects, sun, around)
    weights = np.zeros((len(materials), len(materials)))
    for number, each in enumerate(objects):
        # Which neighbours count is clear from a part of the points and rays.
        for at, hits, front in _cast(scene, each, each.shown[::8], 64):
            receiver = np.broadcast_to(each.material[at][:, None], hits.shape)[front]
            np.add.at(weights, (receiver, scene.material[hits[front]]), scene.light[hits[front], 0])
        yield 0.2 * (number + 1) / len(objects)
    first = weights.argmax(axis=1)
    for number, each in enumerate(objects):
        sums = np.zeros((2, len(each.material), TERMS + 1), np.float32)
        for at, hits, front in _cast(scene, each, each.shown, rays):
            same = scene.material[hits] == first[each.material[at]][:, None]
            for way, chosen in enumerate((front & same, front & ~same)):
                sums[way, at] = np.einsum("nr,nrk->nk", chosen / rays, scene.light[hits])
            yield 0.2 + 0.8 * number / len(objects)
        each.write(sums)
    found = {}
    for index in np.flatnonzero(weights.any(axis=1)):
        row = dict(zip(materials, weights[index], strict=True))
        row.pop(materials[first[index]])
        total = sum(row.values())
        others = {name: float(weight / total) for name, weight in row.items() if weight > 0.0}
        found[materials[index]] = Neighbours(materials[first[index]], others)
    tree = sky_bake.ensure()
    tree[NEIGHBOURS] = json.dumps({name: vars(each) for name, each in found.items()})
    tree[SUN] = [] if sun is None else [float(part) for part in sun]
    return found


def _shown(obj):
    return storage.bake_of(obj) is not None and object_bake.evaluated(obj) is not None


class _Baked:
    """A baked object's points and what they see of the sky."""

    def __init__(self, obj, materials, around):
        self.obj, self.bake = obj, storage.bake_of(obj)
        self.fine = object_bake.evaluated(obj)
        numbers = []
        for name in self.fine.materials:
            if name not in materials:
                materials.append(name)
            numbers.append(materials.index(name))
        self.face_material = np.array(numbers)[self.fine.slots]
        count = len(self.fine.places)
        self.stored = storage.points_of(obj) == count  # else it is not the mesh that was baked
        self.points = object_bake.Points(obj, self.fine, self.fine.managed, around.size)
        self.material = np.zeros(count, int)
        self.material[self.fine.point] = self.face_material[self.fine.face]
        self.shown = np.flatnonzero(self.points.shown) if self.stored else np.empty(0, int)
        self.sky = np.zeros((count, TERMS), np.float32)
        if self.stored:
            for index, key in enumerate(KEYS[:TERMS]):
                number, channel = names.PLACES[key]
                values = storage.read_attribute(self.bake, names.attribute(number), count)
                self.sky[:, index] = values[:, channel]

    def write(self, sums):
        """Keep the two kinds' harmonics and sun (2, p, 10)."""
        values = np.zeros((10, len(self.material), 4), np.float32)
        values[4] = storage.read_attribute(self.bake, names.attribute(4), len(self.material))
        values[names.BOUNCED[0], :, names.BOUNCED[1]] = 1.0
        for way, places in enumerate(names.BOUNCES):
            for index, key in enumerate(KEYS[:TERMS]):
                number, channel = places[key]
                values[number, :, channel] = sums[way, :, index]
            number, channel = names.BOUNCE_SUN[way]
            values[number, :, channel] = sums[way, :, TERMS]
        for number in range(4, 10):
            storage.write_attribute(self.bake, names.attribute(number), values[number])
        modifiers.set_inputs(storage.modifier_of(self.obj), Bounce=self.stored)
        self.bake.data.update()
        self.bake.update_tag()
        self.obj.update_tag()


class _Faces(casting.Occluders):
    """The baked cells as triangles, with the light on each, and all else that stands about."""

    def __init__(self, objects, sun, around):
        corners, light, material = [], [], []
        for each in objects:
            fine, at = each.fine, each.points.places[each.fine.point]
            on_face = np.concatenate(
                [fine.mean(each.sky[fine.point]), np.zeros((len(fine.coarse), 1))], 1
            )
            if sun is not None:
                on_face[:, TERMS] = _sunlit(around, each.points, sun)
            # A fan about the first corner: cells are convex.
            sides = np.diff(fine.starts) - 2
            face = np.repeat(np.arange(len(sides)), sides)
            second = np.arange(len(face)) - np.repeat(np.cumsum(sides) - sides, sides) + 1
            first = fine.starts[face]
            corners.append(np.stack([at[first], at[first + second], at[first + second + 1]], 1))
            light.append(on_face[face])
            material.append(each.face_material[face])
        names_baked = {each.obj.name_full for each in objects}
        other = [number for number, name in enumerate(around.owners) if name not in names_baked]
        rest = np.isin(around.owner, other)
        corners = [(np.concatenate(corners) - around.origin).astype(np.float32)]
        corners.append(around.corners[rest])
        dark = np.zeros((np.count_nonzero(rest), TERMS + 1))
        self.light = np.concatenate([*light, dark]).astype(np.float32)
        numbers = np.concatenate([*material, np.zeros(len(dark), int)]).astype(np.int32)
        none = np.zeros(len(self.light), np.int32)
        super().__init__(np.concatenate(corners), around.origin, none, [""], numbers, [])


def _sunlit(around, points, sun):
    """Visibility of the sun times cosine, of each cell's middle (f,)."""
    way = np.asarray(sun, float) / np.linalg.norm(sun)
    cosine = np.maximum(points.middle_normals @ way, 0.0)
    starts = (points.middles - around.origin).astype(np.float32)
    ways = np.broadcast_to(way.astype(np.float32), starts.shape)
    return cosine * (around.first_hits(starts, np.ascontiguousarray(ways)) < 0)


def _cast(scene, each, points, rays):
    """Yield some points, the triangles that their rays meet (n, rays), and which meet a front."""
    step = max(1, visibility.CHUNK // rays)
    for start in range(0, len(points), step):
        at = points[start : start + step]
        ways = visibility.directions(each.points.normals[at], rays)
        starts = np.repeat((each.points.starts[at] - scene.origin).astype(np.float32), rays, axis=0)
        hits = scene.first_hits(starts, ways.reshape(-1, 3)).reshape(len(at), rays)
        facing = np.einsum("nrk,nrk->nr", ways, scene.normals[hits]) < 0.0
        yield at, hits, (hits >= 0) & facing
