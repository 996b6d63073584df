"""Light that goes round between cells until a further bounce changes nothing.

B = emission + rho E,  E = E_direct + mean of B over a cell's rays (C. Goral et al. 1984, DOI
10.1145/964965.808601, by rays as in F. Sillion and C. Puech 1989, DOI 10.1145/74334.74368). From
each patch go rays that start all over it; their hits are kept, so that every sweep, and every other
light, costs a look-up of the table alone.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from . import directions
from .cells import Matter
from .hits import Growing, Hits, Space, gather

ENOUGH = 2e-4
"""Sweeps end when the last changes no cell by more than this part of the mean."""

UNLIT = 5e-3
"""A back with less than this part of the mean light is inside something that leaks."""

STARTS = 32
"""Places on a patch that its rays start from, one after another."""

COVER = 0.2
"""What lies so near before a place, of its cell's side, and along it, hides it: a rug, a door."""

MOST = 200
"""Sweeps; and in a closed room as many times the light that comes first: where surfaces reflect all
of it there is no end."""


@dataclass
class Direct:
    """A lamp or the sun, whose light is cast with shadows.

    ``spectrum`` (16,): irradiance / pi on a face that looks at it, at a distance of 1 where it is
    not endlessly far.
    """

    place: NDArray[np.float64] | None
    """(3,); None for one that is endlessly far."""
    direction: NDArray[np.float64]
    """(3,): towards the far one; else the axis that it shines along."""
    spectrum: NDArray[np.float32]
    cone: tuple[float, float] = (-1.0, -1.0)
    """Cosines from the axis where a spot's light ends, and where it is whole."""
    area: NDArray[np.float64] | None = None
    """(2, 3): the half sides of one that is flat, which shines by the cosine to one side."""
    radius: float = 0.0
    """Of a ball."""

    def seen_from(self, origin: NDArray[np.float64]) -> Direct:
        """Return the same lamp where places are relative to an origin (3,)."""
        return self if self.place is None else replace(self, place=self.place - origin)


