"""How open places are: hours of sun, and how much of the sky's light on them is not hidden."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from . import directions
from .rays import Caster

BLOCK = 1 << 20
"""Rays at once."""


def sun_hours(
    caster: Caster,
    places: NDArray[np.float32],
    normals: NDArray[np.float32],
    suns: NDArray[np.float64],
    hours: float,
) -> Generator[float, None, NDArray[np.float64]]:
    """Return the hours (n,) of sun of suns (k, 3) of so many each, yielding how far it is, 0 to 1.

    A face has the sun where that stands before it and over the horizon, and nothing is between.
    ``places`` (n, 3): a little over the faces, whose unit ``normals`` (n, 3) are.
    """
    found = np.zeros(len(places))
    for k, way in enumerate(suns):
        if way[2] > 0.0:
            facing = np.flatnonzero(normals @ way > 1e-6)
            ways = np.broadcast_to(way.astype(np.float32), (len(facing), 3))
            free = caster.first_hits(places[facing], np.ascontiguousarray(ways)) < 0
            found[facing[free]] += hours
        yield (k + 1) / len(suns)
    return found


def sky_view(
    caster: Caster, places: NDArray[np.float32], normals: NDArray[np.float32], rays: int
) -> Generator[float, None, NDArray[np.float64]]:
    """Return the sky view factors (n,) of places, yielding how far it is, 0 to 1.

    The part of the light that a face would have of an even sphere which it has of the even sky:
    1 of level ground in the open, 0.5 of a wall. By ``rays`` as dense as the cosine.
    """
    pattern, found = directions.pattern(rays), np.zeros(len(places))
    step = max(1, BLOCK // rays)
    for first in range(0, len(places), step):
        part = slice(first, first + step)
        ways = directions.about(normals[part], pattern)
        up = ways[..., 2] > 0.0
        origins = np.broadcast_to(places[part][:, None], ways.shape)[up]
        free = caster.first_hits(np.ascontiguousarray(origins), ways[up]) < 0
        seen = np.zeros(up.shape)
        seen[up] = free
        found[part] = seen.mean(axis=1)
        yield min((first + step) / len(places), 1.0)
    return found
