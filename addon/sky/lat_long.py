"""Where the pixels of a lat-long panorama look, and how much of the sphere each holds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def directions(height: int, width: int) -> NDArray[np.float64]:
    """Return where the pixels' centres look in Blender's world, unit vectors (h, w, 3).

    Row 0 is at the zenith; azimuth runs from +180° at the left edge through 0° (+x, east) in the
    middle to -180°, as Blender's equirectangular mapping has it.
    """
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    azimuth = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * np.pi
    result = np.empty((height, width, 3))
    result[..., 0] = np.cos(elevation)[:, None] * np.cos(azimuth)
    result[..., 1] = np.cos(elevation)[:, None] * np.sin(azimuth)
    result[..., 2] = np.sin(elevation)[:, None]
    return result


def solid_angles(height: int, width: int) -> NDArray[np.float64]:
    """Return the exact solid angle of one pixel in each row, (h,) [sr]; all sum to 4 pi / w."""
    edges = np.sin((0.5 - np.arange(height + 1) / height) * np.pi)
    return -np.diff(edges) * (2.0 * np.pi / width)
