"""Surfaces as cells, each of one light: triangles cut into fours where light changes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from . import extent
from .row_keys import row_keys

FINEST = 8
"""How often a triangle may be cut: into 65,536 cells."""


@dataclass
class Matter:
    """What kinds of surfaces do with light in `bands.COUNT` bands, each array by kind (m, …)."""

    reflectance: NDArray[np.float32]
    """(m, 16), 0 to 1; a mirror or metal has its share too, sent evenly."""
    emission: NDArray[np.float32]
    """(m, 16), radiance that faces send of their own, to either side."""
    opacity: NDArray[np.float32]
    """(m,), the part of light that does not pass as through a hole."""
    clear: NDArray[np.bool_]
    """(m,), panes: what they do not let through is lost."""
    transmittance: NDArray[np.float32]
    """(m, `ANGLES`, 16) of panes, by the cosine within air, 0 to 1 in equal steps."""
    mirrored: NDArray[np.float32]
    """(m, `ANGLES`), the part of light that panes mirror, of all bands alike."""


ANGLES = 8


@dataclass
class Surfaces:
    """Triangles of a scene, counter-clockwise as seen from their fronts."""

    corners: NDArray[np.float64]
    """(n, 3, 3), near the origin."""
    kind: NDArray[np.int32]
    """(n,), which of the `Matter` each has."""
    solid: NDArray[np.bool_]
    """(n,), whether its back is inside something, where nobody looks."""
    thing: NDArray[np.int32]
    """(n,), of which thing each is a part: small ones of one thing may go together."""
    size: float = -1.0
    """How large what stands there is; below 0 as `extent.scale` finds it."""

    def __post_init__(self) -> None:
        if self.size < 0.0:
            self.size = extent.scale(self.corners)

    @cached_property
    def lengths(self) -> NDArray[np.float64]:
        """(n,), the side of a square of twice a triangle's area."""
        one, two = self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0]
        return np.sqrt(np.linalg.norm(np.cross(one, two), axis=1))


def levels_for(
    surfaces: Surfaces, length: float, most: int, small: float = np.inf
) -> NDArray[np.int64]:
    """Return how often to cut each triangle for cells about so long, at most so many in all.

    Those that are longer than ``small`` get 64 cells each or 16 or 4, as long as that leaves half
    of them: a yard in a wide field has its own scale. They get these, and each triangle one, also
    where that is more than ``most``.
    """
    away = np.abs(surfaces.corners.mean(axis=1)).max(axis=1) - surfaces.lengths
    far = np.maximum(away / max(surfaces.size, 1e-30), 1.0)  # what is far off is coarse
    large = (surfaces.lengths > small) & (far == 1.0)
    least = next((k for k in (3, 2, 1) if large.sum() * 4**k <= most / 2), 0)
    enough = max(most, len(large) + int(large.sum()) * (4**least - 1))
    while True:
        wanted = np.ceil(np.log2(np.maximum(surfaces.lengths / (far * length), 1.0)))
        levels = np.minimum(np.maximum(wanted, least * large), FINEST).astype(int)
        if (4**levels).sum() <= enough:
            return levels
        length *= 1.2


def pieces(
    surfaces: Surfaces, levels: NDArray[np.int64], most: int = 2
) -> tuple[Surfaces, NDArray[np.int64], NDArray[np.int64]]:
    """Return triangles of which none is cut more often than ``most``, where these are cut so often
    (n,): how often each still is, and of which it is a part. So a field need not be cut finely all
    over for the sake of the yard in it."""
    before = np.maximum(levels - most, 0)
    cut = Cells.of(surfaces, before)
    thing = surfaces.thing[cut.triangle]
    parts = Surfaces(cut.corners.astype(float), cut.kind, cut.solid, thing, surfaces.size)
    return parts, (levels - before)[cut.triangle], cut.triangle


@lru_cache(maxsize=FINEST + 1)
def _cuts(level: int) -> NDArray[np.float32]:
    """Barycentric corners (4^level, 3, 3) of the cells of a triangle; four that follow one another
    are one of the level before, the fourth in their middle."""
    if level == 0:
        return np.eye(3, dtype=np.float32)[None]
    a, b, c = _cuts(level - 1).swapaxes(0, 1)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.stack([np.stack(part, axis=1) for part in parts], axis=1).reshape(-1, 3, 3)


