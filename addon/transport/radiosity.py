"""Light that goes round between cells until a further bounce changes nothing.

B = emission + rho E,  E = E_direct + mean of B over a cell's rays (C. Goral et al. 1984, DOI
10.1145/964965.808601, by rays as in F. Sillion and C. Puech 1989, DOI 10.1145/74334.74368). From
each patch go rays that start all over it; their hits are kept, so that every sweep, and every other
light, costs a look-up of the table alone.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from . import directions
from .beams import Columns
from .cells import Matter
from .even import even
from .hits import Growing, Hits, Space, gather
from .lamps import Direct, sent, shine
from .next_event import Sought, seek

ENOUGH = 2e-4
"""Sweeps end when the last changes no cell by more than this part of the mean."""

UNLIT = 5e-3
"""A back with less than this part of the mean light is inside something that leaks."""

STARTS = 32
"""Places on a patch that its rays start from, one after another."""

SEEKING, SEEK = 4, 8
"""Of them so many seek emitters, by so many rays each."""

COVER = 0.2
"""What lies so near before a place, of its cell's side, and along it, hides it: a rug, a door."""

MOST_STARTS, LEAST_RAYS = 1024, 2**17
"""Places on a patch, at most, that see a lamp; and rays from all to it, where there are few."""

MOST = 200
"""Sweeps; and in a closed room as many times the light that comes first: where surfaces reflect all
of it there is no end."""


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
        self._side_of = np.full(space.rows, -1)
        self._side_of[self.row] = np.arange(len(self.row))
        self.hits = Hits(np.empty((0, 1), np.int32))
        self.sought = Sought.none()
        """What comes to the sides from small emitters."""
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
        """(r, 16), the part of that which lamps and the sun send."""

    def take(self, matter: Matter) -> None:
        """Let kinds reflect and send otherwise than before; what they let through stays."""
        kind = self.space.cells.kind[self.space.cells.first]
        self.rho = matter.reflectance[kind[self.patch]]
        self.emission = matter.emission[kind[self.patch]]

    def _starts(self, part, shares):
        """Where rays start on some sides, (k, r, 3), and the normals there."""
        cells = self.space.cells
        places, at = cells.places(shares, self.patch[part])
        normals = cells.normals[at] * self.side[part, None, None].astype(np.float32)
        return places + self.space.lift(places) * normals, normals, at

    def cast(self, rays: int, alike: bool = False) -> Iterator[float]:
        """Cast so many rays from each side of each patch, yielding 0 to 1.

        ``alike``: in the same directions from all of one normal, so that neighbours err alike and
        differ by their light alone; else turned at random, so that errors cancel.
        """
        found, sought = Growing(len(self.patch), rays), [Sought.none()]
        rng = np.random.default_rng(1)
        # Which direction starts where is no pattern, and no two patches have the same turn.
        pattern = directions.pattern(rays)[rng.permutation(rays)]
        shares = even(STARTS)
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
            sought.append(self._sought(self.counts[part], starts, normals).after(first))
            hits = self.space.met(starts[:, turn], ways, sought=True)
            hits.rows[~self.counts[part][:, turn]] = self.space.lost
            found.add(hits)
            yield min(1.0, (first + step) / len(self.patch))
        self.hits, self.sought = found.hits, Sought.joined(sought)
        beyond = (self.hits.rows >= self.space.sky) & (self.hits.rows < self.space.lost)
        # Of a patch that is partly in something too few rays are left to say so.
        self.enclosed = ~beyond.any(axis=1) & self.counts.all(axis=1)

    def _sought(self, counts, starts, normals) -> Sought:
        """What comes from small emitters to some of the places (k, r, 3) on sides that count."""
        if not len(self.space.emitters):
            return Sought.none()
        chosen = np.argsort(~counts, axis=1, kind="stable")[:, :SEEKING]
        count = np.take_along_axis(counts, chosen, axis=1)
        at, along = (
            np.take_along_axis(each, chosen[..., None], axis=1).reshape(-1, 3)
            for each in (starts, normals)
        )
        found = seek(self.space, at.astype(np.float32), along.astype(np.float32), SEEK)
        share = count / count.sum(axis=1, keepdims=True)
        part = found.part * share.reshape(-1)[found.place].astype(np.float32)
        return Sought(found.place // SEEKING, found.which, part).summed()

    def lit_by(
        self, lamps: list[Direct], starts: int = 16
    ) -> Generator[float, None, NDArray[np.float32]]:
        """Return the irradiance / pi (r, 16) that lamps cast on each side, in shadow or not, by so
        many rays to each, and again by more where they differ, yielding 0 to 1.

        Half as many more in all, where they lessen the error of all that is sent on most (J.
        Neyman 1934, DOI 10.2307/2342192). What one cell of a triangle tells of a beam that others
        may have missed counts for all. Thin beams of the sun are counted by rays from it.
        """
        rng = np.random.default_rng(2)
        result = np.zeros_like(self.E)
        if not lamps or not len(self.patch):
            return result
        cells, sides = self.space.cells, np.arange(len(self.patch))
        least = max(starts, min(MOST_STARTS // 4, LEAST_RAYS // len(sides)))
        starts = 2 ** int(np.log2(least))
        spread = np.zeros(len(sides))
        lamps, *found = self._found_from(lamps, starts * len(sides) // 8)
        for done in self._lit(lamps, starts, sides, rng, result, spread):
            yield 0.5 * done
        np.maximum.at(spread, *found)
        group = cells.triangle[cells.first][self.patch]
        most = np.zeros(len(cells.level))
        np.maximum.at(most, group, spread)
        # What is once in a patch of which nothing was seen is as uncertain as the first that was.
        need = self._areas * np.maximum(spread, most[group] / np.sqrt(starts))
        share = need / max(float(need.sum()), 1e-30)
        wanted = share * max(starts * len(sides) / 2, LEAST_RAYS) / starts
        level = np.floor(np.log2(np.maximum(wanted, 1e-9)))
        level = np.minimum(level, np.log2(max(MOST_STARTS // starts, 1))).astype(int)
        for each in range(1, int(level.max()) + 1):
            chosen = np.flatnonzero(level == each)
            for done in self._lit(lamps, starts * 2**each, chosen, rng, result, spread):
                yield 0.5 + 0.5 * (each - 1 + done) / int(level.max())
        for lamp in lamps:
            if lamp.but is not None:
                self._add_beams(lamp, lamp.but, result)
        return result

    def _found_from(self, lamps, rays) -> tuple[list[Direct], NDArray, NDArray]:
        """Return lamps without thin beams, and sides (k,) that so many rays from them meet, and
        what light (k,) each ray brings: a beam may be a small part of each side that it falls on,
        but is of the lamp's light as any other."""
        rng = np.random.default_rng(3)
        each = max(rays, LEAST_RAYS // 2) // len(lamps)
        areas = np.maximum(self._areas, 1e-30)
        others, sides, light = [], [], []
        for lamp in lamps:
            if lamp.place is None:
                columns = Columns.over(lamp.direction, self.space.cells, int(np.sqrt(each)))
                starts, ways, flux = columns.rays(1, rng)
                met = self._met(starts, ways)
                facing = self.side * (self._normals @ np.asarray(lamp.direction))
                thin = columns.thin(met, areas * facing / flux, self._met, rng)
                lamp = replace(lamp, but=thin) if thin.within.any() else lamp
            else:
                starts, ways, flux = sent(lamp, each, rng)
                met = self._met(starts, ways)
            met = met[met >= 0]
            others.append(lamp)
            sides.append(met)
            light.append(lamp.spectrum.mean() * flux / areas[met])
        return others, np.concatenate(sides), np.concatenate(light)

    def _add_beams(self, lamp, columns, result) -> None:
        """Add what a lamp sends in columns to the sides (r, 16) that its rays end in."""
        starts, ways, flux = columns.rays(columns.each, np.random.default_rng(5))
        rows, odd, passed = self.space.trace(starts, ways)
        sides = self._side_of[rows]
        through = np.ones((len(rows), 1), np.float32)
        if len(odd):
            through = np.repeat(through, result.shape[1], axis=1)
            through[odd] = np.array(self.space.filters)[passed]
        found = np.flatnonzero(sides >= 0)
        sides = sides[found]
        share = flux / np.maximum(self._areas * self.counts.mean(axis=1), 1e-30)[sides]
        light = share[:, None] * through[found]
        for band in range(result.shape[1]):
            column = light[:, min(band, light.shape[1] - 1)]
            result[:, band] += lamp.spectrum[band] * np.bincount(sides, column, len(result))

    @property
    def _areas(self) -> NDArray[np.float64]:
        """Of sides, (r,)."""
        cells = self.space.cells
        return np.bincount(cells.patch, cells.areas, cells.patches)[self.patch]

    @property
    def _normals(self) -> NDArray[np.float32]:
        """Of the patches of sides, (r, 3)."""
        return self.space.cells.normals[self.space.cells.first[self.patch]]

    def _met(self, starts, ways) -> NDArray[np.int64]:
        """Which sides rays (n, 3), (n, 3) end in, -1 for none."""
        return self._side_of[self.space.trace(starts, ways)[0]]

    def _lit(self, lamps, starts, sides, rng, result, spread) -> Iterator[float]:
        """Find the light (r, 16) of lamps on some sides (k,), and by how much single places differ
        (r,), from places that are others on every side: else all would miss what falls between."""
        shares = even(starts)
        step = max(1, self.space.chunk // starts)
        for first in range(0, len(sides), step):
            part = sides[first : first + step]
            moved = ((shares + rng.random((len(part), 1, 3))) % 1.0).astype(np.float32)
            places, normals, at = self._starts(part, moved)
            weight = np.ones(places.shape[:2], np.float32)
            covered = np.flatnonzero(~self.counts[part].all(axis=1))
            if len(covered):
                reach = COVER * np.sqrt(self.space.cells.areas[at[covered]])
                hidden = np.logical_or(*self.space.hidden(places[covered], normals[covered], reach))
                weight[covered] = ~hidden | hidden.all(axis=1)[:, None]
            light, levels = np.zeros((len(part), result.shape[1]), np.float32), 0.0
            mean = np.full(result.shape[1], 1.0 / result.shape[1], np.float32)
            for lamp in lamps:
                lit = shine(self.space, lamp, places.reshape(-1, 3), normals.reshape(-1, 3), rng)
                lit = lit.reshape(*places.shape[:2], -1)
                light += (weight[:, None] @ lit)[:, 0]
                levels = levels + lit @ mean
            result[part] = light / weight.sum(axis=1, keepdims=True)
            spread[part] = np.std(levels, axis=1, where=weight > 0.0)
            yield min(1.0, (first + step) / len(sides))

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
        space.strip(seen)
        # Few rays may miss a small lamp: who sees what has met it is in no other room than that.
        sees_lit = gather(self.hits, seen)[:, 0] > 0.0
        unlit = ~lit & (self.side < 0) | (bright <= 0.0) & ~sees_lit
        unlit &= self.enclosed
        if unlit.any() and not unlit.all():
            tells[self.row[unlit]] = 0.0
            space.strip(tells)
            table, more = self._spread(sky, direct, tells, self.E)  # little has changed
            sweeps += more
        return table, tells, sweeps

    def _spread(self, sky, direct, tells, near=None):
        space = self.space
        filters = np.array(space.filters) if space.filters else None
        table = np.zeros((space.rows, sky.shape[1]), np.float32)
        # Rays through panes have the row `dark`, which tells.
        told = gather(self.hits, np.repeat(tells[:, None], 4, axis=1))[:, :1]
        share = 1.0 / np.maximum(told, 1e-3)
        rho = self.rho * tells[self.row, None]

        def arriving():
            return share * gather(self.hits, table, filters)

        table[space.sky : space.lost] = sky
        table[self.row] = self.emission
        first = direct + arriving() + self.sought.light(space, table, len(direct))
        E = first if near is None else near
        table[space.sky : space.lost] = 0.0
        areas = self._areas
        sweep = 0
        while sweep < MOST:
            sweep += 1
            table[self.row] = rho * E
            space.strip(table)
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
        space.strip(table)
        table[self.row] += self.emission
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
