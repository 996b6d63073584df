"""What rays from receivers bring: light from surfaces and sky, made into colours of materials.

A pass of rays takes the place of those before: one pattern of all its rays errs half as much as two
that add up to as many. Hits are kept for another light as long as they are few enough.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside
from ...transport import directions
from ...transport.bands import COUNT
from ...transport.hits import Growing, Hits, Space, gather
from ...transport.next_event import Sought, rays_beside, seek
from .light import Light
from .receivers import Receivers

BLOCK = 2**24
"""Rays of which hits are held together: 64 MB."""

KEPT = 90_000_000
"""Rays whose hits are kept for another light: 360 MB; of more none, and they are cast anew."""

NARROW, WIDE = 8, 24
"""Columns that rays are summed up in: 3 colours or 16 bands from surfaces, what part tells
anything, and the sky's 4 channels."""

PART = 2**18
"""Points of which colours are made at once."""


@dataclass
class Shading:
    """What makes colours of light: what comes along rays, and what each material makes of that."""

    table: NDArray[np.float32]
    """(rows, 16), radiance."""
    tells: NDArray[np.float32]
    """(rows,), 1 where that is worth anything."""
    channels: NDArray[np.float32]
    """(SKY, 4), what the sky's cells have of each channel."""
    mixes: NDArray[np.float32]
    """(m, 3, 4), the colours that materials have in each channel."""
    matrices: NDArray[np.float32]
    """(m, 3, 16), the same in bands."""

    @classmethod
    def of(cls, light: Light, names: Sequence[str], table: NDArray, tells: NDArray) -> Shading:
        """By the materials of these full names."""
        own = light.channels
        # Spare channels have no colour, but tell what another sky would: one brighter to a side.
        ways, _ = directions.centres()
        channels = ((1.0 + ways[:, [0, 1, 0, 1]] * [1, 1, -1, -1]) * (ways[:, 2:] > 0.0)).astype(
            "f"
        )
        channels[:, : own.shape[1]] = own
        mixes = np.zeros((len(names), 3, 4), np.float32)
        mixes[:, :, : own.shape[1]] = [light.mix(name) for name in names]
        matrices = np.array([light.matrix(name) for name in names], np.float32)
        return cls(table, tells, channels, mixes, matrices)

    def columns(self, space: Space, kind: int | None) -> NDArray[np.float32]:
        """What each row brings, (rows, `NARROW`) to one material, (rows, `WIDE`) to any."""
        bands = 3 if kind is not None else COUNT
        result = np.zeros((space.rows, NARROW if kind is not None else WIDE), np.float32)
        surfaces = self.table[: space.sky]
        result[: space.sky, :bands] = surfaces if kind is None else surfaces @ self.matrices[kind].T
        result[:, bands] = self.tells
        result[space.sky : space.lost, bands + 1 : bands + 5] = self.channels
        return result


@dataclass
class _Block:
    """Hits of some points (k,), ascending, by which pattern, from 1 on."""

    points: NDArray[np.int32]
    hits: Hits
    sought: Sought
    pattern: int


