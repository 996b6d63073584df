"""The meshes of a scene and where each is shown: looked through without copying any of them.

A mesh that is shown a thousand times is held once. A ray is compared with the boxes around the
places, and only what its box meets is looked into.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...transport.rays import Caster
from .geometry import triangles_of

_TOGETHER = 32
"""Places whose boxes lie in one box that is compared first."""

_AT_ONCE = 1 << 20
"""Comparisons of a ray with a box."""

_STRETCHED = 4_000_000
"""Triangles whose areas are computed one by one where they are not scaled evenly."""


@dataclass(eq=False)
class PlacedMeshes:
    """Meshes, each in its own space, and the places where they are shown."""

    triangles: NDArray[np.float64]
    """(t, 3, 3), mesh after mesh; counter-clockwise as seen from their fronts."""
    material: NDArray[np.int64]
    """(t,), which of `materials` each has."""
    materials: list[str]
    """Full names; empty for none."""
    starts: NDArray[np.int64]
    """(m + 1,), the first triangle of each mesh, and the count of triangles."""
    mesh: NDArray[np.int64]
    """(n,), which mesh is shown at each place."""
    matrices: NDArray[np.float64]
    """(n, 4, 4), from there to the world."""

    @cached_property
    def vectors(self) -> NDArray[np.float64]:
        """Of each triangle its normal in its own space, as long as its area, (t, 3)."""
        sides = self.triangles[:, 1:] - self.triangles[:, :1]
        return np.cross(sides[:, 0], sides[:, 1]) / 2.0

    @cached_property
    def boxes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The lowest and highest corners (n, 3) of what is at each place."""
        low = np.minimum.reduceat(self.triangles.min(axis=1), self.starts[:-1])[self.mesh]
        high = np.maximum.reduceat(self.triangles.max(axis=1), self.starts[:-1])[self.mesh]
        turned = self.matrices[:, :3, :3]
        middle = np.einsum("nij,nj->ni", turned, (low + high) / 2.0) + self.matrices[:, :3, 3]
        half = np.einsum("nij,nj->ni", np.abs(turned), (high - low) / 2.0) * (1.0 + 1e-6)
        return middle - half, middle + half

    def of(self, place: int) -> slice:
        """The triangles of the mesh at a place."""
        mesh = self.mesh[place]
        return slice(int(self.starts[mesh]), int(self.starts[mesh + 1]))

    def normals(self, place: int) -> NDArray[np.float64]:
        """The normals of the triangles of a place in the world, fronts out, as long as areas."""
        return self.vectors[self.of(place)] @ self._cofactors[place].T

    def areas(self, chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return the area of chosen triangles (t,) that is shown at each place, (n,).

        Of more stretched triangles than `_STRETCHED` by the mean of how they are stretched.
        """
        own = np.linalg.norm(self.vectors, axis=1) * chosen
        mean = np.abs(np.linalg.det(self.matrices[:, :3, :3])) ** (2.0 / 3.0)
        areas = np.add.reduceat(own, self.starts[:-1])[self.mesh] * mean
        square = np.einsum("nji,njk->nik", *[self.matrices[:, :3, :3]] * 2)
        off = np.abs(square - mean[:, None, None] * np.eye(3)).max(axis=(1, 2))
        stretched = np.flatnonzero((off > 1e-6 * mean) & (areas > 0.0))
        counts = np.diff(self.starts)[self.mesh[stretched]]
        if not len(stretched) or counts.sum() > _STRETCHED:
            return areas
        place = np.repeat(stretched, counts)
        first = np.cumsum(counts) - counts
        number = np.arange(len(place)) - np.repeat(
            first - self.starts[self.mesh[stretched]], counts
        )
        vectors = np.einsum("nij,nj->ni", self._cofactors[place], self.vectors[number])
        areas[stretched] = np.add.reduceat(np.linalg.norm(vectors, axis=1) * chosen[number], first)
        return areas

    @cached_property
    def _cofactors(self) -> NDArray[np.float64]:
        """By what area vectors are multiplied at each place, (n, 3, 3); a mirrored triangle's front
        stays in front."""
        turned = self.matrices[:, :3, :3]
        size = np.abs(np.linalg.det(turned))[:, None, None]
        return size * np.linalg.inv(turned).transpose(0, 2, 1)

    @cached_property
    def _casters(self) -> dict[int, Caster]:
        return {}

    def _caster(self, place: int) -> Caster:
        """What finds hits on the mesh of a place, in its own space.

        By mathutils: `embreex` dies of a thousand scenes at once.
        """
        mesh = int(self.mesh[place])
        if mesh not in self._casters:
            own = self.triangles[self.of(place)].astype(np.float32)
            self._casters[mesh] = Caster(own, slow=True)
        return self._casters[mesh]

    def first_hits(
        self, origins: NDArray[np.float64], ways: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the place and the triangle that each ray (r, 3), (r, 3) meets first.

        Both are -1 where it meets nothing.
        """
        place, triangle = np.full(len(origins), -1), np.full(len(origins), -1)
        if not len(origins) or not len(self.mesh):
            return place, triangle
        nearest = np.full(len(origins), np.inf)
        rays, places = self._met_boxes(origins, ways)
        order = np.argsort(places, kind="stable")
        rays, places = rays[order], places[order]
        ends = np.flatnonzero(np.diff(places, append=-1)) + 1
        start = 0
        for end in ends.tolist():
            own, number = rays[start:end], int(places[start])
            start = end
            back = np.linalg.inv(self.matrices[number])
            at = origins[own] @ back[:3, :3].T + back[:3, 3]
            way = ways[own] @ back[:3, :3].T
            met = self._caster(number).first_hits(at.astype(np.float32), way.astype(np.float32))
            hit = np.flatnonzero(met >= 0)
            found = met[hit] + self.of(number).start
            normal = self.vectors[found]
            across = (way[hit] * normal).sum(axis=1)
            far = ((self.triangles[found, 0] - at[hit]) * normal).sum(axis=1)
            far = far / np.where(across == 0.0, 1.0, across)
            nearer = far < nearest[own[hit]]
            chosen = own[hit][nearer]
            nearest[chosen], place[chosen] = far[nearer], number
            triangle[chosen] = found[nearer]
        return place, triangle

    def _met_boxes(
        self, origins: NDArray[np.float64], ways: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the pairs of a ray and a place whose box it meets, (p,) and (p,)."""
        low, high = self.boxes
        cell = np.floor((low + high) / (0.2 * max(float(np.ptp(low + high)), 1e-30)))
        order = np.lexsort((*(low + high).T, *cell.T))
        starts = np.arange(0, len(order), _TOGETHER)
        group_low = np.minimum.reduceat(low[order], starts)
        group_high = np.maximum.reduceat(high[order], starts)
        found: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []
        some = max(1, _AT_ONCE // len(starts))
        for first in range(0, len(origins), some):
            at, way = origins[first : first + some], ways[first : first + some]
            ray, group = np.nonzero(_meets(at[:, None], way[:, None], group_low, group_high))
            member = group[:, None] * _TOGETHER + np.arange(_TOGETHER)
            ray = np.broadcast_to(ray[:, None], member.shape)[member < len(order)]
            number = order[member[member < len(order)]]
            met = _meets(at[ray], way[ray], low[number], high[number])
            found.append((ray[met] + first, number[met]))
        return tuple(np.concatenate(each) for each in zip(*found, strict=True))  # type: ignore[return-value]


def gather(depsgraph: bpy.types.Depsgraph) -> PlacedMeshes:
    """Gather what `geometry.gathering` does of an evaluated scene, each mesh once."""
    known: dict[Any, int | None] = {}
    materials: dict[str, int] = {"": 0}
    triangles, material = [np.empty((0, 3, 3))], [np.empty(0, np.int64)]
    mesh, matrices = [], []
    for instance in depsgraph.object_instances:
        shown = instance.object
        by = instance.parent if instance.is_instance else shown
        if not instance.show_self or shown.type != "MESH" or not shown.visible_shadow:
            continue
        if shown.hide_render or by.hide_render:
            continue
        key = shown.original.name_full, shown.data.as_pointer() if shown.data else 0
        if key not in known:
            corners, slots, names = triangles_of(shown)
            known[key] = len(triangles) - 1 if len(corners) else None
            if len(corners):
                numbers = [materials.setdefault(name, len(materials)) for name in names]
                triangles.append(corners)
                material.append(np.array(numbers)[slots])
        if known[key] is not None:
            mesh.append(known[key])
            matrices.append([value for row in instance.matrix_world for value in row])
    starts = np.cumsum([len(each) for each in triangles])
    to_world = np.array(matrices, dtype=float).reshape(-1, 4, 4)
    kept = np.abs(np.linalg.det(to_world)) > 1e-20
    return PlacedMeshes(
        np.concatenate(triangles), np.concatenate(material), list(materials), starts,
        np.array(mesh, dtype=np.int64)[kept], to_world[kept],
    )  # fmt: skip


def _meets(origins, ways, low, high) -> NDArray[np.bool_]:
    """Whether rays (…, 3) meet boxes (…, 3), by slabs (T. L. Kay and J. T. Kajiya 1986, DOI
    10.1145/15922.15916)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / ways
        one, other = (low - origins) * inverse, (high - origins) * inverse
    near = np.fmax.reduce(np.fmin(one, other), axis=-1)
    far = np.fmin.reduce(np.fmax(one, other), axis=-1)
    return (far >= 0.0) & (near <= far)
