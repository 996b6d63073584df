"""Light at places of a space after it has gone round: what a meter there reads, in bands and sky.

Unlike what is baked it is not turned into a color: the spectrum stays.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from . import directions
from .bands import COUNT
from .hits import Space, gather
from .lamps import Direct, shine
from .next_event import rays_beside, seek

SPOT = 0.5
"""[degrees] from the axis of a luminance meter to the edge of what it sees."""

SIDE = 8
"""A flat lamp is as many parts along either side, with a shadow ray each."""


@dataclass
class Light:
    """What came to n places: ``bands`` (n, 16) from surfaces, lamps and through panes, ``channels``
    (n, k) straight from the sky, each a mean over the cosine: irradiance / π; or a spot's radiance.

    ``told`` (n,): which part of the rays tells anything: little within something solid.
    """

    bands: NDArray[np.float64]
    channels: NDArray[np.float64]
    told: NDArray[np.float64]


@dataclass(frozen=True)
class Field:
    """Light that has gone round in a space: see `radiosity.Radiosity.solve`.

    ``channels`` (SKY, k): the sky's cells in other numbers than bands; ``lamps``: what shines on
    places by itself.
    """

    space: Space
    table: NDArray[np.float32]
    tells: NDArray[np.float32]
    channels: NDArray[np.float32]
    lamps: Sequence[Direct] = ()

    def on_faces(self, places: NDArray, normals: NDArray, rays: int) -> Iterator[Light]:
        """Yield the light that falls on faces at places (n, 3) of normals (n, 3), part by part.

        So many rays from each; open sky is without their error, as in `collected.Collected`.
        """
        pattern = directions.pattern(rays)
        for part, found in self._gathered(places, normals, pattern, sought=True):
            starts, across = self._starts(places, normals, part)
            found.channels *= self._more(across, pattern)
            found.bands += self._direct(starts, across)
            emitted = seek(self.space, starts, across, rays_beside(rays))
            found.bands += emitted.light(self.space, self.table, len(starts))
            yield found

    def direct(self, places: NDArray, normals: NDArray) -> NDArray[np.float64]:
        """Return irradiance / π (n, 16) that lamps send straight to faces at places (n, 3) of
        normals (n, 3), in shadow or not."""
        return self._direct(*self._starts(places, normals, slice(None)))

    def in_spots(self, places: NDArray, ways: NDArray) -> Iterator[Light]:
        """Yield the radiance of what is seen at places (n, 3) along ways (n, 3), within `SPOT`."""
        for _, found in self._gathered(places, ways, _cone(SPOT)):
            yield found

    def _starts(self, places, normals, part) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        across = normals[part].astype(np.float32)
        return (places[part] + self.space.lift(places[part]) * across).astype(np.float32), across

    def _gathered(
        self, places, normals, pattern, sought: bool = False
    ) -> Iterator[tuple[slice, Light]]:
        space, rays = self.space, len(pattern)
        wide = np.zeros((space.rows, COUNT + 1 + self.channels.shape[1]), np.float32)
        wide[: space.sky, :COUNT] = self.table[: space.sky]
        wide[:, COUNT] = self.tells
        wide[space.sky : space.lost, COUNT + 1 :] = self.channels
        starts, across = self._starts(places, normals, slice(None))
        for part, hits in space.look(starts, across, pattern, sought):
            sums = gather(hits, wide).astype(float)
            if len(hits.odd):
                light = self.table[hits.odd_rows] * np.array(space.filters)[hits.odd_filter]
                point = hits.odd // rays
                for k in range(COUNT):
                    sums[:, k] += np.bincount(point, light[:, k], len(sums)) / rays
            told = sums[:, COUNT]
            sums /= np.maximum(told, 1.0 / rays)[:, None]
            yield part, Light(sums[:, :COUNT], sums[:, COUNT + 1 :], told)

    def _more(self, normals, pattern) -> NDArray[np.float64]:
        """By what the sky's light on open faces is more than a pattern's rays tell, (n, k)."""
        _, first, each = np.unique(
            np.round(normals * 1000.0), axis=0, return_index=True, return_inverse=True
        )
        whole = directions.open_light(self.channels, normals[first])
        more = np.empty_like(whole)
        for k in range(len(whole)):  # one by one, for a meter casts many rays
            one = slice(k, k + 1)
            more[one] = directions.ratios(self.channels, whole[one], normals[first][one], pattern)
        return more[each.reshape(-1)]

    def _direct(self, starts, normals) -> NDArray[np.float64]:
        """Irradiance / π (n, 16) of lamps, in shadow or not."""
        rng = np.random.default_rng(4)
        total = np.zeros((len(starts), COUNT))
        for lamp in self.lamps:
            for one in _parts(lamp):
                total += shine(self.space, one, starts, normals, rng)
        return total


def _parts(lamp: Direct) -> list[Direct]:
    """A flat lamp as many, each by a shadow ray to a place of its own."""
    if lamp.area is None or lamp.place is None:
        return [lamp]
    share = (np.arange(SIDE) + 0.5) / SIDE * 2.0 - 1.0
    spectrum, area = lamp.spectrum / np.float32(SIDE**2), lamp.area / SIDE
    return [
        replace(lamp, place=lamp.place + np.array([u, v]) @ lamp.area, area=area, spectrum=spectrum)
        for u in share
        for v in share
    ]


@lru_cache(maxsize=1)
def _cone(degrees: float, rays: int = 256) -> NDArray[np.float32]:
    """Directions (rays, 3) about z, evenly within so many degrees."""
    disc = directions.pattern(rays)[:, :2] * np.float32(np.sin(np.radians(degrees)))
    return np.column_stack([disc, np.sqrt(1.0 - (disc**2).sum(axis=1))]).astype(np.float32)
