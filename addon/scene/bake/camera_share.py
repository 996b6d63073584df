"""What the camera's picture shows: how much of it each patch is, and places all over it."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import run
from ...transport.hits import Space


@dataclass(frozen=True)
class Eye:
    """A camera: its ``place`` (3,), and the matrix ``onto`` (4, 4) from the world to its picture,
    -1 to 1 each way; both relative to the geometry's origin."""

    place: NDArray[np.float64]
    onto: NDArray[np.float64]

    @classmethod
    def of(cls, scene: bpy.types.Scene, origin: NDArray[np.float64]) -> Eye | None:
        """The scene's camera; None without one, and of one that is no perspective."""
        camera = scene.camera
        if camera is None or camera.type != "CAMERA" or camera.data.type != "PERSP":
            return None
        render = scene.render
        projection = camera.calc_matrix_camera(
            bpy.context.evaluated_depsgraph_get(), x=render.resolution_x, y=render.resolution_y
        )
        world = camera.matrix_world.copy()
        world.translation = [a - b for a, b in zip(world.translation, origin, strict=True)]
        return cls(np.array(world.translation), np.array(projection @ world.inverted()))

    def looking(self, count: int) -> NDArray[np.float32]:
        """Return unit vectors (count, 3) from the eye to places spread evenly over its picture."""
        back = np.linalg.inv(self.onto)
        # Kronecker's sequence by the roots of x^3 = x + 1 (M. Roberts 2018).
        steps = 1.324717957244746 ** -np.arange(1.0, 3.0)
        across = (0.5 + np.arange(count)[:, None] * steps) % 1.0 * 2.0 - 1.0
        ends = np.concatenate([across, np.full((count, 1), 0.5), np.ones((count, 1))], axis=1)
        ends = ends @ back.T
        ways = ends[:, :3] / ends[:, 3:] - self.place
        return (ways / np.linalg.norm(ways, axis=1, keepdims=True)).astype(np.float32)


def weights(space: Space, eye: Eye | None, side: int = 1) -> NDArray[np.float64]:
    """Return the solid angle of the front of each patch as the eye sees its middle, (patches,).

    Without an eye the area of each; ``side``: -1 for the back.
    """
    cells = space.cells
    areas = np.bincount(cells.patch, cells.areas, cells.patches)
    if eye is None:
        return areas
    middle = cells.corners[cells.first].mean(axis=1).astype(float)
    normals = side * cells.normals[cells.first]
    to = eye.place - middle
    far = np.maximum(np.linalg.norm(to, axis=1), 1e-9)
    facing = np.einsum("nk,nk->n", to, normals) / far
    at = np.concatenate([middle, np.ones((len(middle), 1))], axis=1) @ eye.onto.T
    inside = (at[:, 3] > 0.0) & (np.abs(at[:, :2]) <= at[:, 3:]).all(axis=1) & (facing > 0.0)
    found = np.flatnonzero(inside)
    starts = middle[found] + 2.0 * space.lift(middle[found]) * normals[found]
    ends = np.broadcast_to(eye.place, starts.shape)
    found = found[run(space.open_between(starts, ends))]
    result = np.zeros(cells.patches)
    result[found] = areas[found] * facing[found] / far[found] ** 2
    return result
