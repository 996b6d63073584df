"""The light on all surfaces of the open scene, as amounts at the corners of triangles.

What comes from all around changes slowly: it is known for each patch that light goes round between,
and what lies between is interpolated. What lamps and the sun send straight is cast where
it is looked at, and triangles that a shadow's edge crosses are cut.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...choices import QUANTITIES
from ...pictures.false_colour import Scale, scale_of
from ...progress import Progress
from ...spectra.photometry import quantity
from ...transport.bands import COUNT
from ...transport.cells import Cells
from ...transport.hits import THROUGH
from ...transport.meter import Field
from ...transport.radiosity import Radiosity
from ...transport.row_keys import row_keys
from ..bake.light import SceneLight
from .calibration import Calibration
from .lit_scene import LitScene

SIDES = 1.0, -1.0
"""Before faces, and behind them."""

EDGE = 0.1
"""Of the brightest direct light: triangles on which it changes by more are cut …"""

CUTS, MOST = 4, 300_000
"""… so often, but into no more than so many in all."""

_INWARDS = 0.02
"""From a corner to its triangle's middle: where rays start, for other faces end at corners."""


@dataclass(frozen=True)
class SurfaceLight:
    """Amounts of light on triangles ``corners`` (n, 3, 3), relative to ``origin`` (3,).

    ``around`` (n, 2, 3, q): at the corners of fronts and backs, of `QUANTITIES` in their order, all
    but what lamps send straight; NaN in something solid. ``kind`` (n,): which of the scene's
    materials.
    """

    corners: NDArray[np.float32]
    normals: NDArray[np.float32]
    kind: NDArray[np.int32]
    around: NDArray[np.float32]
    origin: NDArray[np.float64]
    calibration: Calibration
    field: Field
    rows: _Rows

    def straight(
        self, places: NDArray, normals: NDArray, kind: NDArray[np.int32]
    ) -> NDArray[np.float32]:
        """Return what lamps and the sun send straight to places (m, 3) on faces of unit normals
        (m, 3) and materials (m,), (m, q)."""
        if not self.field.lamps:
            return np.zeros((len(places), len(QUANTITIES)), np.float32)
        return self.rows(self.field.direct(places, normals), kind)

    def triangles(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return triangles (m, 3, 3) in the world, with all light at their corners (m, 2, 3, q)."""
        cut = self
        light = cut._straight_at_corners()
        for _ in range(CUTS):
            brightest = float(light[..., 0].max(initial=0.0))
            spread = np.ptp(light[..., 0], axis=2).max(axis=1)
            chosen = spread > EDGE * max(brightest, 1e-30)
            if not chosen.any() or len(cut.corners) + 3 * chosen.sum() > MOST:
                break
            kept, parts = cut._only(~chosen), cut._only(chosen)._in_fours()
            light = np.concatenate([light[~chosen], parts._straight_at_corners()])
            cut = kept._with(parts)
        return (cut.corners + self.origin).astype(np.float32), cut.around + light

    def _straight_at_corners(self) -> NDArray[np.float32]:
        """(n, 2, 3, q)"""
        middle = self.corners.mean(axis=1, keepdims=True)
        places = (self.corners + _INWARDS * (middle - self.corners)).reshape(-1, 3)
        normals, kind = np.repeat(self.normals, 3, axis=0), np.repeat(self.kind, 3)
        found = [
            self.straight(places, np.float32(side) * normals, kind).reshape(len(self.kind), 3, -1)
            for side in SIDES
        ]
        return np.stack(found, axis=1)

    def _only(self, chosen: NDArray[np.bool_]) -> SurfaceLight:
        return replace(
            self,
            corners=self.corners[chosen],
            normals=self.normals[chosen],
            kind=self.kind[chosen],
            around=self.around[chosen],
        )

    def _with(self, other: SurfaceLight) -> SurfaceLight:
        names = "corners", "normals", "kind", "around"
        both = {name: np.concatenate([getattr(self, name), getattr(other, name)]) for name in names}
        return replace(self, **both)

    def _in_fours(self) -> SurfaceLight:
        """Each triangle as four."""
        return replace(
            self,
            corners=_fours(self.corners, 1),
            normals=np.repeat(self.normals, 4, axis=0),
            kind=np.repeat(self.kind, 4),
            around=_fours(self.around, 2),
        )


@dataclass(frozen=True)
class _Rows:
    """What makes amounts of irradiance / π in bands, on materials (m, 16, q)."""

    rows: NDArray[np.float32]

    def __call__(self, light: NDArray, kind: NDArray) -> NDArray[np.float32]:
        """Return the amounts (n, q) of light (n, 16) on materials (n,)."""
        result = np.zeros((len(light), self.rows.shape[2]), np.float32)
        for each in np.unique(kind):
            here = kind == each
            result[here] = light[here] @ self.rows[each]
        return result


def _fours(of_corners: NDArray, axis: int) -> NDArray:
    """What four triangles in one have at their corners, linear between its own."""
    a, b, c = np.moveaxis(of_corners, axis, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    found = np.stack([np.stack(part, axis=axis) for part in parts], axis=1)
    return found.reshape(-1, *of_corners.shape[1:])


def measuring(
    lit: LitScene, light: SceneLight, calibration: Calibration
) -> Generator[Progress, None, SurfaceLight]:
    """Measure the light on all surfaces of a scene, yielding how far that is.

    What was measured last is kept, and returned where neither scene nor light have changed.
    """
    radiosity = lit.radiosity
    field, on_sides = yield from lit.solved(light)
    key = light.key(lit.materials), calibration.scale
    if _last and _last[0][0] is radiosity and _last[0][1] == key:
        return _last[0][2]
    cells = field.space.cells
    rows = _rows(lit, light, calibration.scale)
    kind = cells.kind[cells.first[radiosity.patch]]
    of_sides = rows(np.maximum(on_sides, 0.0), kind)
    around = np.full((len(cells), 2, 3, len(QUANTITIES)), np.nan, np.float32)
    for k, side in enumerate(SIDES):
        chosen = np.flatnonzero(radiosity.side == side)
        of_patch = np.full((cells.patches, len(QUANTITIES)), np.nan, np.float32)
        of_patch[radiosity.patch[chosen]] = of_sides[chosen]
        around[:, k] = _at_corners(cells, of_patch[cells.patch])
        yield Progress((k + 1) / 2, "light on surfaces")
    found = SurfaceLight(
        cells.corners, cells.normals, cells.kind, around, lit.origin, calibration, field, rows
    )
    _last[:] = [(radiosity, key, found)]
    return found


_last: list[tuple[Radiosity, tuple[bytes, float], SurfaceLight]] = []


def _rows(lit: LitScene, light: SceneLight, scale: float) -> _Rows:
    restored = light.sources.restored(np.eye(COUNT)) * (scale * light.strength)
    found = [quantity(name) for name in QUANTITIES]
    made = []
    for name in lit.materials:
        rho = light.reflectance(name)
        weights = [one.row * (rho if one.of_radiance else np.pi) for one in found]
        made.append(restored @ np.array(weights).T)
    return _Rows(np.array(made, np.float32).reshape(-1, COUNT, len(QUANTITIES)))


@dataclass(frozen=True)
class Drawing:
    """Light on triangles as a graphics card wants it: ``places`` (3 n, 3) in the world."""

    places: NDArray[np.float32]
    amounts: NDArray[np.float32]
    """(n, 2, 3, q)"""
    light: SurfaceLight

    @classmethod
    def of(cls, light: SurfaceLight) -> Drawing:
        """Return the drawing of what was measured."""
        corners, amounts = light.triangles()
        return cls(corners.reshape(-1, 3), amounts, light)

    def sides(self, name: str) -> NDArray[np.float32]:
        """Return a quantity before and behind faces, (3 n, 2); -1 within something solid."""
        found = np.moveaxis(self.amounts[..., _number(name)], 1, 2)
        return np.ascontiguousarray(np.nan_to_num(found, nan=-1.0).reshape(-1, 2))

    def title(self, name: str) -> str:
        """What stands over the legend."""
        unit = quantity(name).unit if self.light.calibration.absolute else "relative"
        return f"{QUANTITIES[name].label} [{unit}]"

    def scale(self, name: str) -> Scale:
        """Return a scale for a quantity, by places that lie evenly on all surfaces."""
        corners = self.places.reshape(-1, 3, 3)
        if not len(corners):
            return scale_of([])
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = np.linalg.norm(np.cross(one, two), axis=1) + 1e-30
        picked = np.random.default_rng(0).choice(len(area), 20_000, p=area / area.sum())
        return scale_of(self.amounts[picked][..., _number(name)])


def _number(name: str) -> int:
    return list(QUANTITIES).index(name)


def _at_corners(cells: Cells, found: NDArray) -> NDArray[np.float32]:
    """What cells (n, q) give to their corners, (n, 3, q): the mean of all of one material that meet
    there and face the same way, by their areas; twice, for a patch errs by its rays' number."""
    places = np.round(cells.corners.reshape(-1, 3) / (1e-5 * (cells.size or 1.0))).astype(np.int64)
    ways = np.round(np.repeat(cells.normals, 3, axis=0) * 50.0).astype(np.int64)
    rows = np.column_stack([places, ways, np.repeat(cells.kind, 3)])
    _, number = np.unique(row_keys(rows), return_inverse=True)
    number = number.reshape(-1)
    area = np.maximum(np.repeat(cells.areas, 3), 1e-30)
    for _ in range(2):
        value = np.repeat(found, 3, axis=0)
        weight = np.where(np.isfinite(value).all(axis=1), area, 0.0)
        total = np.bincount(number, weight)
        sums = [np.bincount(number, weight * np.nan_to_num(column)) for column in value.T]
        mean = np.stack(sums, axis=1) / np.where(total > 0.0, total, np.nan)[:, None]
        corners = mean[number].reshape(len(cells), 3, -1)
        found = corners.mean(axis=1)
    return corners.astype(np.float32)


def seen(
    light: SurfaceLight, origins: NDArray, ways: NDArray
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Return the amounts (m, q) on what rays (m, 3), (m, 3) from places in the world meet first,
    panes not counted, and how far that is (m,); NaN for rays that meet nothing."""
    space, cells = light.field.space, light.field.space.cells
    at = (origins - light.origin).astype(np.float32)
    ways = np.ascontiguousarray(ways, np.float32)
    met = space.caster.first_hits(np.ascontiguousarray(at), ways)
    going = np.flatnonzero(met >= 0)
    for _ in range(THROUGH):
        going = going[space.matter.clear[cells.kind[met[going]]]]
        if not len(going):
            break
        _, far = cells.along(met[going], at[going], ways[going])
        at[going] += (far[:, None] + 4.0 * space.lift(at[going])) * ways[going]
        met[going] = space.caster.first_hits(np.ascontiguousarray(at[going]), ways[going])
        going = going[met[going] >= 0]
    amounts = np.full((len(ways), len(QUANTITIES)), np.nan, np.float32)
    distance = np.full(len(ways), np.nan)
    hit = np.flatnonzero(met >= 0)
    if len(hit):
        cell, way = met[hit], ways[hit]
        slope, far = cells.along(cell, at[hit], way)
        place = at[hit] + far[:, None] * way
        back = slope > 0.0
        weight = _barycentric(cells.corners[cell], place)
        between = light.around[cell, back.astype(int)]
        normals = np.where(back, np.float32(-1.0), np.float32(1.0))[:, None] * cells.normals[cell]
        amounts[hit] = np.einsum("nc,ncq->nq", weight, between) + light.straight(
            place, normals, cells.kind[cell]
        )
        distance[hit] = np.linalg.norm(place + light.origin - origins[hit], axis=1)
    return amounts, distance


def _barycentric(corners: NDArray, places: NDArray) -> NDArray[np.float32]:
    """What corners (n, 3, 3) count for at places (n, 3) in their triangles, (n, 3)."""
    a, b, c = np.moveaxis(corners.astype(float), 1, 0)
    across = np.cross(b - a, c - a)
    whole = np.maximum(np.einsum("nk,nk->n", across, across), 1e-60)
    u = np.einsum("nk,nk->n", np.cross(b - places, c - places), across) / whole
    v = np.einsum("nk,nk->n", np.cross(c - places, a - places), across) / whole
    found = np.clip(np.stack([u, v, 1.0 - u - v], axis=1), 0.0, 1.0)
    return (found / np.maximum(found.sum(axis=1, keepdims=True), 1e-30)).astype(np.float32)
