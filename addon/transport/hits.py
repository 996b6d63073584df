"""What rays meet: for each the row of a table that holds the light which comes along it.

The table's rows are the fronts of all patches, their backs, those of emitters that are sought by
rays to them (`Space.strip`), the cells of the sphere beyond, and two more: `Space.lost`, for rays
that start inside something solid, which tell nothing; `Space.dark`. So light that changes changes
the table, and no ray is cast anew.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import directions
from .cells import ANGLES, Cells, Matter
from .emitters import Emitters
from .rays import Caster

CHUNK = 2**18, 2**14
"""Rays at once, with and without `embreex`: some 30 MB, and less than a tenth of a second."""

THROUGH = 6
"""Panes and holes that a ray may pass; then it is dark."""

ALONG = 0.9
"""Cosine between the normals of two faces from which on one lies along the other."""


@dataclass
class Hits:
    """For each of n points the table's rows (n, rays) that its rays meet."""

    rows: NDArray[np.int32]
    odd: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    """(k,), numbers (point * rays + ray) of those that came through panes; `rows` has them dark."""
    odd_rows: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    odd_filter: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    """(k,), which of `Space.filters` each came through."""

    def part(self, points: slice) -> Hits:
        """Those of some points that follow one another."""
        rays = self.rows.shape[1]
        ends = [points.start * rays, points.stop * rays]
        first, last = np.searchsorted(self.odd, ends).tolist()
        return Hits(
            self.rows[points],
            self.odd[first:last] - points.start * rays,
            self.odd_rows[first:last],
            self.odd_filter[first:last],
        )


