"""Whether a bake still holds: what stood around an object then, and what does now."""

from __future__ import annotations

import json

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import tags
from .geometry import Geometry

FAR = 0.02
"""What is smaller, as seen from an object, than this (radius by distance) does not count: it hides
less than a thousandth of the sky."""

STILL = 2e-6
"""Of the scene's size: places are float32, so what moves by less has not moved."""


def signatures(around: Geometry) -> dict[str, NDArray[np.float64]]:
    """Return what each owner shows, (14,), by name.

    Area, its first (3) and second (6) moments by area, middle (3) and radius of its box, all in
    the world: no subdivision changes them, so a bake does not make its neighbours stale.
    """
    if not len(around.corners):
        return {}
    corners = around.corners + around.origin
    sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = np.linalg.norm(np.cross(*sides), axis=1) / 2.0
    middle = corners.mean(axis=1)
    # A product's mean over a triangle: a twelfth of its sum over the corners and 9 middles.
    i, j = np.triu_indices(3)
    second = (corners[..., i] * corners[..., j]).sum(axis=1) + 9.0 * middle[:, i] * middle[:, j]
    columns = np.concatenate([middle, second / 12.0], axis=1) * areas[:, None]
    count = len(around.owners)
    sums = np.stack([np.bincount(around.owner, c, count) for c in (areas, *columns.T)], axis=1)
    sums[:, 1:] /= np.maximum(sums[:, :1], 1e-30)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, around.owner, corners.min(axis=1))
    np.maximum.at(high, around.owner, corners.max(axis=1))
    radius = np.linalg.norm(high - low, axis=1, keepdims=True) / 2.0
    rows = np.concatenate([sums, (low + high) / 2.0, radius], axis=1)
    return dict(zip(around.owners, rows, strict=True))


def remember(bake: bpy.types.Object, name: str, found: dict[str, NDArray]) -> None:
    """Keep with the bake of an object what of `signatures` counts for it."""
    bake[tags.SURROUNDINGS] = json.dumps(
        {key: row.tolist() for key, row in _near(name, found).items()}
    )


def changed(bake: bpy.types.Object, name: str, found: dict[str, NDArray], size: float) -> bool:
    """Whether an object or what counts for it differs from what its bake has seen.

    `size`: the scene's.
    """
    if tags.SURROUNDINGS not in bake:
        return True
    before, now = json.loads(bake[tags.SURROUNDINGS]), _near(name, found)
    if before.keys() != now.keys():
        return True
    unit = np.array([size**2, *[size] * 3, *[size**2] * 6, *[size] * 4])
    gaps = [np.abs(np.subtract(before[key], row)) / unit for key, row in now.items()]
    return bool(np.max(gaps, initial=0.0) > STILL)


def _near(name, found):
    own = found.get(name)
    if own is None:
        return {}
    kept = {}
    for key, row in found.items():
        distance = np.linalg.norm(row[10:13] - own[10:13]) - own[13] - row[13]
        if distance <= 0.0 or row[13] > FAR * distance:
            kept[key] = row
    return kept
