"""Where meters stand and look: single ones, a camera's eye, a grid over a floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError, parameter
from ..bake import geometry

HEIGHT = 0.85
"""[m] over the floor: a desk's, EN 17037 and EN 12464-1."""

BORDER = 0.5
"""[m] along walls that EN 17037 and EN 12464-1 leave out."""

LARGEST = 10.0
"""[m] between points at most, EN 12464-1."""

MOST = 20_000
"""Points of a grid."""


@dataclass(frozen=True)
class Places:
    """Meters at ``points`` (n, 3), in Blender units, that look along unit ``normals`` (n, 3).

    Of a grid ``shape`` is (rows, columns) from the lower left, and ``cells`` (n,) says which of
    them each point is; None of single meters. ``spacing`` (2,): between columns, and rows.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    shape: tuple[int, int] | None = None
    cells: NDArray[np.int64] | None = None
    spacing: tuple[float, float] = (0.0, 0.0)

    def __len__(self) -> int:
        return len(self.points)


def single(points: ArrayLike, normals: ArrayLike) -> Places:
    """Return meters at points (n, 3) that look along normals (n, 3) of any length.

    Raises InputError for numbers that are not finite and for a normal without length.
    """
    at, ways = (np.asarray(each, dtype=float).reshape(-1, 3) for each in (points, normals))
    if not np.isfinite(at).all():
        raise InputError(parameter("at"), "is not finite", "give three numbers X,Y,Z")
    length = np.linalg.norm(ways, axis=1)
    if not (np.isfinite(length) & (length > 0.0)).all():
        raise InputError(parameter("normal"), "has no direction", "give one such as 0,0,1")
    return Places(at, ways / length[:, None])


def eye(camera: bpy.types.Object) -> Places:
    """Return the meter of a camera's eye: upright, and turned as the camera looks.

    The illuminance is then the vertical one at the eye. A camera that looks up or down within 10°
    is taken as it looks.
    """
    matrix = np.array(camera.matrix_world)
    way = -matrix[:3, 2]
    way = way / max(np.linalg.norm(way), 1e-12)
    level = np.array([way[0], way[1], 0.0])
    upright = np.linalg.norm(level) > np.sin(np.radians(10.0))
    return single(matrix[:3, 3], level if upright else way)


def camera(scene: bpy.types.Scene, name: str | None) -> bpy.types.Object:
    """Return a scene's camera of a name, or its active one; raises InputError without."""
    if not name:
        if scene.camera is None:
            raise InputError(parameter("camera"), "the scene has none", "add a camera")
        return scene.camera
    found = scene.objects.get(name)
    if found is None or found.type != "CAMERA":
        names = ", ".join(f"'{each.name}'" for each in scene.objects if each.type == "CAMERA")
        raise InputError(
            parameter("camera"), f"there is no camera '{name}'", f"there are {names or 'none'}"
        )
    return found


def rectangle(
    corners: Sequence[float], height: float, spacing: float | None, meter: float
) -> Places:
    """Return meters that look up over x0, y0, x1, y1 at the height z, all in Blender units.

    ``spacing`` [m]: None as EN 12464-1 has it for such a size; ``meter``: Blender units in one.
    Raises InputError for a rectangle without size and for too many points.
    """
    x0, y0, x1, y1 = corners
    x0, x1, y0, y1 = min(x0, x1), max(x0, x1), min(y0, y1), max(y0, y1)
    if not np.isfinite([*corners, height]).all() or x0 == x1 or y0 == y1:
        raise InputError(parameter("grid"), "has no size", "give X0,Y0,X1,Y1 or a floor's name")
    size = np.array([x1 - x0, y1 - y0])
    step = _spacing(size / meter, spacing) * meter
    columns, rows = np.maximum(np.ceil(size / step - 1e-9), 1.0)
    if columns * rows > MOST:
        raise InputError(
            parameter("spacing"), f"makes {columns * rows:,.0f} points", f"at most {MOST:,}"
        )
    dx, dy = size[0] / columns, size[1] / rows
    y, x = np.meshgrid(
        y0 + dy * (np.arange(rows) + 0.5), x0 + dx * (np.arange(columns) + 0.5), indexing="ij"
    )
    points = np.stack([x, y, np.full_like(x, height)], axis=-1).reshape(-1, 3)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    return Places(points, up, x.shape, np.arange(len(points)), (float(dx), float(dy)))


