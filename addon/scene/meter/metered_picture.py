"""A camera's picture of an amount of light: what falls on surfaces, or the luminance it sees.

Luminance is that of the rendered picture, with all that the engine shows. What falls on surfaces is
cast from the camera's pixels, for no picture of materials holds it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Generator
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...choices import QUANTITIES
from ...errors import InputError
from ...progress import Progress, mapped
from ...spectra.photometry import LUMINOUS_EFFICACY
from ...spectra.working_spaces import XYZ_to_working
from ..bake.light import SceneLight
from ..files.exr_decoder import decode_by_blender
from ..output import render_task
from . import calibration, lit_scene, surface_light
from .calibration import Calibration, Told

ROWS = 64
"""Lines of a picture at once: some hundred thousand rays."""


def picturing(
    scene: bpy.types.Scene,
    light: SceneLight,
    name: str,
    camera: bpy.types.Object,
    engine: str | None = None,
    told: Told | None = None,
) -> Generator[Progress, None, tuple[NDArray[np.float32], Calibration]]:
    """Return one of `choices.QUANTITIES` as a camera sees it, (h, w), yielding how far that is.

    In its unit, or relative, as the calibration says. NaN where a camera sees no surface; the size
    is that of the scene's renders. Raises InputError as `calibration.find` does, and for a
    panoramic camera.
    """
    assert scene.world is not None  # else it had no light
    known = calibration.find(scene.world, light, told)
    if name == "luminance":
        yield Progress(0.0, "rendering")
        return _luminance(scene, light, camera, engine, known.scale), known
    lit = yield from lit_scene.casting(light)
    found = yield from mapped(
        surface_light.measuring(lit, light, known), lambda p: Progress(0.8 * p.done, p.line)
    )
    width, height = render_task.size(scene)
    origins, ways = rays_of(camera, width, height)
    amounts = np.empty((height, width), np.float32)
    number = list(QUANTITIES).index(name)
    for row in range(0, height, ROWS):
        part = slice(row, min(row + ROWS, height))
        each = (ray[part].reshape(-1, 3) for ray in (origins, ways))
        amounts[part] = surface_light.seen(found, *each)[0][:, number].reshape(-1, width)
        yield Progress(0.8 + 0.2 * part.stop / height, "pixels")
    return amounts, known


def rays_of(
    camera: bpy.types.Object, width: int, height: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where rays of a camera's pixels start and their unit directions, (h, w, 3) each, in
    the world, the top row first. Raises InputError for a panoramic camera."""
    if camera.data.type not in ("PERSP", "ORTHO"):
        place = f'camera "{camera.name}"'
        raise InputError(place, "is panoramic", "use a perspective or orthographic camera")
    render = bpy.context.scene.render
    projection = camera.calc_matrix_camera(
        bpy.context.evaluated_depsgraph_get(),
        x=width,
        y=height,
        scale_x=render.pixel_aspect_x,
        scale_y=render.pixel_aspect_y,
    )
    return _unprojected(camera.matrix_world.normalized() @ projection.inverted(), width, height)


def _unprojected(
    to_world: Matrix, width: int, height: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    x = (np.arange(width) + 0.5) / width * 2.0 - 1.0
    y = 1.0 - (np.arange(height) + 0.5) / height * 2.0
    x, y = np.meshgrid(x, y)
    one = np.ones_like(x)
    ends = []
    for depth in (-1.0, 1.0):
        homogeneous = np.stack([x, y, depth * one, one], axis=-1) @ np.array(to_world).T
        ends.append(homogeneous[..., :3] / homogeneous[..., 3:])
    ways = ends[1] - ends[0]
    return ends[0], ways / np.linalg.norm(ways, axis=-1, keepdims=True)


def _luminance(scene, light: SceneLight, camera, engine, scale: float) -> NDArray[np.float32]:
    """The luminance (h, w) of a rendered picture."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        try:
            render_task.picture(scene, path, camera, engine)
            rgb = decode_by_blender(path, ("R", "G", "B"))
        except (ValueError, OSError, RuntimeError) as error:
            raise InputError("the picture", f"cannot be made ({error})", "render it") from error
    mapping = light.sources.transfer
    to_Y = np.linalg.inv(XYZ_to_working(mapping.space))[1] * mapping.neutral
    return (rgb @ (LUMINOUS_EFFICACY * scale * to_Y)).astype(np.float32)
