"""Where light is wanted: points of baked objects, what their rays meet, and the colours there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from ...transport import directions
from ...transport.hits import Hits, Space, gather, joined
from . import storage
from .storage import Fine

COVER = 0.1
"""What lies so near over a point, of its cells' size, hides it: a rug, or a door on a wall."""

UNTOLD = 0.5
"""A point of whose rays less than this part tell anything lies in something solid."""


class Points:
    """The points of a mesh in the world, and where rays start from them.

    ``origin`` (3,) and ``size``: the scene's.
    """

    def __init__(self, obj: bpy.types.Object, fine: Fine, origin: NDArray, size: float) -> None:
        to_world = np.array(obj.matrix_world)
        self.fine = fine
        places = fine.places @ to_world[:3, :3].T + (to_world[:3, 3] - origin)
        normals = fine.normals @ np.linalg.inv(to_world[:3, :3])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self.normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
        count = len(places)
        shown = np.bincount(fine.point, fine.managed[fine.face], count) > 0
        self.shown = shown & (length[:, 0] > 0.0)
        self.shown[count - len(fine.twin_of) :] = False
        self.slot = np.zeros(count, int)
        self.slot[fine.point] = fine.slots[fine.face]
        at = places[fine.point]
        inwards = fine.mean(at)[fine.face] - at
        away = np.linalg.norm(inwards, axis=1)
        radius = np.maximum.reduceat(away, fine.starts[:-1])
        # A little off the face, for a ray must not meet it, and inwards, where two walls meet.
        lift = np.clip(1e-3 * radius, 2e-6 * size, 2e-5 * size)
        inwards *= np.minimum(0.01, 1e-3 * size / np.maximum(away, 1e-30))[:, None]
        # Never into a surface that bends away.
        normals = self.normals[fine.point]
        inwards -= np.minimum((inwards * normals).sum(axis=1), 0.0)[:, None] * normals
        shares = np.bincount(fine.point, minlength=count)
        off = [np.bincount(fine.point, column, count) for column in (*inwards.T, lift[fine.face])]
        off = np.stack(off, axis=1) / np.maximum(shares, 1)[:, None]
        self.inner, self.lift = places + off[:, :3], off[:, 3:]
        self.cover = np.zeros(count)
        np.maximum.at(self.cover, fine.point, COVER * radius[fine.face])

    def starts(self, side: float) -> NDArray:
        """Where rays start (n, 3) before the faces (1), or behind them (-1)."""
        return self.inner + side * self.lift * self.normals


@dataclass
class Target:
    """An object that is baked: its ``fine`` mesh as it is now, and which of its points, by side,
    have which numbers among all receivers.

    It is kept for another light, so it knows the object by ``name``: an undo makes all objects new,
    and a reference to one that was is a crash.
    """

    name: str
    fine: Fine
    points: Points
    backs: NDArray[np.bool_]
    """(p,), whether light is wanted behind."""
    numbers: dict[float, tuple[NDArray, NDArray]] = field(default_factory=dict)
    """By side, points and their numbers."""

    @property
    def obj(self) -> bpy.types.Object:
        """The object, as it is now."""
        return bpy.data.objects[self.name, None]

    @property
    def bake(self) -> bpy.types.Object:
        """What holds its light."""
        found = storage.bake_of(self.obj)
        assert found is not None  # else it is no target
        return found


