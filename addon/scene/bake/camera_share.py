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
    -1 to 1 each way; both relative to the geometry's origin. ``axis``: the unit vector (3,) along
    which an orthographic one looks, None for a perspective."""

    place: NDArray[np.float64]
    onto: NDArray[np.float64]
    axis: NDArray[np.float64] | None = None

    @classmethod
    def of(cls, scene: bpy.types.Scene, origin: NDArray[np.float64]) -> Eye | None:
        """The scene's camera; None without one, and of a panoramic one."""
        camera = scene.camera
        if camera is None or camera.type != "CAMERA" or camera.data.type not in ("PERSP", "ORTHO"):
            return None
        render = scene.render
        projection = camera.calc_matrix_camera(
            bpy.context.evaluated_depsgraph_get(), x=render.resolution_x, y=render.resolution_y
        )
        world = camera.matrix_world.copy()
        world.translation = [a - b for a, b in zip(world.translation, origin, strict=True)]
        axis = None
        if camera.data.type == "ORTHO":
            axis = -np.array(world.to_quaternion().to_matrix())[:, 2]
        return cls(np.array(world.translation), np.array(projection @ world.inverted()), axis)

    def seen_from(self, places: NDArray) -> NDArray[np.float64]:
        """Return where the eye is for each of some places (n, 3)."""
        if self.axis is None:
            return np.broadcast_to(self.place, places.shape)
        return places - ((places - self.place) @ self.axis)[:, None] * self.axis

    def looking(self, count: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return where looks at places spread evenly over its picture begin, (count, 3), and unit
        vectors along them, (count, 3)."""
        back = np.linalg.inv(self.onto)
        # Kronecker's sequence by the roots of x^3 = x + 1 (M. Roberts 2018).
        steps = 1.324717957244746 ** -np.arange(1.0, 3.0)
        across = (0.5 + np.arange(count)[:, None] * steps) % 1.0 * 2.0 - 1.0
        ends = np.concatenate([across, np.full((count, 1), 0.5), np.ones((count, 1))], axis=1)
        ends = ends @ back.T
        seen = ends[:, :3] / ends[:, 3:]
        starts = self.seen_from(seen)
        ways = seen - starts if self.axis is None else np.broadcast_to(self.axis, seen.shape)
        ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
        return starts.astype(np.float32), ways.astype(np.float32)


def weights(space: Space, eye: Eye | None, side: int = 1) -> NDArray[np.float64]:
    """Return the solid angle of the front of each patch as the eye sees its middle, (patches,).

    Of an orthographic eye its area in the picture, without an eye its own; ``side``: -1 for the
    back.
    """
    cells = space.cells
    areas = np.bincount(cells.patch, cells.areas, cells.patches)
    if eye is None:
        return areas
    middle = cells.corners[cells.first].mean(axis=1).astype(float)
    normals = side * cells.normals[cells.first]
    to = eye.seen_from(middle) - middle
    far = np.maximum(np.linalg.norm(to, axis=1), 1e-9)
    facing = np.einsum("nk,nk->n", to, normals) / far
    at = np.concatenate([middle, np.ones((len(middle), 1))], axis=1) @ eye.onto.T
    inside = (at[:, 3] > 0.0) & (np.abs(at[:, :2]) <= at[:, 3:]).all(axis=1) & (facing > 0.0)
    if eye.axis is not None:
        inside &= to @ eye.axis < 0.0  # not behind it
    found = np.flatnonzero(inside)
    starts = middle[found] + 2.0 * space.lift(middle[found]) * normals[found]
    found = found[run(space.open_between(starts, eye.seen_from(middle[found])))]
    result = np.zeros(cells.patches)
    result[found] = areas[found] * facing[found]
    if eye.axis is None:
        result[found] /= far[found] ** 2
    return result
