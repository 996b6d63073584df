"""How long a bake will take on this machine, before it starts.

By how many rays it will cast and how fast some thousand are cast now.
"""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import dataclass

import bpy
import numpy as np

from ...transport import directions
from ...transport.rays import Caster
from . import passes
from .how import How
from .least_light import LeastLight

DIVIDED = 60_000
"""Points that faces are divided into, beside their own corners, as scenes usually have it."""

AROUND = 1_300_000, 5_000_000
"""Rays between patches, before a first light and after it."""

WHOLE = 2.2
"""By how much longer than a probe's rays those of a bake take, with all that is made of them."""

START, OBJECT, TRIANGLE = 1.5, 3e-3, 6e-6
"""[s] at all, for each object and for each triangle in the scene, where rays take 0.1 µs."""


@dataclass(frozen=True)
class Estimate:
    """Processor time [s] until there is a ``first`` light, and until ``all`` is done: on a machine
    that has nothing else to do, about as many seconds."""

    first: float
    all: float


def estimate(
    objects: Collection[bpy.types.Object],
    rays: int | None = None,
    slow: bool = False,
    least: LeastLight | None = None,
) -> Estimate:
    """Return how long `scene_bake.bake` will take for some objects, within a factor of about 2.

    ``rays`` from each point at last, or from as many points as need them, up to what is enough for
    the ``least`` light; None: as light asks for.
    It evaluates the scene and casts rays for some hundredths of a second.
    """
    triangles, corners, chosen = 0, 0, 0
    wanted = set(objects)
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        mesh = instance.object.data
        if instance.object.type != "MESH" or mesh is None:
            continue
        by = instance.parent if instance.is_instance else instance.object
        triangles += len(mesh.loops) - 2 * len(mesh.polygons)
        if by.original in wanted:
            corners += len(mesh.loops)
            chosen += 1
    points = corners + DIVIDED
    how = How(rays, 0.0, slow, least=least)
    ends = how.passes(points)
    later = float(points * sum(ends[1:]))
    if rays is None:
        # Some are sure of their light after two passes, and for the others the budget ends it.
        later = min(later, points * sum(ends[1:2]) + passes.left(points, slow))
    ray = seconds_per_ray(triangles, slow)
    scene = (START + chosen * OBJECT + triangles * TRIANGLE) * ray / 1e-7
    first = scene + WHOLE * ray * (AROUND[0] + points * ends[0])
    finer = 0.0 if how.coarse else scene + WHOLE * ray * AROUND[1]
    return Estimate(float(first), float(first + finer + WHOLE * ray * later))


def seconds_per_ray(triangles: int, slow: bool = False, count: int = 4096) -> float:
    """Return how long a ray takes now among so many triangles [s]: the best of three probes.

    Of boxes on a field; each time that triangles become twice as many, a ray takes 6 % longer.
    """
    rng = np.random.default_rng(0)
    square = np.array([[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]], float)
    walls = np.concatenate([square, square[..., [0, 2, 1]], square[..., [2, 0, 1]]])
    places = np.append(rng.uniform(-50, 50, (200, 2)), np.zeros((200, 1)), axis=1)
    sizes = rng.uniform((0.5, 0.5, 2), (3, 3, 15), (200, 3))
    boxes = walls * sizes[:, None, None] + places[:, None, None]
    corners = np.concatenate([boxes.reshape(-1, 3, 3), square * 100.0 - [50.0, 50.0, 0.0]])
    caster = Caster(corners.astype(np.float32), slow)
    count = count if caster.embree else count // 8
    starts = np.append(rng.uniform(-50, 50, (count, 2)), np.full((count, 1), 1e-3), axis=1)
    starts, ways = starts.astype(np.float32), directions.pattern(count)
    caster.first_hits(starts[:1], ways[:1])  # which builds
    found = []
    for _ in range(3):
        began = time.perf_counter()
        caster.first_hits(starts, ways)
        found.append(time.perf_counter() - began)
    return float(min(found) / count * 1.06 ** np.log2(max(triangles / len(corners), 1.0)))
