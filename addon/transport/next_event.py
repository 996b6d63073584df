"""Light of small emitters on places, by rays to them: their visible parts as form factors.

What is kept of a place is how much of each kind's radiance comes to it, so that another colour or
strength of theirs casts no ray.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .even import even
from .hits import Space

EACH, RAYS = 8, (16, 1024)
"""A place casts one ray to emitters for so many all about it, at least and at most."""

BRANCHES = 256
"""Of the tree of emitters, that a place chooses from at first, at most."""

ENTRIES = 2**18
"""About so many are multiplied at once: 16 MB."""

SHORT = 1e-4
"""A ray to an emitter ends before it by this part of its length."""


@dataclass(frozen=True)
class Sought:
    """What comes from emitters to places: the number of a ``place`` (k,), ascending, of ``which``
    emitters and filter (k,), and what part of their radiance is irradiance / pi there (k,)."""

    place: NDArray[np.int32]
    which: NDArray[np.int32]
    part: NDArray[np.float32]

    @classmethod
    def none(cls) -> Sought:
        """Return what comes where nothing is sought."""
        return cls(np.empty(0, np.int32), np.empty(0, np.int32), np.empty(0, np.float32))

    @classmethod
    def joined(cls, parts: Sequence[Sought]) -> Sought:
        """Return all of some for places that follow one another, counted from the first's."""
        names = "place", "which", "part"
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in names))

    def after(self, first: int) -> Sought:
        """Return the same for places counted from further on."""
        return Sought(self.place + first, self.which, self.part)

    def of(self, places: slice) -> Sought:
        """Return that for some places which follow one another."""
        first, last = np.searchsorted(self.place, [places.start, places.stop]).tolist()
        return Sought(
            self.place[first:last] - places.start, self.which[first:last], self.part[first:last]
        )

    def summed(self) -> Sought:
        """Return one entry for each place and sort of light, in their order."""
        sorts = int(self.which.max(initial=0)) + 1
        keys = self.place.astype(np.int64) * sorts + self.which
        keys, number = np.unique(keys, return_inverse=True)
        sums = np.bincount(number.reshape(-1), self.part, len(keys)).astype(np.float32)
        return Sought((keys // sorts).astype(np.int32), (keys % sorts).astype(np.int32), sums)

    def light(self, space: Space, table: NDArray, count: int) -> NDArray[np.float32]:
        """Return irradiance / pi (count, 16) on so many places by a table (rows, 16)."""
        result = np.zeros((count, table.shape[1]), np.float32)
        if not len(self.place):
            return result
        own = space.own(table)
        which, sort = np.unique(self.which, return_inverse=True)
        passed, kind = np.divmod(which, len(own))
        through = np.array([np.ones(table.shape[1], np.float32), *space.filters])
        radiance = own[kind] * through[passed]
        ends = np.flatnonzero(np.diff(self.place, append=-1)) + 1
        for some in np.array_split(ends, -(-len(self.place) // ENTRIES)):
            first = int(np.searchsorted(self.place, self.place[some[0] - 1]))
            part = slice(first, int(some[-1]))
            light = self.part[part, None] * radiance[sort.reshape(-1)[part]]
            starts = np.concatenate([[0], some[:-1] - first])
            result[self.place[some - 1]] = np.add.reduceat(light, starts, axis=0)
        return result


def rays_beside(rays: int) -> int:
    """Return how many rays to emitters go with so many all about a place."""
    return int(np.clip(rays // EACH, *RAYS))


def seek(
    space: Space, starts: NDArray[np.float32], normals: NDArray[np.float32], rays: int
) -> Sought:
    """Return what comes from emitters to points (n, 3) that look along normals (n, 3), by so many
    rays from each.

    For each ray a part is chosen by what it would send if nothing were between, and a place on it
    (D. Talbot et al. 2005, DOI 10.2312/EGWR/EGSR05/139-146). All points choose alike, so that
    neighbours err alike.
    """
    found = [Sought.none()]
    if len(space.emitters):
        shares = even(rays)
        for own, cut in space.emitters.tree.cuts(starts, BRANCHES):
            light = _seek(space, starts[own], normals[own], cut, shares)
            found.append(Sought(own[light.place], light.which, light.part))
    return Sought.joined(found).summed()


def _seek(space, starts, normals, cut, shares) -> Sought:
    emitters, rays = space.emitters, len(shares)
    point, part, chance = _chosen(emitters.tree, cut, starts, normals, shares[:, 0])
    root, along = np.sqrt(shares[:, 1]), shares[:, 2]
    weight = np.stack([1.0 - root, root * (1.0 - along), root * along], axis=1)
    corners = emitters.corners[part].reshape(-1, rays, 3, 3)
    to = np.einsum("rc,nrcx->nrx", weight, corners).reshape(-1, 3) - starts[point]
    far = np.linalg.norm(to, axis=1)
    ways = (to / np.maximum(far, 1e-30)[:, None]).astype(np.float32)
    here = np.einsum("nk,nk->n", ways, normals[point])
    there = -np.einsum("nk,nk->n", ways, emitters.normals[part])
    there = np.where(emitters.two_sided[part], np.abs(there), there)
    sent = np.maximum(here, 0.0) * np.maximum(there, 0.0) / np.maximum(far, 1e-30) ** 2
    kind = emitters.kind[part]
    light = sent * emitters.areas[part] * emitters.opacity[kind] / np.maximum(chance, 1e-30)
    light[(far <= emitters.reach[emitters.cell[part]]) | (chance <= 0.0)] = 0.0
    going = np.flatnonzero(light > 0.0)
    point, kind, light, far = point[going], kind[going], light[going], far[going]
    short = far * (1.0 - SHORT) - 2.0 * space.lift(starts[point])[:, 0]
    ends, odd, passed = space.trace(starts[point], np.ascontiguousarray(ways[going]), short)
    kind[odd] += (passed + 1) * len(emitters.kinds)
    seen = (ends >= space.sky) & (ends < space.lost)
    return Sought(point[seen], kind[seen], light[seen] / (np.pi * rays)).summed()


def _chosen(tree, cut, starts, normals, steps) -> tuple[NDArray, NDArray, NDArray]:
    """Choose for points (n, 3), by what comes at most from branches of a cut and on from there, as
    many parts as there are steps (rays,): return the number of each point to which any may come, so
    many times, the parts, and with how much chance each is chosen."""
    may = tree.shape(cut, starts[:, None], normals[:, None]) * tree.power[cut]
    total = np.cumsum(may, axis=1, dtype=float)
    lit = np.flatnonzero(total[:, -1] > 0.0)
    total = total[lit] / total[lit, -1:]
    rows = np.arange(len(lit))
    flat = (total + rows[:, None]).ravel()
    picked = np.searchsorted(flat, (rows[:, None] + steps).ravel(), side="right")
    row = np.repeat(rows, len(steps))
    picked = np.clip(picked - row * len(cut), 0, len(cut) - 1)
    # What is left of a step goes on from the branch, so that parts too are chosen evenly.
    below = np.where(picked > 0, total[row, picked - 1], 0.0)
    own = total[row, picked] - below
    rest = np.clip((np.tile(steps, len(lit)) - below) / np.maximum(own, 1e-30), 0.0, 1.0)
    point = lit[row]
    part, chance = tree.descend(cut[picked], starts[point], normals[point], rest)
    return point, part, own * chance
