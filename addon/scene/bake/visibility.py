"""What points of a scene see of the sky: rays about their normals, summed up into harmonics."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from os import cpu_count

import numpy as np
from numpy.typing import NDArray

from ...sky.harmonics import KEYS, functions
from ...sky.irradiance import exact_irradiance
from . import raycast as casting

CHUNK = 2**18
"""Rays at once and thread: some 50 MB."""

CELL = 2.0
"""[degrees] that a sky's pixels are averaged over before rays look them up: about what a ray of
1024 stands for."""


@dataclass
class Views:
    """What each of n points sees of what lies beyond all triangles."""

    sky: NDArray[np.float32]
    """(n, 16), integral of visibility times cosine / pi times each harmonic over the upper sky."""
    ground: NDArray[np.float32]
    """(n,), the same below the horizon, of the constant 1: 0 to 1."""
    inside: NDArray[np.bool_]
    """(n,), whether a point sees backs of faces only: it lies in something solid."""
    bits: NDArray[np.uint8]
    """(n, rays / 4), by how many thirds each ray reaches the sky (`shares`), in the order of
    `directions`."""

    @classmethod
    def empty(cls, count: int, rays: int) -> Views:
        """Views of points that see nothing yet."""
        sky = np.zeros((count, len(KEYS)), np.float32)
        ground, inside = np.zeros(count, np.float32), np.zeros(count, bool)
        return cls(sky, ground, inside, np.zeros((count, rays // 4), np.uint8))

    def at(self, index: NDArray) -> Views:
        """The views of some points, as copies."""
        return Views(*(values[index] for values in vars(self).values()))

    def put(self, at: NDArray, other: Views) -> None:
        """Write the views of some points over those at their places."""
        for name, values in vars(self).items():
            values[at] = getattr(other, name)


def directions(normals: NDArray, rays: int) -> NDArray[np.float32]:
    """Return unit vectors about each normal (n, 3), (n, rays, 3), as dense as the cosine.

    Every point has the same pattern (a sunflower's: H. Vogel 1979, DOI
    10.1016/0025-5564(79)90080-4), so that neighbours err alike, and light shows no grain.
    """
    return _pattern(rays)[0] @ _frames(normals)


def _frames(normals: NDArray) -> NDArray[np.float32]:
    """Two sides and the normal (n, 3, 3): a frame that turns steadily with the normal, but where
    that looks straight down (J. Frisvad 2012, DOI 10.1080/2165347X.2012.689606)."""
    normals = np.asarray(normals, np.float32)
    nx, ny, nz = normals.T
    down = nz < -0.9999
    scale = 1.0 / np.where(down, 1.0, 1.0 + nz)
    side = np.stack([1.0 - nx * nx * scale, -nx * ny * scale, -nx], axis=1)
    along = np.stack([-nx * ny * scale, 1.0 - ny * ny * scale, -ny], axis=1)
    side[down], along[down] = (0.0, -1.0, 0.0), (-1.0, 0.0, 0.0)
    return np.stack([side, along, normals], axis=1)


@lru_cache(maxsize=4)
def _pattern(rays: int) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.intp]]:
    """Rays (rays, 3) about z, three about each of them (3, rays, 3), and each one's six nearest."""
    index = np.arange(rays) + 0.5
    angle = index * np.pi * (3.0 - 5.0**0.5)
    disc = np.sqrt(index / rays) * np.exp(1j * angle)
    thirds = disc + 0.55 * rays**-0.5 * np.exp(
        1j * (angle + np.arange(3)[:, None] * 2.0 / 3.0 * np.pi)
    )
    thirds *= np.minimum(1.0, (1.0 - 1e-4) / np.abs(thirds))
    near = np.argpartition(np.abs(disc[:, None] - disc), 6, axis=1)[:, :7]

    def raised(disc):
        z = np.sqrt(1.0 - np.abs(disc) ** 2)
        return np.stack([disc.real, disc.imag, z], axis=-1).astype(np.float32)

    return raised(disc), raised(thirds), near