class Collected:
    """The light that receivers have collected so far."""

    def __init__(self, receivers: Receivers, space: Space) -> None:
        self.receivers, self.space = receivers, space
        self.kept: list[_Block] | None = []
        """All hits; None where they are too many."""
        self.patterns: list[NDArray[np.float32]] = []
        self.depth = np.zeros(len(receivers), np.int8)
        """(n,), which of the patterns each has cast last, from 1 on."""
        self._sums = np.zeros((len(receivers), NARROW), np.float32)
        # Normals that differ by less than a degree have the same sky.
        rounded = np.round(receivers.normals * 100.0).astype(np.int32) + 128
        keys = (rounded[:, 0] << 16) | (rounded[:, 1] << 8) | rounded[:, 2]
        _, first, self._normal = np.unique(keys, return_index=True, return_inverse=True)
        self._normals = receivers.normals[first]
        self._shading: Shading | None = None
        self._open: NDArray[np.float32] = np.empty(0, np.float32)
        """(normals, 4), the light of that shading's sky on open faces; NaN where not needed yet."""
        self._ratios: list[NDArray[np.float32]] = []
        """By pattern, (normals, 4), by what that is more than the pattern's rays tell."""

    def cast(
        self, pattern: NDArray[np.float32], points: NDArray[np.int32], shading: Shading
    ) -> Iterator[float]:
        """Cast a pattern of rays from some points (k,), ascending, yielding 0 to 1.

        Whoever ends it before its end leaves some points with this pattern's light, others without.
        """
        receivers = self.receivers
        self.patterns.append(pattern)
        step = max(1, BLOCK // len(pattern))
        for first in range(0, len(points), step):
            chosen = points[first : first + step]
            found, sought = Growing(len(chosen), len(pattern)), [Sought.none()]
            places, normals = receivers.places[chosen], receivers.normals[chosen]
            beside = rays_beside(len(pattern))
            for part, hits in self.space.look(places, normals, pattern, sought=True):
                found.add(hits)
                emitted = seek(self.space, places[part], normals[part], beside)
                sought.append(emitted.after(part.start))
                yield (first + part.stop) / len(points)
            self.depth[chosen] = len(self.patterns)
            at = Progress((first + len(chosen)) / len(points), "")
            block = _Block(chosen, found.hits, Sought.joined(sought), len(self.patterns))
            yield from (each.done for each in aside(at, self._keep, block, shading))
        for _ in self._compare(shading):
            yield 1.0

    def relight(self, shading: Shading) -> None:
        """Let what has been hit bring another light; only where hits are kept."""
        for block in self.kept or ():
            self._add(block, shading)

    def colours(self, shading: Shading) -> NDArray[np.float32]:
        """Return the colour (n, 3) that light makes of each receiver."""
        for _ in self._compare(shading):
            pass
        ratios = np.stack(self._ratios)
        result = np.empty((len(self._sums), 3), np.float32)
        for first in range(0, len(result), PART):
            part = slice(first, first + PART)
            sums, kind = self._sums[part], self.receivers.kind[part]
            seen = ratios[self.depth[part], self._normal[part]] * sums[:, 4:]
            light = sums[:, :3] + np.einsum("ncs,ns->nc", shading.mixes[kind], seen)
            result[part] = light / np.maximum(sums[:, 3:4], 1.0)
        return result

    @property
    def told(self) -> NDArray[np.float32]:
        """What part (n,) of each receiver's rays tells anything, 0 where something covers it."""
        return np.where(self.receivers.hidden, 0.0, self._sums[:, 3] / self._rays)

    @property
    def seen(self) -> NDArray[np.float32]:
        """What each receiver has seen of the sky's channels, (n, 4)."""
        return self._sums[:, 4:] / self._rays[:, None]

    @property
    def _rays(self) -> NDArray[np.float32]:
        return np.array([1, *map(len, self.patterns)], np.float32)[self.depth]

    def _keep(self, block: _Block, shading: Shading) -> None:
        if self.kept is not None:
            old = [each for each in self.kept if (self.depth[each.points] == each.pattern).any()]
            self.kept = [*old, block]
            if sum(each.hits.rows.size for each in self.kept) > KEPT:
                self.kept = None
        self._add(block, shading)

    def _add(self, block: _Block, shading: Shading) -> None:
        """Add what a block's rays bring, material by material; many small ones together."""
        kinds = self.receivers.kind[block.points]
        rays = block.hits.rows.shape[1]
        edges = np.flatnonzero(np.diff(kinds, prepend=-1, append=-1)).tolist()
        first = 0
        for start, end in pairwise(edges):
            # Columns for one material cost a look at all rows.
            if (end - start) * rays > 2 * self.space.rows:
                self._sum_up(block, slice(first, start), None, shading)
                self._sum_up(block, slice(start, end), int(kinds[start]), shading)
                first = end
        self._sum_up(block, slice(first, len(kinds)), None, shading)

    def _sum_up(self, block: _Block, part: slice, kind: int | None, shading: Shading) -> None:
        if part.start == part.stop:
            return
        some = block.hits.part(part)
        points, kinds = block.points[part], self.receivers.kind[block.points[part]]
        sums = gather(some, shading.columns(self.space, kind)) * np.float32(some.rows.shape[1])
        if kind is None:
            told = sums[:, COUNT:]
            sums = np.concatenate([_coloured(sums[:, :COUNT], kinds, shading), told], axis=1)
        if len(some.odd):
            light = shading.table.take(some.odd_rows, axis=0)
            light *= np.array(self.space.filters).take(some.odd_filter, axis=0)
            point = some.odd // some.rows.shape[1]
            colour = _coloured(light, kinds[point], shading)
            for k in range(3):
                sums[:, k] += np.bincount(point, colour[:, k], len(points))
        emitted = block.sought.of(part)
        if len(emitted.place):
            light = emitted.light(self.space, shading.table, len(points))
            # Unlike what rays all about have met it is not shared among those that tell.
            sums[:, :3] += _coloured(light, kinds, shading) * sums[:, 3:4]
        now = self.depth[points] == block.pattern
        self._sums[points[now]] = sums[now, :NARROW]

    def _compare(self, shading: Shading) -> Iterator[None]:
        """Find by what a sky's light on open faces is more than a pattern's rays tell.

        So what nothing hides is without error, and what hides half takes half of the true light.
        Yields after each part of the normals that need it.
        """
        unknown = np.full((len(self._normals), 4), np.nan, np.float32)
        if self._shading is not shading:
            self._shading, self._open = shading, unknown.copy()
            self._ratios = [np.ones_like(unknown)]
        self._ratios += [unknown.copy() for _ in self.patterns[len(self._ratios) - 1 :]]
        for depth, pattern in enumerate(self.patterns, 1):
            ratios = self._ratios[depth]
            needed = np.zeros(len(ratios), bool)
            needed[self._normal[self.depth == depth]] = True
            new = np.flatnonzero(needed & np.isnan(ratios[:, 0]))
            step = max(1, min(1024, 2**18 // len(pattern)))
            for k in range(0, len(new), step):
                some = new[k : k + step]
                dark = some[np.isnan(self._open[some, 0])]
                self._open[dark] = directions.open_light(shading.channels, self._normals[dark])
                ratios[some] = directions.ratios(
                    shading.channels, self._open[some], self._normals[some], pattern
                )
                yield


def _coloured(light: NDArray, kinds: NDArray, shading: Shading) -> NDArray[np.float32]:
    """Return the colours (n, 3) that materials (n,), ascending, make of bands (n, 16)."""
    result = np.empty((len(light), 3), np.float32)
    edges = np.flatnonzero(np.diff(kinds, prepend=-1, append=-1)).tolist()
    for start, end in pairwise(edges):
        result[start:end] = light[start:end] @ shading.matrices[kinds[start]].T
    return result
