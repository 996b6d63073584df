"""Parts of emitters in a tree, of which places take large branches far off and single parts nearby.

For places that are near each other one cut through the tree is made; each then chooses along it by
what comes at most to itself (B. Walter et al. 2005, DOI 10.1145/1073204.1073318; A. Conty Estevez
and C. Kulla 2018, DOI 10.1145/3233305).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

TOGETHER = 256
"""Places for which the tree is cut at once."""


def along_a_curve(places: NDArray) -> NDArray[np.int64]:
    """Return the order of places (n, 3) in which those that follow one another are near (G. Morton
    1966, A Computer Oriented Geodetic Data Base)."""
    low = places.min(axis=0, initial=np.inf)
    span = max(float(np.ptp(places, axis=0).max(initial=0.0)) if len(places) else 0.0, 1e-30)
    at = np.minimum((places - low) / span * 1024.0, 1023.0).astype(np.int64)
    key = np.zeros(len(places), np.int64)
    for bit in range(10):
        for axis in range(3):
            key |= (at[:, axis] >> bit & 1) << (3 * bit + axis)
    return np.argsort(key, kind="stable")


@dataclass
class Branches:
    """Branches (b,) of a tree; of parts alone each is one."""

    first: NDArray[np.int64]
    """The first of its parts, which follow one another, …"""
    last: NDArray[np.int64]
    """… and the one after the last."""
    child: NDArray[np.int64]
    """(b, 2), what it branches into; -1 of a part."""
    middle: NDArray[np.float32]
    radius: NDArray[np.float32]
    """Of a ball about all of it."""
    axis: NDArray[np.float32]
    spread: NDArray[np.float32]
    """The mean normal, and the sine of the largest angle with it; 2 from a right one on."""
    two_sided: NDArray[np.bool_]
    reach: NDArray[np.float32]
    """The least of its parts'."""
    power: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.first)

    def shape(
        self, chosen: NDArray, places: NDArray[np.float32], normals: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """Return about what branches (...) send to places (..., 3) of normals (..., 3) by their
        power: two cosines over the distance's square, (...), above 0 where any place of one sends
        anything that is not left to chance."""
        to = [self.middle[chosen, k] - places[..., k] for k in range(3)]
        far = np.sqrt(to[0] ** 2 + to[1] ** 2 + to[2] ** 2)
        radius = self.radius[chosen]
        near = far + radius <= self.reach[chosen]
        far = np.maximum(far, np.maximum(radius, np.float32(1e-12)))
        wide = radius / far
        here = sum(to[k] * normals[..., k] for k in range(3)) / far
        there = -sum(to[k] * self.axis[chosen, k] for k in range(3)) / far
        there = np.where(self.two_sided[chosen], np.abs(there), there)
        found = _cosine(here, wide) * _cosine(there, wide + self.spread[chosen]) / far**2
        return np.where(near, np.float32(0.0), found)

    def descend(
        self,
        branch: NDArray[np.int64],
        places: NDArray[np.float32],
        normals: NDArray[np.float32],
        steps: NDArray[np.float64],
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Choose a part (n,) of each branch (n,) for places (n, 3) of normals (n, 3) by steps (n,)
        from 0 to 1; return with how much chance (n,) too, 0 where none sends anything."""
        part, steps, chance = branch.copy(), steps.copy(), np.ones(len(branch))
        while True:
            going = np.flatnonzero((self.child[part, 0] >= 0) & (chance > 0.0))
            if not len(going):
                return self.first[part], chance
            pair = self.child[part[going]]
            may = self.shape(pair, places[going, None], normals[going, None]) * self.power[pair]
            may[pair[:, 1] < 0, 1] = 0.0
            total = may.sum(axis=1, dtype=float)
            left = may[:, 0] / np.where(total > 0.0, total, 1.0)
            right = steps[going] >= left
            own = np.where(right, 1.0 - left, left)
            rest = (steps[going] - np.where(right, left, 0.0)) / np.maximum(own, 1e-30)
            steps[going] = np.clip(rest, 0.0, 1.0)
            chance[going] *= np.where(total > 0.0, own, 0.0)
            part[going] = np.where(right & (pair[:, 1] >= 0), pair[:, 1], pair[:, 0])

    def cuts(self, places: NDArray[np.float32], most: int) -> Iterator[tuple[NDArray, NDArray]]:
        """Yield numbers of places (n, 3) that are near each other, and of branches (m,) that hold
        all parts once, at most so many: the finer the more comes from them to there."""
        parts = int(self.last.max(initial=0))
        many = parts > most
        order = along_a_curve(places) if many else np.arange(len(places))
        for first in range(0, len(order), TOGETHER):
            own = order[first : first + TOGETHER]
            yield own, self._cut(places[own], most) if many else np.arange(parts)

    def _cut(self, places: NDArray[np.float32], most: int) -> NDArray[np.int64]:
        low, high = places.min(axis=0), places.max(axis=0)
        middle, half = (low + high) / 2.0, float(np.linalg.norm(high - low)) / 2.0
        cut = np.array([len(self) - 1])
        while True:
            to = self.middle[cut] - middle
            far = np.maximum(np.linalg.norm(to, axis=1), 1e-30)
            room = self.radius[cut] + half
            facing = -np.einsum("nk,nk->n", to, self.axis[cut]) / far
            facing = np.where(self.two_sided[cut], np.abs(facing), facing)
            facing = np.clip(facing + room / far + self.spread[cut], 0.0, 1.0)
            away = np.maximum(far, room)
            # What one of its parts may send more than another, at most.
            doubt = self.power[cut] * facing / away**2 * self.radius[cut] / away
            doubt[self.child[cut, 0] < 0] = 0.0
            left = most - len(cut)
            if left <= 0 or not doubt.any():
                return cut
            split = doubt > 0.25 * doubt.max()
            if split.sum() > left:
                split = np.zeros(len(cut), bool)
                split[np.argsort(-doubt, kind="stable")[:left]] = True
            children = self.child[cut[split]].ravel()
            cut = np.concatenate([cut[~split], children[children >= 0]])


def _cosine(cosine: NDArray, wide: NDArray) -> NDArray:
    """The mean of what is above 0 of cosines that lie evenly about one, so far to either side."""
    edge = np.maximum(cosine + wide, 0.0) ** 2 / (4.0 * np.maximum(wide, 1e-30))
    return np.where(cosine > wide, cosine, edge)


def tree(
    corners: NDArray[np.float64],
    normals: NDArray[np.float32],
    two_sided: NDArray[np.bool_],
    reach: NDArray[np.float32],
    power: NDArray[np.float32],
) -> Branches:
    """Return the tree of parts (p,), triangles (p, 3, 3) along a curve: first the parts, at last
    all."""
    count = len(corners)
    parts = np.arange(count)
    bounds = corners.min(axis=1, initial=np.inf), corners.max(axis=1, initial=-np.inf)
    level = (parts, parts + 1, *bounds, two_sided, reach, power.astype(float))
    pairs, levels = [np.full((count, 2), -1)], [level]
    start = 0
    while count > 1:
        at = np.arange(0, count, 2)
        folds = (np.minimum, np.maximum, np.minimum, np.maximum, np.logical_or, np.minimum, np.add)
        level = tuple(f.reduceat(e, at, axis=0) for f, e in zip(folds, level, strict=True))
        other = np.where(at + 1 < count, start + at + 1, -1)
        pairs.append(np.stack([start + at, other], axis=1))
        levels.append(level)
        start, count = start + count, len(at)
    first, last, low, high, two_sided, reach, power = map(np.concatenate, zip(*levels, strict=True))
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(normals.astype(float), axis=0)])
    axis = sums[last] - sums[first]
    axis /= np.maximum(np.linalg.norm(axis, axis=1), 1e-30)[:, None]
    least, start = np.ones(len(first)), 0
    for each in (len(pair) for pair in pairs if len(pair)):  # level by level, each of all parts
        some = slice(start, start + each)
        cosine = np.einsum(
            "nk,nk->n", np.repeat(axis[some], last[some] - first[some], axis=0), normals
        )
        least[some] = np.minimum.reduceat(cosine, first[some])
        start += each
    spread = np.where(least > 1e-3, np.sqrt(np.maximum(1.0 - least**2, 0.0)), 2.0)
    radius = np.linalg.norm(high - low, axis=1) / 2.0
    return Branches(
        first,
        last,
        np.concatenate(pairs),
        ((low + high) / 2.0).astype(np.float32),
        radius.astype(np.float32),
        axis.astype(np.float32),
        spread.astype(np.float32),
        two_sided.astype(bool),
        reach.astype(np.float32),
        power.astype(np.float32),
    )