def look(
    scene: casting.Occluders,
    places: NDArray,
    normals: NDArray,
    rays: int = 256,
    slow: bool = False,
) -> Iterator[tuple[slice, Views]]:
    """Yield what points (n, 3) with unit normals (n, 3) see, a few thousand of them at a time.

    In the world; `rays` is a multiple of 16. A point that sees all or nothing of the sky with the
    first quarter of them casts no more. Where the sky ends between two rays both are cast anew, as
    three each. The points must lie a little off their faces. With
    `embreex` all processors work; `slow` does without.
    """
    step = max(1, CHUNK // rays)
    parts = [slice(start, start + step) for start in range(0, len(places), step)]
    starts = (places - scene.origin).astype(np.float32)

    def one(part: slice) -> Views:
        return _look(scene, starts[part], normals[part], rays, slow)

    if slow or not casting.fast() or len(parts) < 2:
        for part in parts:
            yield part, one(part)
        return
    scene.first_hits(starts[:1], starts[:1])  # builds, before threads would each do so
    workers = cpu_count() or 1
    with ThreadPoolExecutor(workers) as pool:
        for first in range(0, len(parts), workers):
            now = parts[first : first + workers]
            yield from zip(now, pool.map(one, now), strict=True)


def _look(scene, starts, normals, rays, slow):
    pattern, thirds, near = _pattern(rays)
    frames = _frames(normals)
    ways = pattern @ frames
    up = ways[..., 2] > 0.0
    reaches = np.empty(up.shape, bool)
    backs = np.zeros(up.shape, bool)

    def cast(points, part):
        chosen = ways[points, part]
        origins = np.repeat(starts[points], chosen.shape[1], axis=0)
        hits = scene.first_hits(origins, np.ascontiguousarray(chosen.reshape(-1, 3)), slow)
        hits = hits.reshape(chosen.shape[:2])
        reaches[points, part] = hits < 0
        behind = np.einsum("nrk,nrk->nr", chosen, scene.normals[hits]) if len(scene.normals) else 0
        backs[points, part] = (hits >= 0) & (behind > 0.0)

    # A quarter of the rays, every fourth of the sunflower's, tells who sees all or nothing.
    some = slice(None, None, 4)
    cast(slice(None), some)
    mixed = np.zeros(len(starts), bool)
    for half in (up, ~up):
        seen, there = (reaches & half)[:, some].sum(axis=1), half[:, some].sum(axis=1)
        mixed |= (seen > 0) & (seen < there)
        reaches |= half & ((seen == there) & (there > 0))[:, None] & _rest(rays)
        reaches &= ~(half & (seen == 0)[:, None] & _rest(rays))
    for offset in (1, 2, 3):
        cast(np.flatnonzero(mixed), slice(offset, None, 4))
    # Edges: what a ray stands for is seen in part.
    mixed = np.flatnonzero(mixed)
    edge = (reaches[mixed][:, near] != reaches[mixed][..., None]).any(axis=2)
    point, ray = np.nonzero(edge)
    point = mixed[point]
    count = 3 * reaches.astype(np.uint8)
    count[point, ray] = 0
    for third in thirds:
        way = np.einsum("ri,rij->rj", third[ray], frames[point])
        hits = scene.first_hits(starts[point], way, slow)
        # A third beyond the horizon belongs to the other half: here it is as the ray itself.
        same = (way[:, 2] > 0.0) == up[point, ray]
        count[point, ray] += np.where(same, hits < 0, reaches[point, ray])
    seen = np.where(up, count, 0) / np.float32(3.0)
    x, y, z = (np.ascontiguousarray(ways[..., axis]) for axis in range(3))
    sky = np.stack([np.einsum("nr,nr->n", seen, y_lm) for y_lm in functions(x, y, z)], 1) / rays
    ground = np.where(up, 0, count).mean(axis=1, dtype=np.float32) / np.float32(3.0)
    inside = ~reaches.any(axis=1) & (backs[:, some].mean(axis=1) > 0.5)
    bits = [np.packbits(plane, axis=1) for plane in (count & 2, count & 1)]
    return Views(sky, ground, inside, np.concatenate(bits, axis=1))


def shares(bits: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return which part of each ray reaches the sky, (n, rays), of `Views.bits`."""
    twos, ones = np.split(np.unpackbits(bits, axis=1), 2, axis=1)
    return (2 * twos + ones) / np.float32(3.0)


def _rest(rays):
    """The rays that are not among the first quarter."""
    return np.arange(rays) % 4 > 0


@dataclass
class UpperSky:
    """A sky's upper half, ready to be looked up by rays."""

    cells: NDArray[np.float32]
    """(rows, columns, 3), radiance of equal steps of elevation and azimuth."""
    panorama: NDArray
    """(h, 2 h, 3), black below the horizon."""
    turn: float
    """[rad] about z from a direction in the world to that in the panorama."""

    @classmethod
    def of(cls, rgb: NDArray, turn: float = 0.0) -> UpperSky:
        """A lat-long sky (h, 2 h, 3) without its sun, as the World shows it turned."""
        panorama = np.array(rgb, np.float32)
        height = len(panorama)
        panorama[height // 2 :] = 0.0
        rows = max(1, round(90.0 / CELL))
        step = max(1, height // 2 // rows)
        upper = panorama[: height // 2 // step * step]
        weight = np.sin((np.arange(len(upper)) + 0.5) / height * np.pi)[:, None, None]
        blocks = (len(upper) // step, step, -1, step if (2 * height) % step == 0 else 1, 3)
        total = (upper * weight).reshape(blocks).sum(axis=(1, 3))
        count = (weight.reshape(-1, step).sum(axis=1) * blocks[3])[:, None, None]
        return cls((total / count).astype(np.float32), panorama, turn)

    def radiance(self, ways: NDArray) -> NDArray[np.float32]:
        """The sky's RGB along unit vectors (…, 3) in the world, 0 below the horizon."""
        rows, columns = self.cells.shape[:2]
        row = np.arccos(np.clip(ways[..., 2], 0.0, 1.0)) * (2.0 / np.pi * rows)
        turns = (np.arctan2(ways[..., 1], ways[..., 0]) + self.turn) / (2.0 * np.pi)
        column = ((0.5 - turns) % 1.0 * columns).astype(np.int32) % columns
        found = self.cells[np.minimum(row.astype(np.int32), rows - 1), column]
        found[ways[..., 2] <= 0.0] = 0.0
        return found


def exact(sky: UpperSky, normals: NDArray, bits: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the irradiance / pi (n, 3) of a sky on points of which rays are known.

    What an open face receives, exactly, times the part of it that the rays let pass: for a face
    that nothing hides it is without error.
    """
    c, s = np.cos(sky.turn), np.sin(sky.turn)
    turned = normals @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    _, first, index = _alike(normals)
    return passing(sky, normals, bits) * exact_irradiance(sky.panorama, turned[first])[index]


def passing(sky: UpperSky, normals: NDArray, bits: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return which part (n, 3) of an open face's RGB of a sky reaches points."""
    rays = 4 * bits.shape[1]
    _, first, index = _alike(normals)
    order = np.argsort(index, kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(index))[:-1])
    result = np.zeros((len(normals), 3))
    for at, normal in zip(groups, normals[first], strict=True):
        light = sky.radiance(directions(normal[None], rays)[0])
        result[at] = shares(bits[at]) @ light / np.maximum(light.sum(axis=0), 1e-30)
    return result


def _alike(normals):
    """Normals that are as good as one, the first of each, and which each point has."""
    unique, first, index = np.unique(
        np.round(normals, 3), axis=0, return_index=True, return_inverse=True
    )
    return unique, first, index.reshape(-1)
