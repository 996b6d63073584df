"""What geometry is around materials: how much of the sky it hides, and what lies under them."""

from __future__ import annotations

from collections.abc import Collection, Generator, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, run
from . import placed_meshes
from .placed_meshes import PlacedMeshes

_POINTS, _RAYS = 64, 64
"""Places that are looked from, and rays from each: a hundredth of the sky, in some tenths of a
second."""

LOOKING = Progress(0.0, "the sky")

_LIFT = 1e-4
"""How far over its face a place lies, of the scene's size: rays must not meet their own face."""


def hidden_share(scene: bpy.types.Scene, chosen: Collection[bpy.types.Material]) -> float | None:
    """Return the part, 0 to 1, of an even sky's light that is kept from faces of some materials.

    What another object, or the face's own, stands in front of; faces that look down count by the
    sky that they could see. From a few places in proportion to their area, always the same ones.
    None where no visible face has one of the materials.
    """
    return run(hiding(chosen))


def hiding(
    chosen: Collection[bpy.types.Material],
) -> Generator[Progress, None, float | None]:
    """Find the `hidden_share`, yielding now and then."""
    around = placed_meshes.gather(bpy.context.evaluated_depsgraph_get())
    names = [material.name_full for material in chosen]
    yield LOOKING
    return (yield from aside(LOOKING, _hidden, around, names))


def _hidden(around: PlacedMeshes, names: Sequence[str]) -> float | None:
    rng = np.random.default_rng(0)
    starts, normals = _places(around, names, rng)
    # Cosine-weighted about the normal (N. Malley): the normal plus an even direction.
    even = rng.standard_normal((len(starts), _RAYS, 3))
    ways = normals[:, None] + even / np.linalg.norm(even, axis=2, keepdims=True)
    ways /= np.maximum(np.linalg.norm(ways, axis=2, keepdims=True), 1e-9)
    up = ways[..., 2] > 0.0
    if not up.any():
        return None
    origins = np.broadcast_to(starts[:, None], ways.shape)[up]
    place, _ = around.first_hits(origins, ways[up])
    return float(np.mean(place >= 0))


def ground_below(
    scene: bpy.types.Scene, chosen: Collection[bpy.types.Material]
) -> tuple[bool, bpy.types.Material | None]:
    """Return whether geometry lies under the faces of some materials, and its usual material.

    Of faces that see what is below them nine in ten have to have something straight under them.
    """
    return run(looking_below(chosen))


def looking_below(
    chosen: Collection[bpy.types.Material],
) -> Generator[Progress, None, tuple[bool, bpy.types.Material | None]]:
    """Find the `ground_below`, yielding now and then."""
    around = placed_meshes.gather(bpy.context.evaluated_depsgraph_get())
    names = [material.name_full for material in chosen]
    yield LOOKING
    usual = yield from aside(LOOKING, _below, around, names)
    if usual is None:
        return False, None
    return True, next((m for m in bpy.data.materials if m.name_full == usual), None)


def _below(around: PlacedMeshes, names: Sequence[str]) -> str | None:
    starts, normals = _places(around, names, np.random.default_rng(0))
    starts = starts[normals[:, 2] <= 0.7]
    place, triangle = around.first_hits(starts, np.broadcast_to([0.0, 0.0, -1.0], starts.shape))
    below = around.material[triangle[place >= 0]].tolist()
    if not len(starts) or len(below) < 0.9 * len(starts):
        return None
    return around.materials[max(sorted(set(below)), key=below.count)]


def _places(
    around: PlacedMeshes, names: Sequence[str], rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points just over faces of materials of these names, and normals, (k, 3) and (k, 3).

    Evenly over all such faces; k is 0 where there are none.
    """
    own = np.isin(around.materials, names)[around.material]
    areas = around.areas(own) if own.any() else np.zeros(0)
    ends, none = np.cumsum(areas), np.empty((0, 3))
    if not areas.sum() > 0.0:
        return none, none
    low, high = (box[areas > 0.0] for box in around.boxes)
    lift = _LIFT * (high.max(axis=0) - low.min(axis=0)).max()
    starts, normals = [], []
    for along in (np.arange(_POINTS) + 0.5) / _POINTS * ends[-1]:
        place = min(int(np.searchsorted(ends, along)), len(areas) - 1)
        vectors = around.normals(place)
        within = np.cumsum(np.linalg.norm(vectors, axis=1) * own[around.of(place)])
        rest = (along - (ends[place] - areas[place])) / areas[place] * within[-1]
        face = min(int(np.searchsorted(within, rest)), len(within) - 1)
        # Evenly over the triangle (R. Osada et al. 2002, DOI 10.1145/571647.571648).
        root, across = np.sqrt(rng.random()), rng.random()
        shares = np.array([1.0 - root, root * (1.0 - across), root * across])
        matrix = around.matrices[place]
        corners = around.triangles[around.of(place)][face]
        at = shares @ corners @ matrix[:3, :3].T + matrix[:3, 3]
        normals.append(vectors[face] / np.linalg.norm(vectors[face]))
        starts.append(at + lift * normals[-1])
    return np.array(starts), np.array(normals)
