"""The spectra of an OpenEXR file unpacked: by NumPy where that is simple, else a few at a time.

Blender shows three channels of a picture at most, and each time unpacks them all. What most
programs write, scanlines packed by ZIP or not at all, is unpacked here.
"""

from __future__ import annotations

import struct
import tempfile
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from .exr_file import Decode, decode_by_openexr, overlap, packed_unknown, window_of
from .exr_header import COMPRESSIONS, Channel, Part, block_places
from .exr_plain import plain_names, write_plain
from .file_claims import check_shape, check_size
from .spectral_layout import SpectralLayout
from .spectral_panorama import check_amount

_SIMPLE = {"NONE", "ZIPS", "ZIP"}


def read_spectra(
    path: Path, size: int, layout: SpectralLayout, decode: Decode = decode_by_openexr
) -> NDArray[np.float32]:
    """Return the samples (h, 2 h, n) of spectra in an OpenEXR file of ``size`` bytes.

    Row 0 is at the top; black where no pixels are. Raises `InputError` as `exr_file.read_exr` does,
    and for more than can be read at once.
    """
    part, count = layout.part, len(layout.channels)
    left, top, right, bottom = window = window_of(part.data_window, part.display_window)
    width, height = right - left + 1, bottom - top + 1
    check_shape(path, width, height)
    check_size(path, (width, height), max(part.decoded, 4 * count * width * height), size)
    check_amount(path, (width, height), count)
    with path.open("rb") as file:
        places = block_places(file, size, part, path)
        with packed_unknown(path, part):
            if _is_simple(part):
                samples = _unpacked(file, part, places, layout.channels)
            else:
                samples = _decoded(file, part, places, layout.channels, decode)
    if part.data_window == window:
        return samples
    whole = np.zeros((height, width, count), np.float32)
    across, down = overlap(part.data_window, window)
    if across and down:
        x, y, _, _ = part.data_window
        there = samples[down.start - y : down.stop - y, across.start - x : across.stop - x]
        whole[down.start - top : down.stop - top, across.start - left : across.stop - left] = there
    return whole


def _is_simple(part: Part) -> bool:
    packing = COMPRESSIONS.get(part.compression, ("",))[0]
    whole = all(channel.sampling == (1, 1) for channel in part.channels)
    return packing in _SIMPLE and not part.tiles and whole


def _unpacked(
    file: BinaryIO, part: Part, places: list[tuple[int, int]], channels: tuple[Channel, ...]
) -> NDArray[np.float32]:
    """Unpack channels of all blocks; raises ValueError or zlib.error for damaged ones."""
    left, top, right, bottom = part.data_window
    width, height = right - left + 1, bottom - top + 1
    lines = COMPRESSIONS[part.compression][1]
    starts, line = {}, 0
    for channel in part.channels:
        starts[channel.name] = line
        line += width * (2 if channel.kind == 1 else 4)
    samples = np.empty((height, width, len(channels)), np.float32)
    filled = np.zeros(height, bool)
    for start, end in places:
        file.seek(start + part.leader - 8)
        y = struct.unpack("<i", file.read(4))[0] - top
        if not 0 <= y < height or y % lines:
            raise ValueError(f"a block stands at line {y}")
        rows = min(lines, height - y)
        file.seek(start + part.leader)
        block = _plain(file.read(end - start - part.leader), rows * line).reshape(rows, line)
        for k, channel in enumerate(channels):
            kind = "<f2" if channel.kind == 1 else "<f4"
            first = starts[channel.name]
            stop = first + width * (2 if channel.kind == 1 else 4)
            values = np.ascontiguousarray(block[:, first:stop]).view(kind)
            samples[y : y + rows, :, k] = values
        filled[y : y + rows] = True
    if not filled.all():
        raise ValueError(f"line {int(np.argmin(filled))} is missing")
    return samples


def _plain(packed: bytes, length: int) -> NDArray[np.uint8]:
    """Undo ZIP: steps from byte to byte, and bytes of even and odd places apart."""
    if len(packed) == length:  # what does not get smaller is stored as it is
        return np.frombuffer(packed, np.uint8)
    unpacking = zlib.decompressobj()
    steps = np.frombuffer(unpacking.decompress(packed, length + 1), np.uint8)
    if steps.size != length or not unpacking.eof:  # at its end the sum is checked
        raise ValueError(f"a block does not unpack to {length} bytes")
    values = np.cumsum(steps, dtype=np.uint8)
    values[1::2] -= np.uint8(128)  # each step is stored with 128 added
    block = np.empty(length, np.uint8)
    half = (length + 1) // 2
    block[0::2], block[1::2] = values[:half], values[half:]
    return block


def _decoded(
    file: BinaryIO,
    part: Part,
    places: list[tuple[int, int]],
    channels: tuple[Channel, ...],
    decode: Decode,
) -> NDArray[np.float32]:
    """Have channels unpacked, each three as red, green and blue of a plain file."""
    left, top, right, bottom = part.data_window
    samples = np.empty((bottom - top + 1, right - left + 1, len(channels)), np.float32)
    order = {channel.name: k for k, channel in enumerate(channels)}
    left_over = [channel for channel in part.channels if channel.name in order]
    with tempfile.TemporaryDirectory(prefix="skylight-") as folder:
        copy = Path(folder) / "plain.exr"
        while left_over:
            count = 3 if len(left_over) > 2 else 1
            some, left_over = tuple(left_over[:count]), left_over[count:]
            names = plain_names(part, some)
            with copy.open("wb") as target:
                write_plain(file, part, places, names, target)
            planes = decode(copy, tuple(names[channel.name] for channel in some))
            for k, channel in enumerate(some):
                samples[..., order[channel.name]] = planes[..., k]
    return samples
