"""The light on some places that stand for a picture: what less of it, or fewer rays, would be off.

They cast every pattern of rays that the points of a bake could, before any of those casts one.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..spectra.cielab import XYZ_to_Lab, delta_E_2000
from . import directions
from .hits import Space, gather
from .lamps import Direct, shine
from .next_event import rays_beside, seek

PLACES = 1024
"""Places that stand for a picture: what it is off by differs from one to the next by about as much
as its mean, which so many know to a few percent."""

RAYS = 64, 256
"""From each; the last of them is taken for true."""

FINEST, EACH = 1024, 4
"""Rays by which that is judged in turn, and light between fewer patches: from one place in four."""

TOLD = 0.5
"""A place of whose rays fewer tell anything lies in something solid."""


@dataclass(frozen=True)
class Probed:
    """Places (k,) by what a picture shows: their ``normals`` (k, 3), reflectance ``rho`` (k, 16),
    and light as irradiance / pi (k, 16): ``direct`` of lamps, ``first`` that has not bounced, and
    all of it by how many ``rays`` were cast. Of every fourth (k / 4, 16) ``finest`` is that of most
    rays, and ``rough`` is as it would be between fewer patches."""

    normals: NDArray[np.float32]
    rho: NDArray[np.float64]
    direct: NDArray[np.float64]
    first: NDArray[np.float64]
    rays: dict[int, NDArray[np.float64]]
    finest: NDArray[np.float64]
    rough: NDArray[np.float64]
    to_XYZ: NDArray[np.float64]

    def error(self, light: NDArray[np.float64], true: NDArray[np.float64]) -> float:
        """Return the mean CIEDE2000 of a light that another is the true one of, (k, 16) or on every
        fourth place; white is the perfect diffuser in all the light of the place."""
        rho = self.rho if len(light) == len(self.rho) else self.rho[::EACH]
        white = true @ self.to_XYZ.T
        one, other = (XYZ_to_Lab((rho * each) @ self.to_XYZ.T, white) for each in (light, true))
        return float(delta_E_2000(one, other).mean())

    def without_bounces(self) -> float:
        """Return the mean CIEDE2000 where no surface sends light on."""
        return self.error(self.first, self.rays[RAYS[-1]])

    def under(self, open_sky: NDArray[np.float32]) -> float:
        """Return the mean CIEDE2000 where nothing hides a sky (SKY, 16), and lamps cast shadows."""
        return self.error(_open_light(open_sky, self.normals) + self.direct, self.rays[RAYS[-1]])

    def of_fewer_patches(self) -> float:
        """Return the mean CIEDE2000 where light goes round between fewer patches."""
        return self.error(self.rough, self.rays[RAYS[-1]][::EACH])

    def noise(self) -> dict[int, float]:
        """Return the mean CIEDE2000 by how many rays are cast.

        Each count is judged by the next. As that errs too, independently and by less in the same
        ratio from each count to the next, what it is found to be off by is somewhat too much.
        """
        few, more = RAYS
        counted = self.error(self.rays[few], self.rays[more])
        last = self.error(self.rays[more][::EACH], self.finest)
        ratio = min(last / max(counted, 1e-9), 1.0)
        share = 1.0 / float(np.hypot(1.0, ratio))
        return {few: counted * share, more: last * share, FINEST: last * share * ratio}


@dataclass(frozen=True)
class Places:
    """Places over faces of cells: ``at`` (k, 3), the ``normals`` of the side that is seen (k, 3),
    and their ``cell`` (k,)."""

    at: NDArray[np.float32]
    normals: NDArray[np.float32]
    cell: NDArray[np.int64]

    def part(self, chosen: NDArray) -> Places:
        """Return some of them."""
        return Places(self.at[chosen], self.normals[chosen], self.cell[chosen])


def seen_along(space: Space, starts: NDArray[np.float32], ways: NDArray[np.float32]) -> Places:
    """Return what rays (n, 3) from some starts (n, 3) meet first, for those that meet anything."""
    cells = space.cells
    met = space.caster.first_hits(starts, ways)
    found = np.flatnonzero(met >= 0)
    cell, ways = met[found], ways[found]
    slope, far = cells.along(cell, starts[found], ways)
    normals = np.where(slope[:, None] > 0.0, -cells.normals[cell], cells.normals[cell])
    at = starts[found] + far[:, None].astype(np.float32) * ways
    at = at + space.lift(at) * normals
    return Places(at.astype(np.float32), normals.astype(np.float32), cell)


def spread(space: Space, weight: NDArray[np.float64], count: int = PLACES) -> Places:
    """Return places on the fronts of patches, by the weight (patches,) of each; none without."""
    cells = space.cells
    total = np.cumsum(weight)
    count = count if len(total) and total[-1] > 0.0 else 0
    steps = (np.arange(count) + 0.5) / max(count, 1) * total[-1:]
    patches = np.minimum(np.searchsorted(total, steps), len(total) - 1)
    at, of = cells.places(np.random.default_rng(3).random((count, 3)), patches)
    own = np.arange(count)
    cell, at = of[own, own], at[own, own]
    return Places(at + space.lift(at) * cells.normals[cell], cells.normals[cell], cell)


@dataclass(frozen=True)
class Sent:
    """What surfaces and the sky send along rays: a ``space``, and the ``table`` (rows, 16) and what
    ``tells`` (rows,) anything, as `Radiosity.solve` returned them."""

    space: Space
    table: NDArray[np.float32]
    tells: NDArray[np.float32]

    def light(
        self, places: Places, rays: int, open_light: NDArray[np.float64]
    ) -> Generator[
        float, None, tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
    ]:
        """Return the light (k, 16) that so many rays bring, what of it has not bounced, and which
        part of the rays (k,) tells anything, yielding 0 to 1. ``open_light`` (k, 16): the sky's
        where nothing hides it."""
        space = self.space
        above = np.zeros_like(self.table)
        sky = above[space.sky : space.lost] = self.table[space.sky : space.lost]
        surfaces = np.concatenate([self.table - above, self.tells[:, None]], axis=1)
        shining = np.zeros_like(self.table)
        emission = space.matter.emission[space.cells.kind[space.cells.first]]
        shining[: space.bare] = np.concatenate([emission, emission])
        pattern = directions.pattern(rays)
        more = directions.ratios(sky, open_light, places.normals, pattern)
        result, unbounced, told = np.empty(more.shape), np.zeros(more.shape), np.empty(len(more))
        for part, hits in space.look(places.at, places.normals, pattern, sought=True):
            # Rays may pass panes as none has before.
            filters = np.array(space.filters) if space.filters else None
            wide = None if filters is None else np.concatenate([filters, filters[:, :1]], axis=1)
            sums = gather(hits, surfaces, wide)
            told[part] = sums[:, -1]
            unbounced[part] = more[part] * gather(hits, above, filters)
            result[part] = sums[:, :-1] + unbounced[part]
            if emission.any():
                unbounced[part] += gather(hits, shining, filters)
            emitted = seek(space, places.at[part], places.normals[part], rays_beside(rays))
            for light in (result, unbounced):
                light[part] /= np.maximum(told[part], 1e-3)[:, None]
                light[part] += emitted.light(space, self.table, len(sums))
            yield part.stop / len(told)
        return result, unbounced, told


def probing(
    sent: Sent,
    rough: Sent,
    places: Places,
    lamps: Sequence[Direct],
    to_XYZ: NDArray[np.float64],
) -> Generator[float, None, Probed | None]:
    """Look at the light on places of a picture, yielding 0 to 1; None where there is none.

    ``rough``: the same light between fewer patches; ``to_XYZ`` (3, 16): of light in bands.
    """
    if not len(places.at):
        return None
    space = sent.space
    rng = np.random.default_rng(4)
    direct = np.zeros((len(places.at), to_XYZ.shape[1]))
    for lamp in lamps:
        direct += shine(space, lamp, places.at, places.normals, rng)
    open_light = _open_light(sent.table[space.sky : space.lost], places.normals)
    found: dict[int, NDArray[np.float64]] = {}
    for count in RAYS:
        found[count], first, told = yield from sent.light(places, count, open_light)
    kept = (told >= TOLD) & ((direct + found[RAYS[-1]]).mean(axis=1) > 0.0)
    if not kept.any():
        return None
    some = np.flatnonzero(kept)[::EACH]
    part, above = places.part(some), open_light[some]
    finest, _, _ = yield from sent.light(part, FINEST, above)
    other, _, _ = yield from rough.light(part, RAYS[-1], above)
    return Probed(
        places.normals[kept],
        space.matter.reflectance[space.cells.kind[places.cell[kept]]],
        direct[kept],
        (direct + first)[kept],
        {count: (direct + light)[kept] for count, light in found.items()},
        direct[some] + finest,
        direct[some] + other,
        to_XYZ,
    )


def _open_light(sky: NDArray, normals: NDArray[np.float32]) -> NDArray[np.float64]:
    """Do as `directions.open_light` does, once for normals that differ by less than a thousandth:
    walls have few."""
    _, first, each = np.unique(np.round(normals, 3), axis=0, return_index=True, return_inverse=True)
    return directions.open_light(sky, normals[first])[each.reshape(-1)]
