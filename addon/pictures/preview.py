"""Pictures as Blender's previews hold them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def rgba(rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return sRGB pixels (h, w, 3), row 0 at the top, as RGBA rows from below, flat, 0 to 1."""
    pixels = np.ones((*rgb.shape[:2], 4), np.float32)
    pixels[..., :3] = rgb[::-1] / np.float32(255.0)
    return pixels.ravel()


SIDE = 32
"""[pixels] of a picture of one color."""


def flat(color: tuple[int, int, int]) -> NDArray[np.uint8]:
    """Return a square of one sRGB color, (`SIDE`, `SIDE`, 3)."""
    return np.full((SIDE, SIDE, 3), color, np.uint8)
