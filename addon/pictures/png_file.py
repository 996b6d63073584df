"""Pictures for people to look at: PNG with nothing but Python's own zlib.

Blender's Python brings no writer that works without a file open, and its users no matplotlib.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..whole_files import writing


def write_png(path: str | Path, rgb: NDArray[np.uint8]) -> None:
    """Write sRGB pixels, (h, w, 3) uint8, row 0 at the top.

    PNG, third edition (https://www.w3.org/TR/png-3); whole or not at all. Raises `InputError`
    when the place cannot be written to.
    """
    height, width, _ = rgb.shape
    filter_none = np.zeros((height, 1), np.uint8)
    rows = np.hstack([filter_none, np.ascontiguousarray(rgb, np.uint8).reshape(height, -1)])
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b""))
    content = b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )
    with writing(path) as part:
        part.write_bytes(content)
