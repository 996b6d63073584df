"""Key skies as `node_groups.day_sky` looks them up: where pixels look, and all in one image."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....node_groups.day_sky import COLUMNS, GUTTER, HIGH, LOW, ROWS


def directions(elevation: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where the pixels of a key sky look: elevation (`ROWS`,) and azimuth from the sun (`COLUMNS`,)
    [rad], for the sun's elevation [degrees]; the first row is the horizon."""
    knot = min(max(elevation, LOW), HIGH)
    v = 2.0 * np.arange(ROWS) / (ROWS - 1)
    rows = np.minimum(v, 1.0) * knot + np.maximum(v - 1.0, 0.0) * (90.0 - knot)
    return np.radians(rows), np.linspace(0.0, np.pi, COLUMNS)


def atlas(skies: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Key skies (`ROWS`, `COLUMNS`, 3) as one picture, (n `TILE`, `COLUMNS`, 3), its top row first:
    the first sky is at the bottom, and each stands on its horizon."""
    gutter = ((GUTTER, GUTTER), (0, 0), (0, 0))
    return np.concatenate([np.pad(sky, gutter, mode="edge") for sky in skies])[::-1]
