"""Unpacking OpenEXR: by Blender inside Blender, whose Python has no OpenEXR, else by OpenEXR."""

from __future__ import annotations

import contextlib
import sys
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...progress import on_main
from ...sky.exr_file import Decode, decode_by_openexr, quiet, read_exr
from ...sky.panorama import Panorama, read_panorama

_PLACES = {"R": 0, "G": 1, "B": 2, "X": 0, "Y": 1, "Z": 2}
"""Where Blender puts a channel; a lone Y it puts everywhere, and converts none."""


def read_sky(path: str | Path, raw: bool = False) -> Panorama:
    """Read a sky file as `sky.panorama.read_panorama` does, in Blender and outside."""
    return read_panorama(path, raw, decoder())


def decoder() -> Decode:
    """Return what unpacks OpenEXR in this process."""
    return decode_by_blender if "bpy" in sys.modules else decode_by_openexr


def decode_by_blender(path: Path, names: tuple[str, ...]) -> NDArray[np.float32]:
    """Unpack channels R, G, B, or X, Y, Z of a plain file by Blender, (h, w, k), top row first.

    The numbers are those of the file to the last bit, float32: tagged Non-Color none is converted.
    Channels that keep other names (`sky.exr_plain`) are a layer that Blender has to take out.
    Raises ValueError where Blender cannot unpack them.
    """
    if not {*names} <= _PLACES.keys():
        return on_main(partial(_combined, path, names))
    pixels = on_main(partial(_loaded, path))[::-1]
    if pixels.shape[2] == 1:
        return np.ascontiguousarray(pixels)
    return np.ascontiguousarray(pixels[..., [_PLACES[name] for name in names]])


def _loaded(path: Path) -> NDArray[np.float32]:
    """The numbers of a plain file, (h, w, k), bottom row first."""
    import bpy

    with quiet():
        image = bpy.data.images.load(str(path))
        try:
            image.colorspace_settings.name = "Non-Color"
            width, height = image.size  # asking makes Blender load the file
            if not (width and height and image.is_float):
                raise ValueError(f"Blender {bpy.app.version_string} cannot unpack it")
            pixels = np.empty(width * height * image.channels, np.float32)
            image.pixels.foreach_get(pixels)
            return pixels.reshape(height, width, image.channels)
        finally:
            bpy.data.images.remove(image)


def _combined(path: Path, names: tuple[str, ...]) -> NDArray[np.float32]:
    """Unpack a layer of several by having Blender save it anew, packed in a way that is simple."""
    import bpy

    with tempfile.TemporaryDirectory(prefix="skylight-") as folder, quiet():
        copy = Path(folder) / "layers.exr"
        scene = bpy.data.scenes.new("Skylight Layers")
        image = bpy.data.images.load(str(path))
        try:
            settings = scene.render.image_settings
            if hasattr(settings, "media_type"):
                settings.media_type = "MULTI_LAYER_IMAGE"
            settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
            settings.exr_codec = "ZIP"
            if 0 in image.size[:] and image.type == "MULTILAYER":  # asking makes Blender load it
                image.save_render(str(copy), scene=scene)
        finally:
            bpy.data.batch_remove([image, scene])
        with contextlib.suppress(InputError, OSError):  # what Blender saved is something else
            pixels, header = read_exr(copy, copy.stat().st_size, decode_by_blender)
            if header["layer"] == names[0].rpartition(".")[0] and header["channels"] == "RGB":
                return pixels
    raise ValueError("Blender cannot tell its layers apart")
