"""Writing OpenEXR: float32 scanlines, ZIP, whole or not at all; NumPy and Python alone.

https://openexr.com/en/latest/OpenEXRFileLayout.html. Needed inside Blender, which has no OpenEXR
for Python and saves neither channels nor attributes of one's own.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..whole_files import writing
from .exr_plain import pack_header

_LINES = 16  # of a block of ZIP
_LEVEL = 4  # of zlib, as OpenEXR's own: higher ones take longer for little


def write_exr(
    path: Path, channels: Mapping[str, NDArray[np.float32]], attributes: Mapping[str, Any]
) -> None:
    """Write an OpenEXR file, whole or not at all.

    Parameters
    ----------
    channels
        Planes (h, w) by name, or ``{"RGB": (h, w, 3)}``, float32.
    attributes
        Header entries: text, numbers, or (8,) ``chromaticities``.

    Raises
    ------
    InputError
        When the place cannot be written to; what stood there stays.
    """
    if set(channels) == {"RGB"}:
        channels = {letter: channels["RGB"][..., i] for i, letter in enumerate("RGB")}
    # Samples as their bytes, (h, channels, w, 4): in the order of names, as readers expect them.
    planes = [np.asarray(channels[name], "<f4") for name in sorted(channels)]
    height, width = planes[0].shape
    header = pack_header(_attributes(sorted(channels), width, height, attributes))
    count = -(-height // _LINES)
    place, table = len(header) + 8 * count, []
    with writing(path) as part, part.open("wb") as file:
        file.write(header + bytes(8 * count))
        for row in range(0, height, _LINES):
            rows = np.stack([plane[row : row + _LINES] for plane in planes], axis=1)
            block = _packed(rows.tobytes())
            table.append(place)
            place += 8 + len(block)
            file.write(struct.pack("<2i", row, len(block)) + block)
        file.seek(len(header))
        file.write(struct.pack(f"<{count}Q", *table))


def _packed(samples: bytes) -> bytes:
    """Pack one block: bytes of even and odd places apart, each as its step from the one before."""
    plain = np.frombuffer(samples, np.uint8)
    halves = np.concatenate([plain[0::2], plain[1::2]])
    steps = halves.copy()
    steps[1:] -= halves[:-1]
    steps[1:] += 128
    block = zlib.compress(steps.tobytes(), _LEVEL)
    return block if len(block) < len(samples) else samples


def _attributes(
    names: list[str], width: int, height: int, given: Mapping[str, Any]
) -> dict[str, tuple[str, bytes]]:
    channels = b"".join(name.encode() + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for name in names)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    found = {
        "channels": ("chlist", channels + b"\0"),
        "compression": ("compression", b"\3"),
        "dataWindow": ("box2i", window),
        "displayWindow": ("box2i", window),
        "lineOrder": ("lineOrder", b"\0"),
        "pixelAspectRatio": ("float", struct.pack("<f", 1.0)),
        "screenWindowCenter": ("v2f", bytes(8)),
        "screenWindowWidth": ("float", struct.pack("<f", 1.0)),
    }
    for name, value in given.items():
        if name in found:
            raise TypeError(f"{name} is not to be chosen")
        if isinstance(value, str):
            found[name] = ("string", value.encode())
        elif isinstance(value, int):
            found[name] = ("int", struct.pack("<i", value))
        elif isinstance(value, float):
            found[name] = ("float", struct.pack("<f", value))
        elif name == "chromaticities":
            found[name] = ("chromaticities", struct.pack("<8f", *value))
        else:
            raise TypeError(f"{name} is neither text nor number: {value!r}")
    return found
