"""Unpacking OpenEXR: by Blender inside Blender, whose Python has no OpenEXR, else by OpenEXR."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...sky.exr_file import Decode, decode_by_openexr
from ...sky.panorama import Panorama, read_panorama

_PLACES = {"R": 0, "G": 1, "B": 2, "Y": 0}


def read_sky(path: str | Path, raw: bool = False) -> Panorama:
    """Read a sky file as `sky.panorama.read_panorama` does, in Blender and outside."""
    return read_panorama(path, raw, decoder())


def decoder() -> Decode:
    """Return what unpacks OpenEXR in this process."""
    return decode_by_blender if "bpy" in sys.modules else decode_by_openexr


def decode_by_blender(path: Path, names: tuple[str, ...]) -> NDArray[np.float32]:
    """Unpack channels R, G, B or Y of a plain file by Blender, (h, w, k) float32, top row first.

    The numbers are those of the file to the last bit: tagged Non-Color nothing is converted.
    Raises ValueError where Blender cannot unpack them.
    """
    import bpy

    if not {*names} <= _PLACES.keys():
        raise ValueError("Blender cannot tell its layers apart")
    with _quiet():
        image = bpy.data.images.load(str(path))
        try:
            image.colorspace_settings.name = "Non-Color"
            width, height = image.size  # asking makes Blender load the file
            if not (width and height and image.is_float):
                raise ValueError(f"Blender {bpy.app.version_string} cannot unpack it")
            pixels = np.empty(width * height * image.channels, np.float32)
            image.pixels.foreach_get(pixels)
            pixels = pixels.reshape(height, width, image.channels)[::-1]
        finally:
            bpy.data.images.remove(image)
    if pixels.shape[2] == 1:
        return np.ascontiguousarray(pixels)
    return np.ascontiguousarray(pixels[..., [_PLACES[name] for name in names]])


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep off the terminal what Blender prints of each damaged block: the error says it once."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError, ValueError):  # a Blender that has no terminal
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            nothing = stack.enter_context(open(os.devnull, "wb"))  # noqa: PTH123 - no path
            for number in (1, 2):
                kept = os.dup(number)
                stack.callback(os.close, kept)
                stack.callback(os.dup2, kept, number)
                os.dup2(nothing.fileno(), number)
        yield