class Radiosity:
    """The patches of a space with the hits of their rays."""

    def __init__(self, space: Space) -> None:
        self.space = space
        cells = space.cells
        first = cells.first
        backs = np.flatnonzero(~cells.solid[first] & ~space.matter.clear[cells.kind[first]])
        self.patch = np.concatenate([np.arange(cells.patches), backs])
        """(r,), of which patch each side is."""
        self.side = np.concatenate([np.ones(cells.patches), -np.ones(len(backs))])
        self.row = np.where(self.side > 0, self.patch, self.patch + cells.patches)
        """(r,), its row in the table."""
        self.hits = Hits(np.empty((0, 1), np.int32))
        self.counts = np.ones((len(self.patch), STARTS), bool)
        """(r, STARTS), which places tell the side's light: not what is in or under something."""
        self.enclosed = np.zeros(len(self.patch), bool)
        """(r,), whether none of its rays leaves the scene."""
        self.take(space.matter)
        self.E = np.zeros((len(self.patch), self.rho.shape[1]), np.float32)
        """(r, 16), irradiance / pi that `solve` found."""
        self.first = self.E
        """(r, 16), the part of it that has not bounced."""
        self.direct = self.E
        """(r, 16), the part of that which rays do not meet: of lamps and the sun."""

    def take(self, matter: Matter) -> None:
        """Let kinds reflect and send otherwise than before; what they let through stays."""
        kind = self.space.cells.kind[self.space.cells.first]
        self.rho = matter.reflectance[kind[self.patch]]
        self.emission = matter.emission[kind]

    def _starts(self, part, shares):
        """Where rays start on some sides, (k, r, 3), and the normals there."""
        cells = self.space.cells
        places, at = cells.places(shares, self.patch[part])
        normals = cells.normals[at] * self.side[part, None, None].astype(np.float32)
        return places + self.space.lift * normals, normals, at

    def cast(self, rays: int, alike: bool = False) -> Iterator[float]:
        """Cast so many rays from each side of each patch, yielding 0 to 1.

        ``alike``: in the same directions from all of one normal, so that neighbours err alike and
        differ by their light alone; else turned at random, so that errors cancel.
        """
        found = Growing(len(self.patch), rays)
        rng = np.random.default_rng(1)
        # Which direction starts where is no pattern, and no two patches have the same turn.
        pattern = directions.pattern(rays)[rng.permutation(rays)]
        shares = _even(STARTS)
        turn = np.arange(rays) % STARTS
        turns = rng.random(len(self.patch)) * (0.0 if alike else 2.0 * np.pi)
        step = max(1, self.space.chunk // rays)
        for first in range(0, len(self.patch), step):
            part = slice(first, first + step)
            starts, normals, at = self._starts(part, shares)
            reach = COVER * np.sqrt(self.space.cells.areas[at])
            hidden = np.logical_or(*self.space.hidden(starts, normals, reach))
            self.counts[part] = ~hidden | hidden.all(axis=1)[:, None]
            frames = directions.frames(normals.reshape(-1, 3)).reshape(*normals.shape, 3)
            turned = directions.turned(pattern, turns[part])
            ways = np.einsum("nrk,nrkx->nrx", turned, frames[:, turn])
            hits = self.space.met(starts[:, turn], ways)
            hits.rows[~self.counts[part][:, turn]] = self.space.lost
            found.add(hits)
            yield min(1.0, (first + step) / len(self.patch))
        self.hits = found.hits
        beyond = (self.hits.rows >= self.space.sky) & (self.hits.rows < self.space.lost)
        # Of a patch that is partly in something too few rays are left to say so.
        self.enclosed = ~beyond.any(axis=1) & self.counts.all(axis=1)

    def lit_by(
        self, lamps: list[Direct], starts: int = 16
    ) -> Generator[float, None, NDArray[np.float32]]:
        """Return the irradiance / pi (r, 16) that lamps cast on each side, in shadow or not, by so
        many rays to each, yielding 0 to 1."""
        rng = np.random.default_rng(2)
        result = np.zeros_like(self.E)
        if not lamps:
            return result
        shares = _even(starts)
        counts = self.counts[:, :starts]
        weight = np.where(counts.any(axis=1)[:, None], counts, True).astype(np.float32)
        weight /= weight.sum(axis=1, keepdims=True)
        step = max(1, self.space.chunk // starts)
        for first in range(0, len(self.patch), step):
            part = slice(first, first + step)
            places, normals, _ = self._starts(part, shares)
            shape = places.shape[:2]
            for lamp in lamps:
                lit = shine(self.space, lamp, places.reshape(-1, 3), normals.reshape(-1, 3), rng)
                result[part] += np.einsum("nsk,ns->nk", lit.reshape(*shape, -1), weight[part])
                yield min(1.0, (first + step) / len(self.patch))
        return result

    def solve(
        self, sky: NDArray[np.float32], direct: NDArray[np.float32], leaks: bool = True
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], int]:
        """Return the table (rows, 16) of light that comes from all patches and the sky, which rows
        tell anything (rows,), 1 or 0, and how many sweeps it took.

        ``sky`` (SKY, 16): radiance of the sphere's cells; ``direct`` (r, 16): irradiance / pi of
        what rays do not meet. A side that is enclosed, has no light and sees none that has is the
        inside of something: a ray from there tells nothing of the light before it. Not ``leaks``:
        it is just dark.
        """
        space = self.space
        tells = np.ones(space.rows, np.float32)
        tells[space.lost] = 0.0
        table, sweeps = self._spread(sky, direct, tells)
        if not leaks or not len(self.patch):
            return table, tells, sweeps
        bright = self.E.mean(axis=1)
        lit = bright > UNLIT * bright.mean()
        seen = np.zeros((space.rows, 4), np.float32)
        seen[self.row] = lit[:, None]
        # Few rays may miss a small lamp: who sees what has met it is in no other room than that.
        sees_lit = gather(self.hits, seen)[:, 0] > 0.0
        unlit = ~lit & (self.side < 0) | (bright <= 0.0) & ~sees_lit
        unlit &= self.enclosed
        if unlit.any() and not unlit.all():
            tells[self.row[unlit]] = 0.0
            table, more = self._spread(sky, direct, tells, self.E)  # little has changed
            sweeps += more
        return table, tells, sweeps

    def _spread(self, sky, direct, tells, near=None):
        space, fronts = self.space, self.space.cells.patches
        filters = np.array(space.filters) if space.filters else None
        table = np.zeros((space.rows, sky.shape[1]), np.float32)
        # Rays through panes have the row `dark`, which tells.
        told = gather(self.hits, np.repeat(tells[:, None], 4, axis=1))[:, :1]
        share = 1.0 / np.maximum(told, 1e-3)
        rho = self.rho * tells[self.row, None]

        def arriving():
            return share * gather(self.hits, table, filters)

        table[space.sky : space.lost] = sky
        table[:fronts] = self.emission
        first = direct + arriving()
        E = first if near is None else near
        table[space.sky : space.lost] = 0.0
        table[:fronts] = 0.0
        areas = np.bincount(space.cells.patch, space.cells.areas, fronts)[self.patch]
        sweep = 0
        while sweep < MOST:
            sweep += 1
            table[self.row] = rho * E
            bounced = arriving()
            new = first + bounced
            if sweep > 1:
                new = first + _balanced(areas, first, E, bounced) * bounced
            change = np.abs(new - E).max(initial=0.0)
            E = new
            if change <= ENOUGH * max(float(E.sum()) / max(E.size, 1), 1e-30):
                break
        self.E, self.first, self.direct = E, first, direct
        table[self.row] = rho * E
        table[:fronts] += self.emission
        table[space.sky : space.lost] = sky
        return table, sweep


def _balanced(areas, first, E, bounced) -> NDArray[np.float32]:
    """Return by which factor (16,) light E must be brighter all over for what arrives, at ``first``
    and ``bounced``, to be as much as itself: of light that goes round and round a sweep more tells
    little, its balance tells all (a Galerkin step with E as the only basis)."""
    comes, is_there, goes_round = (areas @ light for light in (first, E, bounced))
    lost = is_there - goes_round
    holds = lost * MOST > is_there
    return np.where(holds, comes / np.where(holds, lost, 1.0), 1.0).astype(np.float32)


def _even(count: int) -> NDArray[np.float64]:
    """Points (count, 3) that fill the unit cube evenly: Kronecker's sequence by the roots of
    x^4 = x + 1 (M. Roberts 2018)."""
    steps = 1.2207440846057596 ** -np.arange(1.0, 4.0)
    return (0.5 + (np.arange(count)[:, None] + 1.0) * steps) % 1.0


def shine(
    space: Space,
    lamp: Direct,
    starts: NDArray[np.float32],
    normals: NDArray[np.float32],
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """Return the irradiance / pi (n, 16) of a lamp on points (n, 3), by one shadow ray each."""
    result = np.zeros((len(starts), len(lamp.spectrum)), np.float32)
    if lamp.place is None:
        ways = np.broadcast_to(np.asarray(lamp.direction, np.float32), starts.shape)
        far, strength = None, np.ones(len(starts), np.float32)
    else:
        place = np.broadcast_to(lamp.place, starts.shape)
        if lamp.area is not None:
            place = place + (rng.random((len(starts), 2)) * 2.0 - 1.0) @ lamp.area
        to = place - starts
        far = np.linalg.norm(to, axis=1)
        ways = (to / np.maximum(far, 1e-9)[:, None]).astype(np.float32)
        strength = 1.0 / np.maximum(far, max(lamp.radius, 1e-6)) ** 2
        axis = -(ways @ np.asarray(lamp.direction, np.float32))
        if lamp.area is not None:
            strength *= np.maximum(axis, 0.0)
        elif lamp.cone[1] > -1.0:
            end, whole = lamp.cone
            t = np.clip((axis - end) / max(whole - end, 1e-6), 0.0, 1.0)
            strength *= t * t * (3.0 - 2.0 * t)
    strength = strength * np.einsum("nk,nk->n", ways, normals)
    lit = np.flatnonzero(strength > 0.0)
    if not len(lit):
        return result
    ways = np.ascontiguousarray(ways[lit])
    rows, odd, passed = space.trace(starts[lit], ways, None if far is None else far[lit])
    seen = (rows >= space.sky) & (rows < space.lost)
    light = np.where(seen, strength[lit], 0.0).astype(np.float32)[:, None] * lamp.spectrum
    if len(odd):
        light[odd] *= np.array(space.filters)[passed]
    result[lit] = light
    return result