@dataclass
class Cells:
    """Triangles of `Surfaces`, cut; what is of one light is a patch: a cell, or many small ones."""

    corners: NDArray[np.float32]
    """(n, 3, 3)"""
    triangle: NDArray[np.int64]
    """(n,), which triangle each is a part of, ascending; those of one follow one another."""
    level: NDArray[np.int64]
    """(triangles,), how often each was cut."""
    kind: NDArray[np.int32]
    solid: NDArray[np.bool_]
    patch: NDArray[np.int32]
    """(n,), which patch each belongs to."""
    size: float
    """How large all is, see `extent.scale`."""

    @classmethod
    def of(cls, surfaces: Surfaces, levels: NDArray, small: float = 0.0) -> Cells:
        """Cut each triangle (n,) so often; uncut ones shorter than ``small`` go together where
        they are of one thing and matter, look alike (by octant) and lie near one another."""
        counts = 4**levels
        starts = np.cumsum(counts) - counts
        total = int(counts.sum())
        corners = np.empty((total, 3, 3), np.float32)
        for level in np.unique(levels):
            chosen = np.flatnonzero(levels == level)
            at = starts[chosen][:, None] + np.arange(4**level)
            cuts = _cuts(int(level))
            flat = cuts.reshape(-1, 3) @ surfaces.corners[chosen].astype(np.float32)
            corners[at.ravel()] = flat.reshape(-1, 3, 3)
        triangle = np.repeat(np.arange(len(levels)), counts)
        kind, solid = surfaces.kind[triangle], surfaces.solid[triangle]
        patch = _patches(surfaces, levels, counts, small)
        return cls(corners, triangle, np.asarray(levels), kind, solid, patch, surfaces.size)

    def __len__(self) -> int:
        return len(self.corners)

    @cached_property
    def _vectors(self) -> NDArray[np.float32]:
        one, two = self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0]
        return np.cross(one, two)

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """(n,)"""
        return np.linalg.norm(self._vectors.astype(float), axis=1) / 2.0

    @cached_property
    def normals(self) -> NDArray[np.float32]:
        """(n, 3), unit; 0 of a cell without area."""
        length = (2.0 * self.areas)[:, None].astype(np.float32)
        return np.divide(self._vectors, length, out=np.zeros_like(self._vectors), where=length > 0)

    @cached_property
    def first(self) -> NDArray[np.int64]:
        """(patches,), one cell of each."""
        return np.unique(self.patch, return_index=True)[1]

    @property
    def patches(self) -> int:
        """How many there are."""
        return len(self.first)

    @cached_property
    def _order(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Cells by patches, their areas summed up, and of each patch the sum before and its own."""
        order = np.argsort(self.patch, kind="stable")
        areas = np.maximum(self.areas[order], 1e-30)
        total = np.cumsum(areas)
        own = np.bincount(self.patch, np.maximum(self.areas, 1e-30), self.patches)
        return order, total, np.cumsum(own) - own, own

    def along(
        self, cell: NDArray, at: NDArray, ways: NDArray
    ) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """Return the cosines (n,) of rays (n, 3) from places (n, 3) with the normals of cells (n,),
        and how far along the rays the planes of the cells are (n,)."""
        normals = self.normals[cell]
        slope = np.einsum("nk,nk->n", ways, normals)
        to = np.einsum("nk,nk->n", self.corners[cell, 0] - at, normals)
        return slope, to / np.where(slope == 0.0, 1e-9, slope)

    def curvature(self, values: NDArray) -> NDArray[np.float64]:
        """Return for each triangle (t,) by how much at most the middle one of four cells differs
        from what the three around it tell, in units of ``values`` (patches,); 0 where not cut."""
        result = np.zeros(len(self.level))
        cut = np.flatnonzero(self.level[self.triangle] > 0)
        if len(cut) == 0:
            return result
        fours = values[self.patch[cut]].reshape(-1, 4)
        off = np.abs(fours[:, 3] - fours[:, :3].mean(axis=1))
        np.maximum.at(result, self.triangle[cut].reshape(-1, 4)[:, 0], off)
        return result

    def places(self, shares: NDArray, patches: NDArray) -> tuple[NDArray[np.float32], NDArray]:
        """Return points (k, r, 3) on patches (k,) by shares (r, 3) or (k, r, 3) of the unit cube,
        evenly, and the cells (k, r) that they lie in (R. Osada et al. 2002, DOI
        10.1145/571647.571648)."""
        order, total, before, own = self._order
        if len(self) == self.patches:
            cells = np.repeat(self.first[patches][:, None], shares.shape[-2], axis=1)
        else:
            at = before[patches][:, None] + shares[..., 0] * own[patches][:, None]
            cells = order[np.minimum(np.searchsorted(total, at), len(total) - 1)]
        root, along = np.sqrt(shares[..., 1:2]), shares[..., 2:]
        weight = np.concatenate([1.0 - root, root * (1.0 - along), root * along], axis=-1)
        found = np.einsum("...rc,...rcx->...rx", weight.astype(np.float32), self.corners[cells])
        return found, cells


def _patches(surfaces, levels, counts, small):
    """The patch of each cell, (n,)."""
    alone = (levels > 0) | (surfaces.lengths >= small)
    triangles = np.flatnonzero(~alone)
    number = np.zeros(len(levels), np.int64)
    number[alone] = np.cumsum(counts[alone]) - counts[alone]
    total = int(counts[alone].sum())
    if len(triangles):
        at = surfaces.corners[triangles]
        normal = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        octant = (normal > 0.0) @ np.array([1, 2, 4])
        place = np.floor(at.mean(axis=1) / max(small * 4.0, 1e-9)).astype(np.int64)
        kind, solid = surfaces.kind[triangles], surfaces.solid[triangles]
        key = np.column_stack([surfaces.thing[triangles], kind, solid, octant, place])
        of_row = np.unique(row_keys(key), return_inverse=True)[1]
        number[triangles] = total + of_row.reshape(-1)
    within = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)
    return (np.repeat(number, counts) + within).astype(np.int32)