def over(
    floor: bpy.types.Object,
    height: float = HEIGHT,
    spacing: float | None = None,
    border: float = BORDER,
    meter: float = 1.0,
) -> Places:
    """Return meters that look up over the faces of an object that do, but for a border.

    ``height``, ``spacing`` and ``border`` [m]; ``meter``: Blender units in one. Raises InputError
    for an object without such faces, and where the border leaves none.
    """
    triangles = _floor(floor)
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    grid = rectangle((*low[:2], *high[:2]), 0.0, spacing, meter)
    z = _heights(triangles, grid.points[:, :2])
    kept = np.isfinite(z)
    around = np.arange(8) * np.pi / 4.0
    for way in np.stack([np.cos(around), np.sin(around)], axis=1):
        kept &= np.isfinite(_heights(triangles, grid.points[:, :2] + way * border * meter))
    if not kept.any():
        cure = "give a smaller border or spacing"
        raise InputError(f'object "{floor.name}"', "is smaller than its border", cure)
    points = grid.points[kept]
    points[:, 2] = z[kept] + height * meter
    return Places(points, grid.normals[kept], grid.shape, np.flatnonzero(kept), grid.spacing)


def units_in_a_meter(scene: bpy.types.Scene) -> float:
    """How many Blender units are one meter in a scene."""
    settings = scene.unit_settings
    return 1.0 if settings.system == "NONE" else 1.0 / max(settings.scale_length, 1e-9)


def _spacing(size: NDArray, spacing: float | None) -> float:
    """[m]; EN 12464-1: 0.2 · 5^log10(d), d the longer side, or the shorter of a narrow field."""
    if spacing is not None:
        if not (np.isfinite(spacing) and spacing > 0.0):
            raise InputError(parameter("spacing"), f"{spacing:g} m", "give a number above 0")
        return spacing
    d = size.max() if size.max() < 2.0 * size.min() else size.min()
    return float(min(0.2 * 5.0 ** np.log10(max(d, 1e-3)), LARGEST))


def _floor(floor: bpy.types.Object) -> NDArray[np.float64]:
    """The triangles (n, 3, 3) of an object, in the world, that look up within 30°."""
    shown = floor.evaluated_get(bpy.context.evaluated_depsgraph_get())
    found = np.empty((0, 3, 3))
    if shown.type == "MESH":
        triangles, *_ = geometry.triangles_of(shown)
        matrix = np.array(floor.matrix_world)
        found = triangles @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            found = found[:, ::-1]
        across = np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
        length = np.linalg.norm(across, axis=1)
        found = found[across[:, 2] > np.cos(np.radians(30.0)) * np.maximum(length, 1e-30)]
    if not len(found):
        place = f'object "{floor.name}"'
        raise InputError(place, "has no faces that look up", "choose the floor of a room")
    return found


def _heights(triangles: NDArray, points: NDArray) -> NDArray[np.float64]:
    """How high the uppermost triangle stands over or under points (n, 2); NaN beside all."""
    result = np.full(len(points), -np.inf)
    for a, b, c in triangles:
        (ux, uy), (vx, vy) = (b - a)[:2], (c - a)[:2]
        area = ux * vy - uy * vx
        if area <= 0.0:
            continue
        px, py = (points - a[:2]).T
        s, t = (px * vy - py * vx) / area, (ux * py - uy * px) / area
        inside = (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1.0 + 1e-9)
        z = a[2] + s * (b - a)[2] + t * (c - a)[2]
        result[inside] = np.maximum(result[inside], z[inside])
    return np.where(np.isfinite(result), result, np.nan)
