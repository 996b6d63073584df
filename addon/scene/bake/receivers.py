"""Where light is wanted: the points of baked objects, and where rays start from them."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from ...transport.hits import Space
from .fine_mesh import Fine

COVER = 0.1
"""What lies so near over a point, of its cells' size, hides it: a rug, or a door on a wall."""

UNTOLD = 0.5
"""A point of whose rays less than this part tell anything lies in something solid."""


class Points:
    """The points of a mesh in the world, and where rays start from them.

    ``origin`` (3,) and ``size``: the scene's, as `Geometry` has them.
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
        # float32 is finest about the origin.
        least = np.maximum(size, 2.0 * np.abs(fine.mean(at)).max(axis=1)) * 2e-6
        lift = np.clip(1e-3 * radius, least, 10.0 * least)
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
    points: Points | None
    """None once it is among `Receivers`."""
    backs: NDArray[np.bool_]
    """(p,), whether light is wanted behind."""
    numbers: dict[float, tuple[NDArray, NDArray]] = field(default_factory=dict)
    """By side, points and their numbers."""


class Receivers:
    """All points that want light, by material.

    ``places``, ``normals`` (n, 3) and ``kind`` (n,), each point's number among ``materials``.
    """

    def __init__(self, targets: Sequence[Target], materials: Sequence[str]) -> None:
        self.targets = list(targets)
        number = {name: k for k, name in enumerate(materials)}
        places, normals, kinds, covers = [], [], [], []
        spans: list[tuple[Target, float, NDArray]] = []
        for target in targets:
            points, target.points = target.points, None
            assert points is not None
            of_slot = np.array([number.get(name, 0) for name in target.fine.materials], np.int32)
            for side, wanted in ((1.0, points.shown), (-1.0, points.shown & target.backs)):
                chosen = np.flatnonzero(wanted)
                spans.append((target, side, chosen))
                if not len(chosen):
                    continue
                places.append(points.starts(side)[chosen].astype(np.float32))
                normals.append((side * points.normals[chosen]).astype(np.float32))
                kinds.append(of_slot[points.slot[chosen]])
                covers.append(points.cover[chosen])
        kind = np.concatenate([*kinds, np.empty(0, np.int32)])
        order = np.argsort(kind, kind="stable")
        none = np.empty((0, 3), np.float32)
        self.places = np.concatenate([*places, none])[order]
        self.normals = np.concatenate([*normals, none])[order]
        self.kind = kind[order]
        self.cover = np.concatenate([*covers, np.empty(0)])[order]
        self.hidden = np.zeros(len(order), bool)
        """(n,), whether something lies so near over a point that it has no light of its own."""
        back = np.empty(len(order), np.int32)
        back[order] = np.arange(len(order))
        first = 0
        for target, side, chosen in spans:
            target.numbers[side] = chosen, back[first : first + len(chosen)]
            first += len(chosen)

    def look(self, space: Space) -> Generator[float, None, None]:
        """Find which are `hidden`, yielding 0 to 1."""
        self.hidden, _ = yield from space.hiding(self.places, self.normals, self.cover)

    def __len__(self) -> int:
        return len(self.places)


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