class Receivers:
    """All points that want light, by material, and what their rays have met so far."""

    def __init__(self, targets: Sequence[Target], materials: Sequence[str], space: Space) -> None:
        self.targets = list(targets)
        number = {name: k for k, name in enumerate(materials)}
        places, normals, kinds, covers = [], [], [], []
        spans: list[tuple[Target, float, NDArray]] = []
        for target in targets:
            points = target.points
            of_slot = np.array([number.get(name, 0) for name in target.fine.materials])
            for side, wanted in ((1.0, points.shown), (-1.0, points.shown & target.backs)):
                chosen = np.flatnonzero(wanted)
                spans.append((target, side, chosen))
                places.append(points.starts(side)[chosen])
                normals.append(side * points.normals[chosen])
                kinds.append(of_slot[points.slot[chosen]])
                covers.append(points.cover[chosen])
        kind = np.concatenate([*kinds, np.empty(0, int)])
        order = np.argsort(kind, kind="stable")
        self.places = np.concatenate([*places, np.empty((0, 3))])[order].astype(np.float32)
        self.normals = np.concatenate([*normals, np.empty((0, 3))])[order].astype(np.float32)
        self.kind = kind[order]
        cover = np.concatenate([*covers, np.empty(0)])[order]
        self.hidden, _ = space.hidden(self.places, self.normals, cover)
        back = np.empty(len(order), int)
        back[order] = np.arange(len(order))
        first = 0
        for target, side, chosen in spans:
            target.numbers[side] = chosen, back[first : first + len(chosen)]
            first += len(chosen)
        self.passes: list[Hits] = []
        self.pattern = np.empty((0, 3), np.float32)

    def __len__(self) -> int:
        return len(self.places)

    def cast(self, space: Space, pattern: NDArray) -> Iterator[float]:
        """Cast a pattern of rays more from each, yielding 0 to 1."""
        parts = []
        for part, hits in space.look(self.places, self.normals, pattern):
            parts.append(hits)
            yield part.stop / len(self)
        self.passes.append(joined(parts))
        self.pattern = np.concatenate([self.pattern, pattern])

    def colours(
        self,
        space: Space,
        table: NDArray[np.float32],
        tells: NDArray[np.float32],
        sky: Callable[[int], NDArray],
        matrix: Callable[[int], NDArray],
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the colour (n, 3) that light makes of each receiver, and what part (n,) of its
        rays tells anything, 0 where something covers it.

        ``table`` (rows, 16): radiance; ``tells`` (rows,): 1 where that is worth anything. By a
        material's number ``sky`` gives the colours (SKY, 3) that it has in each cell of the sphere,
        ``matrix`` those (3, 16) of light in bands.
        """
        result = np.zeros((len(self), 3), np.float32)
        told = np.zeros(len(self), np.float32)
        filters = np.array(space.filters) if space.filters else None
        edges = np.flatnonzero(np.diff(self.kind, prepend=-1, append=-1))
        own = np.zeros((space.rows, 8), np.float32)
        own[:, 3] = tells
        for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            kind, part = int(self.kind[first]), slice(first, last)
            seen = sky(kind).astype(np.float32)
            own[: space.sky, :3] = table[: space.sky] @ matrix(kind).T.astype(np.float32)
            own[space.sky : space.lost, 4:7] = seen
            sums = np.zeros((last - first, 8), np.float32)
            for hits in self.passes:
                some = hits.part(part)
                sums += gather(some, own) * some.rows.shape[1]
                if filters is not None and len(some.odd):
                    light = table.take(some.odd_rows, axis=0) * filters.take(some.odd_filter, 0)
                    colour = light @ matrix(kind).T.astype(np.float32)
                    point = some.odd // some.rows.shape[1]
                    for k in range(3):
                        sums[:, k] += np.bincount(point, colour[:, k], last - first)
            rays = len(self.pattern)
            scale = np.maximum(sums[:, 3:4], 1.0)
            exact = self._open(part, seen) * sums[:, 4:7]
            result[part] = (sums[:, :3] + exact) / scale
            told[part] = sums[:, 3] / rays
        told[self.hidden] = 0.0
        return result, told

    def _open(self, part: slice, sky: NDArray[np.float32]) -> NDArray[np.float64]:
        """By what a sky's light on open faces is more than the pattern's rays tell, (n, 3).

        So what nothing hides is without error, and what hides half takes half of the true light.
        """
        rounded = np.round(self.normals[part], 2)
        normals, index = np.unique(rounded, axis=0, return_inverse=True)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
        light = directions.open_light(sky, normals)
        told = np.empty_like(light)
        for k in range(0, len(normals), 256):
            ways = directions.about(normals[k : k + 256], self.pattern)
            told[k : k + 256] = sky[directions.cells(ways)].mean(axis=1)
        ratio = np.clip(light / np.where(told > 0.0, told, 1.0), 0.5, 2.0)
        return np.where(told > 0.0, ratio, 1.0)[index.reshape(-1)]


def filled(fine: Fine, colours: NDArray, told: NDArray) -> NDArray:
    """Return colours (p, 3) of points, of those in or under something their neighbours', two cells
    far: the foot of a wall casts no shadow on the floor beside it. Twins have their cells'."""
    known = told >= UNTOLD
    one, other = fine.point, fine.point[fine.following]
    one, other = np.concatenate([one, other]), np.concatenate([other, one])
    twin = np.arange(len(known)) >= len(known) - len(fine.twin_of)
    colours = colours.copy()
    for last in (False, False, True):
        if last:  # at least what their cells' other corners have, told or not
            known = ~(twin & ~known)
        pairs = np.flatnonzero(~known[one] & known[other])
        count = np.bincount(one[pairs], minlength=len(known))
        reached = count > 0
        for k in range(3):
            sums = np.bincount(one[pairs], colours[other[pairs], k], len(known))
            colours[reached, k] = sums[reached] / count[reached]
        known = known | reached
    return colours
