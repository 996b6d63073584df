"""The two scenes as numbers, so that Blender and the reference build the same thing."""

from dataclasses import dataclass

import numpy as np

CHECKER_COLUMNS, CHECKER_ROWS = 6, 4
SPHERE_RADIUS = 0.45


@dataclass(frozen=True)
class Camera:
    """A pinhole or orthographic camera: ``right``, ``up``, ``back`` are its axes in the world."""

    location: np.ndarray
    right: np.ndarray
    up: np.ndarray
    back: np.ndarray
    width: int
    height: int
    scale: float
    """Width of the picture in metres (orthographic) or at one metre's distance (pinhole)."""
    orthographic: bool

    def rays(self, oversampling: int = 1) -> tuple[np.ndarray, np.ndarray]:
        """Return origins and unit directions through the pixels' centres, (h, w, 3) each.

        With ``oversampling`` n there are n x n rays to the pixel, (n h, n w, 3).
        """
        width, height = self.width * oversampling, self.height * oversampling
        step = self.scale / width
        x = (np.arange(width) + 0.5 - width / 2) * step
        y = -(np.arange(height) + 0.5 - height / 2) * step
        offset = x[None, :, None] * self.right + y[:, None, None] * self.up
        if self.orthographic:
            return self.location + offset, np.broadcast_to(-self.back, offset.shape)
        directions = offset - self.back
        directions = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
        return np.broadcast_to(self.location, offset.shape), directions


def look(location, target, width, height, scale, orthographic=False) -> Camera:
    """Return a camera at ``location`` that looks at ``target``, z up."""
    location, target = np.asarray(location, float), np.asarray(target, float)
    back = (location - target) / np.linalg.norm(location - target)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    return Camera(location, right, np.cross(back, right), back, width, height, scale, orthographic)


CHECKER_CAMERA = look((0, -14, 14), (0, 0, 0), 384, 256, CHECKER_COLUMNS, orthographic=True)


def sphere_centres() -> np.ndarray:
    """Return the centres (24, 3) of the checker's spheres, in the chart's order for its camera.

    Each is far behind the one before: none is seen in another's light.
    """
    k = np.arange(CHECKER_COLUMNS * CHECKER_ROWS)
    x = k % CHECKER_COLUMNS - (CHECKER_COLUMNS - 1) / 2
    y = (CHECKER_ROWS - 1) / 2 - k // CHECKER_COLUMNS
    across = x[:, None] * CHECKER_CAMERA.right + y[:, None] * CHECKER_CAMERA.up
    return across - 15.0 * k[:, None] * CHECKER_CAMERA.back


BUILDING_CAMERA = look((7.0, -11.0, 3.2), (0.0, 0.0, 1.9), 240, 160, 0.86)


def _box_sides(x0, x1, y0, y1, z0, z1):
    """Return the four upright faces of a box, outwards."""
    a, b, c, d = (x0, y0), (x1, y0), (x1, y1), (x0, y1)
    for (xa, ya), (xb, yb) in ((a, b), (b, c), (c, d), (d, a)):
        yield [(xa, ya, z0), (xb, yb, z0), (xb, yb, z1), (xa, ya, z1)]


def building() -> dict[str, list[list[tuple[float, float, float]]]]:
    """Return the building: polygons (corners counter-clockwise from outside) by material."""
    w, d, h, ridge = 3.0, 2.0, 2.6, 4.2
    eaves = 0.35
    slope = (ridge - h) / d
    low = h - eaves * slope
    return {
        "walls": [
            *_box_sides(-w, w, -d, d, 0.0, h),
            [(w, -d, h), (w, d, h), (w, 0.0, ridge)],
            [(-w, d, h), (-w, -d, h), (-w, 0.0, ridge)],
        ],
        "roof": [
            [
                (-w - 0.2, -d - eaves, low),
                (w + 0.2, -d - eaves, low),
                (w + 0.2, 0, ridge),
                (-w - 0.2, 0, ridge),
            ],
            [
                (w + 0.2, d + eaves, low),
                (-w - 0.2, d + eaves, low),
                (-w - 0.2, 0, ridge),
                (w + 0.2, 0, ridge),
            ],
        ],
        "paving": [[(-60, -60, -0.01), (60, -60, -0.01), (60, 60, -0.01), (-60, 60, -0.01)]],
        "door": [
            [
                (-0.6, -d - 0.02, 0.0),
                (0.5, -d - 0.02, 0.0),
                (0.5, -d - 0.02, 2.1),
                (-0.6, -d - 0.02, 2.1),
            ]
        ],
        "shutters": [
            [
                (x, -d - 0.02, 0.9),
                (x + 0.5, -d - 0.02, 0.9),
                (x + 0.5, -d - 0.02, 2.1),
                (x, -d - 0.02, 2.1),
            ]
            for x in (-2.4, -1.5, 1.2, 2.1)
        ],
    }


BUILDING_MATERIALS = {
    "walls": "light skin",
    "roof": "moderate red",
    "paving": "neutral 6.5 (.44 D)",
    "door": "blue",
    "shutters": "bluish green",
}
"""Measured reflectance of each part: surfaces of the ColorChecker that look like plaster, tile,
stone and paint."""
