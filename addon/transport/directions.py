"""Directions about a normal as dense as the cosine, and the cells of the sphere they end in."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

SIDE = 128
"""Cells along either side of a half of the sphere: each about 1.1 degrees."""

SKY = 2 * SIDE * SIDE
"""Cells of the sphere: the upper half's first."""


def frames(normals: NDArray) -> NDArray[np.float32]:
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


@lru_cache(maxsize=16)
def pattern(rays: int) -> NDArray[np.float32]:
    """Unit vectors (rays, 3) about z as dense as the cosine.

    A sunflower's (H. Vogel 1979, DOI 10.1016/0025-5564(79)90080-4). Every point has the same, so
    that neighbours err alike, and light shows no grain.
    """
    index = np.arange(rays) + 0.5
    disc = np.sqrt(index / rays) * np.exp(1j * index * np.pi * (3.0 - 5.0**0.5))
    z = np.sqrt(1.0 - np.abs(disc) ** 2)
    return np.stack([disc.real, disc.imag, z], axis=-1).astype(np.float32)


def about(normals: NDArray, pattern: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a pattern (rays, 3) about each normal (n, 3), (n, rays, 3)."""
    return pattern @ frames(normals)


def turned(pattern: NDArray[np.float32], turns: NDArray) -> NDArray[np.float32]:
    """Return a pattern (rays, 3) turned about z by each angle (n,) [rad], (n, rays, 3)."""
    c, s = (f(turns).astype(np.float32)[:, None] for f in (np.cos, np.sin))
    x, y, z = pattern.T
    return np.stack(np.broadcast_arrays(c * x - s * y, s * x + c * y, z), axis=-1)


def cells(ways: NDArray[np.float32]) -> NDArray[np.int32]:
    """Return in which cell of the sphere each direction (..., 3) ends, 0 to `SKY` - 1.

    Each half is an octahedron's, unfolded to a square (Z. Praun and H. Hoppe 2003, DOI
    10.1145/882262.882274); the horizon is its edge, so no cell is of both halves.
    """
    x, y, z = (ways[..., axis] for axis in range(3))
    scale = (0.5 * SIDE) / (np.abs(x) + np.abs(y) + np.abs(z))
    row = np.minimum(((x + y) * scale + 0.5 * SIDE).astype(np.int32), SIDE - 1)
    column = np.minimum(((x - y) * scale + 0.5 * SIDE).astype(np.int32), SIDE - 1)
    return row * SIDE + column + (z < 0.0) * np.int32(SIDE * SIDE)


@lru_cache(maxsize=1)
def centres() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the middle of each cell of the sphere, (SKY, 3), and its solid angle [sr]."""
    fine = 4
    at = (np.arange(SIDE * fine) + 0.5) / (SIDE * fine) * 2.0 - 1.0
    u, v = np.meshgrid(at, at, indexing="ij")
    x, y = (u + v) / 2.0, (u - v) / 2.0
    ways = np.stack([x, y, 1.0 - np.abs(x) - np.abs(y)], axis=-1)
    length = np.linalg.norm(ways, axis=-1)
    # A flat piece of the octahedron's face, seen from the middle: area times cosine by r².
    angle = 1.0 / length**3
    blocks = (SIDE, fine, SIDE, fine)
    total = angle.reshape(blocks).sum(axis=(1, 3))
    mean = (ways / length[..., None] * angle[..., None]).reshape(*blocks, 3).sum(axis=(1, 3))
    mean /= np.linalg.norm(mean, axis=-1, keepdims=True)
    upper, solid = mean.reshape(-1, 3), total.ravel()
    solid = np.concatenate([solid, solid])
    return np.concatenate([upper, upper * [1.0, 1.0, -1.0]]), solid * (4.0 * np.pi / solid.sum())


def sphere(panorama: NDArray, to_panorama: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return what each cell of the world's sphere has of a lat-long panorama (h, 2 h, k), (SKY, k).

    ``to_panorama`` (3, 3): from directions in the world to those in the panorama, whose middle is
    +x and whose top +z. Where pixels are finer than cells their mean, else the nearest's.
    """
    height, width = panorama.shape[:2]
    theta = (np.arange(height) + 0.5) / height * np.pi
    phi = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * np.pi
    ring = np.stack([np.cos(phi), np.sin(phi), np.zeros(width)], axis=-1)
    ring, top = ring @ to_panorama, to_panorama[2]
    ways = np.sin(theta)[:, None, None] * ring + np.cos(theta)[:, None, None] * top
    at = cells(ways.reshape(-1, 3).astype(np.float32))
    weight = np.repeat(np.sin(theta), width)
    total = np.bincount(at, weight, SKY)
    flat = panorama.reshape(-1, panorama.shape[2])
    sums = np.stack([np.bincount(at, weight * column, SKY) for column in flat.T], axis=1)
    ways, _ = centres()
    x, y, z = (ways @ to_panorama.T).T
    row = np.minimum((np.arccos(np.clip(z, -1.0, 1.0)) / np.pi * height).astype(int), height - 1)
    column = ((0.5 - np.arctan2(y, x) / (2.0 * np.pi)) % 1.0 * width).astype(int) % width
    nearest = panorama[row, column]
    full = total > 0.0
    nearest = np.array(nearest, dtype=float)
    nearest[full] = sums[full] / total[full, None]
    return nearest.astype(np.float32)


def open_light(sky: NDArray, normals: NDArray) -> NDArray[np.float64]:
    """Return the irradiance / pi (n, k) of a sphere (SKY, k) on open faces of normals (n, 3)."""
    ways, solid = centres()
    light = (sky * (solid / np.pi)[:, None]).astype(np.float32)
    across = np.ascontiguousarray(ways.T, np.float32)
    result = np.empty((len(normals), sky.shape[1]))
    for k in range(0, len(normals), 128):
        cosines = normals[k : k + 128].astype(np.float32) @ across
        result[k : k + 128] = np.maximum(cosines, 0.0, out=cosines) @ light
    return result


def ratios(channels: NDArray, whole: NDArray, normals: NDArray, pattern: NDArray) -> NDArray:
    """By what the light (n, k) that a pattern's rays bring is multiplied, so that what nothing
    hides is without error.

    ``channels`` (SKY, k): the sphere's; ``whole`` (n, k): `open_light` of them on these normals
    (n, 3). From a half to twice; 1 where the rays find nothing.
    """
    told = channels[cells(about(normals, pattern))].mean(axis=1)
    more = np.clip(whole / np.where(told > 0.0, told, 1.0), 0.5, 2.0)
    return np.where(told > 0.0, more, 1.0)
