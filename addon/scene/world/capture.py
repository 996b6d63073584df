"""Any World as a lat-long panorama: rendered once by Cycles, in a scene that is thrown away.

The World itself is never touched: a copy is rendered (`world_copy`).
"""

from __future__ import annotations

import contextlib
import math
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...spectra.working_spaces import LUMINANCE
from ..blend_data import fingerprint, nodes, working_space
from ..files.exr_decoder import decode_by_blender
from . import diffuse_copy, sky_texture
from . import hdri as worlds

HEIGHT = 256
HIGHEST = 1024
RAYS = 16 * 512 * 256
"""Of the whole panorama: fewer a pixel where there are more pixels."""
SPOT = 8  # pixels of the side of a window that is looked at again, for the sun's disc is smaller …
FINER = 16  # … than one; so much finer, by
SPOT_SAMPLES = 16  # rays for each of its pixels

_KEPT = 4
_baked: dict[str, NDArray[np.float32]] = {}  # by content: the last few


def bake(world: bpy.types.World, sky: worlds.WorldSky) -> tuple[NDArray[np.float32], int | None]:
    """The light of a World (h, 2 h, 3), row 0 at the zenith, and its frame if it is animated.

    In the file's working space, without what is followed live (`hdri.WorldSky`). Nothing of the
    file changes; equal content is baked once a session. Raises InputError for a missing image and
    where Cycles cannot render.
    """
    scenes = [scene for scene in bpy.data.scenes if scene.world == world]
    scene = bpy.context.scene if bpy.context.scene in scenes else next(iter(scenes), None)
    scene = scene or bpy.context.scene
    frame = scene.frame_current if fingerprint.moves(world) else None
    with diffuse_copy.as_diffuse_sees(world, sky) as copy:
        output = worlds.output_of(copy)
        height = _height(world, output)
        tree, plain = (copy.node_tree, None) if output else (None, list(copy.color))
        key = fingerprint.key(tree, plain, frame, working_space.name(), height)
        if key not in _baked:
            _baked[key] = _render(copy, scene, height, _spots(output))
            while len(_baked) > _KEPT:
                del _baked[next(iter(_baked))]
    return _baked[key].copy(), frame


def _height(world: bpy.types.World, output: bpy.types.Node | None) -> int:
    """Rows that hold the World's detail: an image's own where it is finer. Checks the images."""
    rows = [HEIGHT]
    for node in nodes.feeding(output) if output else ():
        if node.type not in ("TEX_ENVIRONMENT", "TEX_IMAGE"):
            continue
        place, image = f'World "{world.name}"', node.image
        if image is None:
            raise InputError(place, f'"{node.name}" has no image', "open a sky HDRI in it")
        if 0 in image.size and image.type == "MULTILAYER":  # asking makes Blender load the file
            continue  # of several layers Blender says no size
        if image.source == "FILE" and 0 in image.size:
            file = bpy.path.abspath(image.filepath, library=image.library)
            what = f'image "{image.name}" cannot be read from "{file}"'
            raise InputError(place, what, "restore or pack the file")
        rows.append(image.size[1])
    return min(max(rows), HIGHEST)


def _spots(output: bpy.types.Node | None) -> list[tuple[float, float, float]]:
    return list(sky_texture.suns(output)) if output else []


