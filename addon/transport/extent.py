"""Where a scene is and how large: of a house in a wide field the house's size, not the field's."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FAR = 4.0
"""Faces are a field where all else, so many times over, is smaller than one of them."""


def box(corners: NDArray) -> float:
    """Return the longest edge of the box around triangles (n, 3, 3), 0 without any."""
    return float(np.ptp(corners.reshape(-1, 3), axis=0).max()) if len(corners) else 0.0


def scale(corners: NDArray) -> float:
    """Return how large what stands in a scene of triangles (n, 3, 3) is: the longest edge of the
    box around it, or `FAR` times that of all but faces that are larger than this."""
    size = box(corners)
    lengths = np.ptp(corners, axis=1).max(axis=1) if len(corners) else np.empty(0)
    while len(less := corners[lengths * FAR < size]) and 0.0 < FAR * box(less) < size:
        size = FAR * box(less)
    return size


def middle(corners: NDArray) -> NDArray[np.float64]:
    """Return the place (3,) about which most triangles (n, 3, 3) are, where float32 is finest."""
    return np.median(corners.mean(axis=1), axis=0) if len(corners) else np.zeros(3)


def graded(
    corners: NDArray[np.float64], size: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return triangles (n, 3, 3) about the origin, those cut into fours that are longer than a
    scene's ``size`` and than half their way from it, and of which each is a part (n,): so a field
    is fine where something stands on it, and coarse far off."""
    number = np.arange(len(corners))
    while True:
        lengths = np.ptp(corners, axis=1).max(axis=1) if len(corners) else np.empty(0)
        nearest = np.abs(corners.mean(axis=1)).max(axis=1) - lengths if len(corners) else lengths
        large = lengths > np.maximum(1.5 * size, 0.5 * nearest)
        if not large.any():
            return corners, number
        a, b, c = corners[large].swapaxes(0, 1)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        parts = [np.stack(each, axis=1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c))]
        parts.append(np.stack([ab, bc, ca], axis=1))
        corners = np.concatenate([corners[~large], *parts])
        number = np.concatenate([number[~large], np.tile(number[large], 4)])
