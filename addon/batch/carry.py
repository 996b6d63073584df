"""Copies of a scene's images beside its prepared file, which travels without the scene's folder.

A scene may name any file as an image. What is no image stays where it is: the folder is sent to
others.
"""

from __future__ import annotations

import contextlib
import shutil
from pathlib import Path
from typing import Any

from ..atomic_file import replacing
from .file_names import file_names
from .study import file_hash

_STARTS = (
    b"\x89PNG\r\n\x1a\n",
    b"\xff\xd8\xff",  # JPEG
    b"II*\0", b"MM\0*", b"II+\0", b"MM\0+",  # TIFF, and that of over 4 GB
    b"v/1\x01",  # OpenEXR
    b"#?RADIANCE", b"#?RGBE",
    b"\0\0\0\x0cjP  \r\n", b"\xff\x4f\xff\x51",  # JPEG 2000
    b"8BPS\0\x01",  # Photoshop
    b"DDS |\0\0\0",
    b"SDPX", b"XPDS",
)  # fmt: skip
"""What files of images start with, where that is long enough to tell them from others."""


def carry(image: Any, folder: Path) -> str:
    """Put a copy of an image's file into a folder and let the image read that.

    Return a line where it is read from elsewhere; empty where it is not.
    """
    import bpy

    if not image.users or image.packed_files or not image.filepath:
        return ""
    path = Path(bpy.path.abspath(image.filepath, library=image.library))
    if image.source != "FILE" or image.library is not None:
        return f'image "{image.name}" is read from {path}' if image.source != "GENERATED" else ""
    if not _is_image(image, path):
        return f'image "{image.name}" is no image and not copied: {path}'
    name = f"{file_names([path.stem])[0]}.{file_hash(path)[:8]}{path.suffix[:16]}"
    copy = path if path.parent == folder else folder / name
    if not copy.is_file():
        with replacing(copy) as part:
            shutil.copyfile(path, part)
    with contextlib.suppress(ValueError):  # another drive of Windows
        image.filepath_raw = bpy.path.relpath(str(copy))
    return ""


def _is_image(image: Any, path: Path) -> bool:
    """Whether a file holds an image: by its start, else by whether Blender can read it."""
    with path.open("rb") as file:
        start = file.read(16)
    if start.startswith(_STARTS) or (start[:4] == b"RIFF" and start[8:12] == b"WEBP"):
        return True
    return image.size[0] > 0 and image.size[1] > 0  # TGA, BMP and others, which have no such start
