"""Whether a bake still holds: what stood around an object then, and what does now."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import sky_bake
from ... import tags
from ..blend_data import kept
from .geometry import Geometry

FAR = 0.02
"""What is smaller, as seen from an object, than this (radius by distance) does not count: it hides
less than a thousandth of the sky."""

BLOCK = 2**16
"""Triangles at once: 25 MB."""

STILL = 2e-6
"""Of the scene's size: places are float32, so what moves by less has not moved."""


def signatures(around: Geometry) -> dict[str, NDArray[np.float64]]:
    """Return what each owner shows, (14,), by name.

    Area, its first (3) and second (6) moments by area, middle (3) and radius of its box, all in
    the world: no subdivision changes them, so a bake does not make its neighbours stale.
    """
    if not len(around.corners):
        return {}
    count = len(around.owners)
    sums = np.zeros((count, 10))
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    i, j = np.triu_indices(3)
    for first in range(0, len(around.corners), BLOCK):
        owner = around.owner[first : first + BLOCK]
        corners = around.corners[first : first + BLOCK] + around.origin
        sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        areas = np.linalg.norm(np.cross(*sides), axis=1) / 2.0
        middle = corners.mean(axis=1)
        # A product's mean over a triangle: a twelfth of its sum over the corners and 9 middles.
        second = 9.0 * middle[:, i] * middle[:, j]
        for each in range(3):
            second += corners[:, each, i] * corners[:, each, j]
        columns = np.concatenate([middle, second / 12.0], axis=1) * areas[:, None]
        for k, column in enumerate((areas, *columns.T)):
            sums[:, k] += np.bincount(owner, column, count)
        np.minimum.at(low, owner, corners.min(axis=1))
        np.maximum.at(high, owner, corners.max(axis=1))
    sums[:, 1:] /= np.maximum(sums[:, :1], 1e-30)
    radius = np.linalg.norm(high - low, axis=1, keepdims=True) / 2.0
    rows = np.concatenate([sums, (low + high) / 2.0, radius], axis=1)
    return dict(zip(around.owners, rows, strict=True))


def remember(baked: Mapping[str, bpy.types.Object], found: dict[str, NDArray]) -> None:
    """Keep with the bakes of objects, by name, what of `signatures` counts for any of them.

    Once for all of them, so that a file grows by what stands in it.
    """
    own = np.array([found[name] for name in baked if name in found]).reshape(-1, 14)
    rows = np.array(list(found.values())).reshape(-1, 14)
    # Of much of a scene all counts: not worth looking at each pair.
    counts = _any_near(rows, own) if 8 * len(own) < len(rows) else np.ones(len(rows), bool)
    mesh = bpy.data.meshes.new(f"{sky_bake.KIND} Surroundings")
    names = [name for name, near in zip(found, counts, strict=True) if near]
    mesh[tags.SEEN_NAMES] = json.dumps(names)
    if names:
        mesh[tags.SEEN_ROWS] = rows[counts].ravel().tolist()
    for bake in baked.values():
        bake.pop(tags.SURROUNDINGS, None)
        before = record_of(bake)
        bake[tags.SEEN] = mesh
        if before is not None and not before.users:
            bpy.data.meshes.remove(before)


def changed(
    baked: Mapping[str, bpy.types.Object], found: dict[str, NDArray], size: float
) -> set[str]:
    """Return the names of objects that, or whose surroundings, differ from what bakes have seen.

    ``baked``: bakes by the names of their objects; ``size``: the scene's.
    """
    result: set[str] = set()
    together: dict[bpy.types.Mesh, list[str]] = {}
    for name, bake in baked.items():
        record = record_of(bake)
        if record is not None:
            together.setdefault(record, []).append(name)
        elif tags.SURROUNDINGS not in bake:
            result.add(name)
        else:
            known: dict[str, Any] = kept.plain(bake, tags.SURROUNDINGS, {})
            rows = {key: np.array(row) for key, row in known.items() if kept.are_numbers(row, 14)}
            result |= _changed([name], rows, found, size) if rows else {name}
    for record, names in together.items():
        result |= _changed(names, _kept(record), found, size)
    return result


def record_of(bake: bpy.types.Object) -> bpy.types.Mesh | None:
    """The mesh of ours that keeps what stood around a bake, None without."""
    return kept.data(bake, tags.SEEN, bpy.types.Mesh)


def _kept(record: bpy.types.Mesh) -> dict[str, NDArray]:
    """What stood around, empty where somebody has changed that: then all has changed."""
    names: list[str] = kept.plain(record, tags.SEEN_NAMES, [])
    rows = kept.numbers(record, tags.SEEN_ROWS, 14 * len(names))
    if not rows or not kept.are_texts(names):
        return {}
    return dict(zip(names, np.array(rows).reshape(-1, 14), strict=True))


def _changed(names, before, found, size):
    """Those of some objects that have changed, or have something near them that has, now or then;
    what was near none of them is not kept, and is as if it were new."""
    unit = np.array([size**2, *[size] * 3, *[size**2] * 6, *[size] * 4])
    both = [key for key in before if key in found]
    then = np.array([before[key] for key in both]).reshape(-1, 14)
    now = np.array([found[key] for key in both]).reshape(-1, 14)
    off = (np.abs(then - now) / unit).max(axis=1, initial=0.0) > STILL
    moved = {key for key, each in zip(both, off, strict=True) if each}
    gone = [before[key] for key in before if key not in found]
    new = [found[key] for key in found if key not in before]
    rows = np.array([*then[off], *now[off], *gone, *new]).reshape(-1, 14)
    result = {name for name in names if (name in before) != (name in found) or name in moved}
    still = [name for name in names if name in found and name not in result]
    near = _any_near(np.array([found[name] for name in still]).reshape(-1, 14), rows, True)
    return result | {name for name, each in zip(still, near, strict=True) if each}


def _any_near(rows: NDArray, others: NDArray, seen: bool = False) -> NDArray[np.bool_]:
    """Which of some rows (n, 14) count for any of others, or with ``seen``, have any that counts
    for them, (n,)."""
    result = np.zeros(len(rows), bool)
    step = max(1, 2**20 // max(len(others), 1))
    for first in range(0, len(rows) if len(others) else 0, step):
        part = rows[first : first + step]
        gap = np.linalg.norm(part[:, None, 10:13] - others[None, :, 10:13], axis=2)
        gap -= part[:, None, 13] + others[None, :, 13]
        radius = others[None, :, 13] if seen else part[:, None, 13]
        result[first : first + step] = ((gap <= 0.0) | (radius > FAR * gap)).any(axis=1)
    return result