class Space:
    """Cells, and what rays between them meet."""

    def __init__(self, cells: Cells, matter: Matter, slow: bool = False) -> None:
        self.cells, self.matter = cells, matter
        self.caster = Caster(cells.corners, slow)
        self.caster.build()
        self.emitters = Emitters(cells, matter)
        n = cells.patches
        self.bare = 2 * n
        """The first of the rows of emitters' fronts without what they send of their own; of their
        backs as many follow."""
        self.sky = self.bare + 2 * len(self.emitters.patches)
        self.lost = self.sky + directions.SKY
        self.dark = self.lost + 1
        self.rows = self.dark + 1
        self.filters: list[NDArray[np.float32]] = []
        self._combined: dict[tuple[int, int], int] = {}
        self._porous = matter.clear | (matter.opacity < 1.0)
        self._any = bool(self._porous.any())
        self._noise = np.random.default_rng(0)
        self.chunk = CHUNK[0 if self.caster.embree else 1]
        """Rays at once."""
        middles = np.abs(cells.corners.mean(axis=1)).max(axis=1)
        self._near = min(cells.size, 16.0 * float(np.median(middles))) if len(cells) else 0.0

    def lift(self, places: NDArray) -> NDArray[np.float32]:
        """Return how far over faces rays start (..., 1) at places (..., 3): more than float32 is
        off there, which is finest about the origin."""
        reach = np.maximum(2.0 * np.abs(places).max(axis=-1, keepdims=True), self._near)
        return np.maximum(2e-6 * reach, 1e-7).astype(np.float32)

    def strip(self, table: NDArray) -> None:
        """Give emitters that are sought, in a table (rows, …) of what all sides send on, the same
        in the rows that nothing is added to which they send of their own."""
        patches = self.emitters.patches
        if len(patches):
            table[self.bare : self.sky] = table[np.concatenate([patches, patches + self.bare // 2])]

    def own(self, table: NDArray) -> NDArray:
        """Return what each of the emitters' kinds sends of its own, (kinds, k), by a table (rows,
        k)."""
        one = self.emitters.examples
        return table[one] - table[self.bare + self.emitters.slot[one]]

    def look(
        self, starts: NDArray, normals: NDArray, pattern: NDArray, sought: bool = False
    ) -> Iterator[tuple[slice, Hits]]:
        """Yield what points (n, 3) meet along a pattern about their normals (n, 3), some thousand
        of them at a time; ``sought`` as in `met`."""
        rays = len(pattern)
        step = max(1, self.chunk // rays)
        for first in range(0, len(normals), step):
            part = slice(first, min(first + step, len(normals)))
            ways = directions.about(normals[part], pattern)
            origins = np.repeat(starts[part].astype(np.float32), rays, axis=0)
            yield part, self.met(origins, ways, sought)

    def met(
        self, origins: NDArray[np.float32], ways: NDArray[np.float32], sought: bool = False
    ) -> Hits:
        """Return what rays (n, rays, 3) meet; ``origins`` as many.

        ``sought``: light of emitters that are far comes along other rays, by `next_event.seek`.
        """
        rows, odd, odd_filter = self.trace(
            origins.reshape(-1, 3), ways.reshape(-1, 3), mirrors=True, sought=sought
        )
        odd_rows = rows[odd]
        rows[odd] = self.dark
        rows = rows.reshape(ways.shape[:2])
        return Hits(rows, odd, odd_rows, odd_filter)

    def hidden(
        self, starts: NDArray[np.float32], normals: NDArray[np.float32], reach: NDArray
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return whether places (..., 3) on faces of these normals are under what lies along them
        nearer than ``reach`` (...), and whether they are inside something solid."""
        origins, ways = starts.reshape(-1, 3), normals.reshape(-1, 3)
        met = self.caster.first_hits(origins, ways)
        found = np.flatnonzero(met >= 0)
        hit = met[found]
        slope, far = self.cells.along(hit, origins[found], ways[found])
        near = far < np.ravel(reach)[found]
        under, inside = np.zeros((2, len(met)), bool)
        under[found] = near & (np.abs(slope) > ALONG) & ~self._porous[self.cells.kind[hit]]
        inside[found] = self.cells.solid[hit] & (slope > 0.0)
        return under.reshape(starts.shape[:-1]), inside.reshape(starts.shape[:-1])

    def hiding(
        self, starts: NDArray[np.float32], normals: NDArray[np.float32], reach: NDArray
    ) -> Generator[float, None, tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
        """Do as `hidden` does of places (n, 3), yielding 0 to 1."""
        under, inside = np.zeros((2, len(starts)), bool)
        for part in self._parts(len(starts)):
            under[part], inside[part] = self.hidden(starts[part], normals[part], reach[part])
            yield part.stop / len(starts)
        return under, inside

    def open_between(
        self, starts: NDArray, ends: NDArray
    ) -> Generator[float, None, NDArray[np.bool_]]:
        """Return whether nothing but panes lies between places (n, 3) and others (n, 3), yielding 0
        to 1."""
        result = np.zeros(len(starts), bool)
        for part in self._parts(len(starts)):
            result[part] = self._open_between(starts[part], ends[part])
            yield part.stop / len(starts)
        return result

    def _parts(self, count: int) -> Iterator[slice]:
        return (slice(k, min(k + self.chunk, count)) for k in range(0, count, self.chunk))

    def _open_between(self, starts: NDArray, ends: NDArray) -> NDArray[np.bool_]:
        ways = (ends - starts).astype(np.float32)
        far = np.linalg.norm(ways, axis=1)
        ways /= np.maximum(far, 1e-30)[:, None]
        rows, _, _ = self.trace(starts.astype(np.float32), ways, far)
        return (rows >= self.sky) & (rows < self.lost) | (far == 0.0)

    def trace(
        self,
        origins: NDArray[np.float32],
        ways: NDArray[np.float32],
        reach: NDArray | None = None,
        mirrors: bool = False,
        sought: bool = False,
    ) -> tuple[NDArray[np.int32], NDArray[np.int64], NDArray[np.int32]]:
        """Return the rows that rays (n, 3), (n, 3) end in, the numbers of those that have met
        panes, and which of `filters` they have passed.

        What lies farther than ``reach`` (n,) is not met. ``mirrors``: panes send back as many rays
        as they mirror light, by chance; else all go on, and that much fainter. ``sought`` as in
        `met`: what is seen in a mirror is not.
        """
        cells, count = self.cells, self.cells.patches
        met = self.caster.first_hits(origins, ways)
        met = self._within(met, origins, ways, reach, slice(None))
        rows = met.copy()
        passed = np.zeros(len(rows), np.int32) if self._any else None
        turned = np.zeros(len(rows), bool)
        if passed is not None and count:
            going = np.flatnonzero((met >= 0) & self._porous[cells.kind[met]])
            at = origins
            for _ in range(THROUGH):
                opacity = self.matter.opacity[cells.kind[met[going]]]
                clear = self.matter.clear[cells.kind[met[going]]]
                goes = clear | (self._noise.random(len(going), np.float32) >= opacity)
                going = going[goes]
                if not len(going):
                    break
                at = at.copy() if at is origins else at
                hit, way = met[going], ways[going]
                normal = cells.normals[hit]
                slope = np.einsum("nk,nk->n", way, normal)
                back = self._filter(passed, going, cells.kind[hit], np.abs(slope), mirrors)
                to = np.einsum("nk,nk->n", cells.corners[hit, 0] - at[going], normal)
                far = to / np.where(np.abs(slope) < 1e-6, 1e-6, slope)
                over = np.where(back, -4, 4)[:, None] * self.lift(at[going])
                at[going] += (far[:, None] + over) * way
                if back.any():
                    turned[going[back]] = True
                    ways = ways.copy()
                    way = way - (2.0 * back * slope)[:, None].astype(np.float32) * normal
                    ways[going] = way
                met[going] = self.caster.first_hits(at[going], way)
                rows[going] = met[going] = self._within(met[going], origins, ways, reach, going)
                hit = met[going]
                going = going[(hit >= 0) & self._porous[cells.kind[hit]]]
            else:
                rows[going] = -2
        inside = np.flatnonzero(rows >= 0)
        hit = rows[inside]
        behind = np.einsum("nk,nk->n", ways[inside], cells.normals[hit]) > 0.0
        beyond = np.flatnonzero(rows < 0)
        dark = rows[beyond] == -2
        patch = cells.patch[hit]
        rows[inside] = np.where(behind, np.where(cells.solid[hit], self.lost, patch + count), patch)
        if sought and len(self.emitters):
            self._leave_out(rows, inside[~turned[inside]], hit[~turned[inside]], origins, ways)
        rows[beyond] = self.sky + directions.cells(ways[beyond])
        rows[beyond[dark]] = self.dark
        if passed is None:
            return rows, np.empty(0, np.int64), np.empty(0, np.int32)
        odd = np.flatnonzero(passed)
        return rows, odd, passed[odd] - 1

    def _leave_out(self, rows, rays, hit, origins, ways) -> None:
        """Let those of rays (k,) that have met cells (k,) of emitters which are sought from where
        they start end in rows without those's own light."""
        near = self.emitters.reach[hit]
        some = np.flatnonzero(near < np.inf)
        rays, hit = rays[some], hit[some]
        _, far = self.cells.along(hit, origins[rays], ways[rays])
        some = (far > near[some]) & (rows[rays] < self.bare)
        rays, slot = rays[some], self.emitters.slot[self.cells.patch[hit[some]]]
        behind = rows[rays] >= self.cells.patches
        rows[rays] = self.bare + slot + behind * len(self.emitters.patches)

    def nearest(self, origins: NDArray, ways: NDArray, reach: NDArray) -> NDArray[np.int32]:
        """Return the cell (n,) that each ray meets within its reach, -1 for none and for panes and
        what has holes."""
        met = self.caster.first_hits(origins.astype(np.float32), ways.astype(np.float32))
        met = self._within(met, origins, ways, reach, slice(None))
        return np.where((met >= 0) & ~self._porous[self.cells.kind[met]], met, -1).astype(np.int32)

    def _within(self, met, origins, ways, reach, rays):
        """What some rays have met, -1 where that lies farther than their reach."""
        if reach is None or not len(self.cells.corners):
            return met
        _, far = self.cells.along(met, origins[rays], ways[rays])
        return np.where((met >= 0) & (far < reach[rays]), met, -1).astype(np.int32)

    def _filter(self, passed, rays, kinds, cosines, mirrors) -> NDArray[np.bool_]:
        """Note what rays have met goes through or, where ``mirrors``, sends back; return which it
        does. ``passed`` (n,) is 0 for no pane, or one more than a number of `filters`."""
        step = np.minimum((cosines * ANGLES).astype(np.int64), ANGLES - 1)
        back = np.zeros(len(rays), bool)
        if mirrors:
            share = self.matter.mirrored[kinds, step] * self.matter.clear[kinds]
            back = self._noise.random(len(rays), np.float32) < share
        glass = self.matter.clear[kinds]
        pane = (kinds * ANGLES + step) * 3 + np.where(back, 2, int(mirrors))
        pair = (passed[rays].astype(np.int64) << 32 | pane)[glass]
        for key in np.unique(pair):
            before, which = int(key) >> 32, int(key) & 0xFFFFFFFF
            if (before, which) not in self._combined:
                (kind, angle), how = divmod(which // 3, ANGLES), which % 3
                values = self.matter.transmittance[kind, angle]
                if how == 1:  # of those that are not sent back
                    values = values / (1.0 - self.matter.mirrored[kind, angle])
                values = np.ones_like(values) if how == 2 else values
                if before:
                    values = values * self.filters[before - 1]
                self.filters.append(values)
                self._combined[before, which] = len(self.filters)
            passed[rays[glass][pair == key]] = self._combined[before, which]
        return back


def gather(hits: Hits, table: NDArray[np.float32], filters: NDArray | None = None) -> NDArray:
    """Return the mean (n, k) over each point's rays of what the table's rows (rows, k) hold.

    ``filters`` (f, k): what those of `Space.filters` leave of light through panes; None: that is
    left out.
    """
    count, rays = hits.rows.shape
    result = np.empty((count, table.shape[1]), np.float32)
    step = max(1, 2**14 // rays)
    flat = hits.rows.reshape(-1)
    for first in range(0, count, step):
        found = table.take(flat[first * rays : (first + step) * rays], axis=0)
        np.einsum(
            "nrk->nk", found.reshape(-1, rays, table.shape[1]), out=result[first : first + step]
        )
    if len(hits.odd) and filters is not None:
        light = table.take(hits.odd_rows, axis=0) * filters.take(hits.odd_filter, axis=0)
        point = hits.odd // rays
        for k in range(table.shape[1]):
            result[:, k] += np.bincount(point, light[:, k], count)
    return result / np.float32(rays)


class Growing:
    """Hits of n points that come one part after another, without a second copy of all."""

    def __init__(self, points: int, rays: int) -> None:
        self._rows = np.empty((points, rays), np.int32)
        self._odd: list[Hits] = []
        self._known = 0

    def add(self, part: Hits) -> None:
        """Take the hits of the next points."""
        count, rays = part.rows.shape
        self._rows[self._known : self._known + count] = part.rows
        if len(part.odd):
            odd = part.odd + self._known * rays
            self._odd.append(Hits(part.rows[:0], odd, part.odd_rows, part.odd_filter))
        self._known += count

    @property
    def hits(self) -> Hits:
        """All of them."""
        if not self._odd:
            return Hits(self._rows)
        names = ("odd", "odd_rows", "odd_filter")
        return Hits(
            self._rows, *(np.concatenate([getattr(p, name) for p in self._odd]) for name in names)
        )