def _render(
    world: bpy.types.World,
    like: bpy.types.Scene,
    height: int,
    spots: list[tuple[float, float, float]],
) -> NDArray[np.float32]:
    """Render a World; the spots that are told, else its brightest, finer than a pixel."""
    with _throw_away(world, like) as scene, tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sky.exr"
        rgb = _shot(scene, path, height, max(1, round(RAYS / (2 * height * height))))
        upper = rgb[: height // 2 + 1] @ LUMINANCE.astype(np.float32)
        places = [divmod(int(np.argmax(upper)), 2 * height)]
        if spots or upper.max() < 10.0 * upper.mean():
            places = []
        for x, y, z in spots:
            elevation = math.atan2(z, math.hypot(x, y)) / math.pi
            azimuth = math.atan2(y, x) / (2.0 * math.pi)
            places.append((int((0.5 - elevation) * height), int((0.5 - azimuth) * 2 * height)))
        for row, column in places:
            top = min(max(row - SPOT // 2, 0), height - SPOT)
            left = min(max(column - SPOT // 2, 0), 2 * height - SPOT)
            window = _shot(scene, path, FINER * height, SPOT_SAMPLES, (top, left))
            means = window.reshape(SPOT, FINER, SPOT, FINER, 3).mean(axis=(1, 3), dtype=np.float64)
            rgb[top : top + SPOT, left : left + SPOT] = means
    return rgb


def _shot(
    scene: bpy.types.Scene,
    path: Path,
    height: int,
    samples: int,
    window: tuple[int, int] | None = None,
) -> NDArray[np.float32]:
    """Render a panorama of so many rows, or of a finer one the window at a coarse (row, column)."""
    scene.render.resolution_x, scene.render.resolution_y = 2 * height, height
    scene.cycles.samples = samples
    scene.render.use_border = scene.render.use_crop_to_border = window is not None
    if window is not None:
        coarse = height // FINER
        top, left = window
        scene.render.border_min_x = left / (2 * coarse)
        scene.render.border_max_x = (left + SPOT) / (2 * coarse)
        scene.render.border_min_y = 1.0 - (top + SPOT) / coarse
        scene.render.border_max_y = 1.0 - top / coarse
    scene.render.filepath = str(path)
    try:
        done = bpy.ops.render.render(scene=scene.name, write_still=True)
    except RuntimeError as error:
        done, reason = set(), str(error).strip().splitlines()[-1]
    else:
        reason = "it was cancelled, or Blender is rendering something else"
    if "FINISHED" not in done or not path.is_file():
        raise InputError(f'World "{scene.world.name}"', f"cannot be baked ({reason})", "try again")
    rgb = decode_by_blender(path, ("R", "G", "B"))
    path.unlink()
    return rgb


@contextlib.contextmanager
def _throw_away(world: bpy.types.World, like: bpy.types.Scene) -> Iterator[bpy.types.Scene]:
    """A scene of its own to render a World in, at another scene's frame; gone afterwards."""
    had_result = "Render Result" in bpy.data.images
    scene = bpy.data.scenes.new("Skylight Bake")
    camera = bpy.data.cameras.new("Skylight Bake")
    eye = bpy.data.objects.new("Skylight Bake", camera)
    try:
        scene.world = world
        scene.frame_start, scene.frame_end = like.frame_start, like.frame_end
        scene.frame_current, scene.frame_subframe = like.frame_current, like.frame_subframe
        scene.collection.objects.link(eye)
        scene.camera = eye
        eye.rotation_euler = (math.pi / 2.0, 0.0, -math.pi / 2.0)
        camera.type = "PANO"
        try:
            scene.render.engine = "CYCLES"
        except TypeError as error:
            what = "can be baked by Cycles alone"
            raise InputError(f'World "{world.name}"', what, "enable that add-on") from error
        lens: Any = camera if hasattr(camera, "panorama_type") else camera.cycles  # before 5.0
        lens.panorama_type = "EQUIRECTANGULAR"
        _set(scene, like)
        with _no_handlers():
            yield scene
    finally:
        bpy.data.batch_remove([scene, eye, camera])
        result = bpy.data.images.get("Render Result")
        if result is not None and not had_result:
            bpy.data.images.remove(result)


def _set(scene: bpy.types.Scene, like: bpy.types.Scene) -> None:
    """The numbers as they are: no filter, limit, denoising or view transform."""
    cycles = scene.cycles
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type = "BOX"
    cycles.shading_system = like.cycles.shading_system
    scene.render.use_compositing = scene.render.use_sequencer = False
    picture = scene.render.image_settings
    if hasattr(picture, "media_type"):
        picture.media_type = "IMAGE"
    picture.file_format, picture.color_depth, picture.color_mode = "OPEN_EXR", "32", "RGB"
    picture.exr_codec = "NONE"


@contextlib.contextmanager
def _no_handlers() -> Iterator[None]:
    """Others' scripts that run on renders and frames are for the user's scenes."""
    handlers: dict[str, Any] = {
        name: getattr(bpy.app.handlers, name)
        for name in dir(bpy.app.handlers)
        if name.startswith(("render_", "frame_change_", "depsgraph_update_"))
    }
    kept = {name: list(found) for name, found in handlers.items()}
    try:
        for found in handlers.values():
            found.clear()
        yield
    finally:
        for name, found in handlers.items():
            found[:] = kept[name]
