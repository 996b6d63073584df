"""Radiance pictures (``.hdr``, RGBE): the header and the three ways its scanlines are packed.

G. Ward, "Real Pixels", Graphics Gems II, 1991, and the file format's description in
https://radsite.lbl.gov/radiance/refer/filefmts.pdf. Values are mantissa times power of two
without Ward's half step, which is how Blender reads them, so both see the same sky.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .exr_layers import shown
from .file_claims import check_shape, check_size

# ldexp(1, e - 136) by exponent byte; e = 0 means black.
_SCALE = np.ldexp(np.float32(1), np.arange(256) - 136).astype(np.float32)
_SCALE[0] = 0.0

# What a code byte of the new run-length packing does: over 128 a run of one repeated byte, else
# that many bytes as they stand.
_CODE = np.arange(256)
_COUNT = np.where(_CODE > 128, _CODE & 127, _CODE)
_ADVANCE = np.where(_CODE > 128, 2, _CODE + 1)

# Scanlines are unpacked in bands: the taller, the quicker, at up to some 200 bytes a pixel of band.
_BANDS = 64
_PIXELS_AT_ONCE = 1 << 17

SPECTRA = "Radiance_spectra"
"""The format of pictures of spectra, see `radiance_hsr`."""

_HEADER = 1 << 16  # bytes: a longer one is none


def read_radiance(path: Path) -> tuple[NDArray[np.float32], dict[str, object]]:
    """Read a Radiance picture, (h, w, 3) with row 0 at the top, and its header.

    Values are as stored: nothing that the header says of them is applied (nor does Blender). Of an
    entry that stands there several times the header holds a tuple.

    Raises
    ------
    InputError
        When the header is damaged, the colours are XYZ, the picture stands on its side or is not
        2:1, or scanlines are missing or damaged (the error names the first).
    """
    data = path.read_bytes()
    height, width, flip_y, flip_x, header, start = parse_header(path, data)
    _check_rgb(header, path)
    check_size(path, (width, height), 12 * width * height, len(data))
    rgb = np.empty((height, width, 3), np.float32)
    rows = max(1, height // _BANDS, _PIXELS_AT_ONCE // width)
    packed = data[start : start + 4]
    # Only widths that fit the line's own header can be packed the new way.
    new = packed[:2] == b"\2\2" and 8 <= width < 32768 and packed[2:3] < b"\x80"
    for row in range(0, height, rows):
        count = min(rows, height - row)
        unpack = _unpack_new if new else _unpack_old
        rgbe, start = unpack(data, start, count, width)
        if len(rgbe) < count:
            raise InputError(
                path,
                f"scanline {row + len(rgbe) + 1} of {height} is cut short or damaged",
                "copy or download the file again",
            )
        np.multiply(rgbe[..., :3], _SCALE[rgbe[..., 3]][..., None], out=rgb[row : row + count])
    return rgb[:: -1 if flip_y else 1, :: -1 if flip_x else 1], header


def read_radiance_header(file: BinaryIO, size: int, place: object) -> dict[str, object]:
    """Return the header of an open file of ``size`` bytes, of RGB or of spectra.

    Raises `InputError` if it is damaged.
    """
    header = parse_header(place, file.read(_HEADER))[4]
    if header.get("FORMAT") != SPECTRA:
        _check_rgb(header, place)
    return header


def is_spectral(path: Path) -> bool:
    """Return whether a Radiance picture says that it holds spectra."""
    with path.open("rb") as file:
        start = file.read(_HEADER).partition(b"\n\n")[0]
    return re.search(rb"^FORMAT=\s*%s\s*$" % SPECTRA.encode(), start, re.MULTILINE) is not None


def _check_rgb(header: dict[str, object], place: object) -> None:
    if header.get("FORMAT", "32-bit_rle_rgbe") != "32-bit_rle_rgbe":
        raise InputError(
            place, f"holds {shown([str(header['FORMAT'])])}, not RGB", "convert it with ra_xyze -r"
        )


def parse_header(path: object, data: bytes) -> tuple[int, int, bool, bool, dict[str, object], int]:
    """Return height, width, whether to flip each, the header's variables and its length.

    Raises `InputError` for one that is damaged, and for a picture on its side or not 2:1.
    """
    size = re.compile(rb"\n([-+])Y +(\d{1,6}) +([-+])X +(\d{1,6})\n").search(data, 0, _HEADER)
    if not size:
        sideways = re.compile(rb"\n[-+]X +\d+ +[-+]Y +\d+\n").search(data, 0, _HEADER)
        problem = (
            "is stored rotated or mirrored" if sideways else "has no resolution line in its header"
        )
        raise InputError(path, problem, "save it again as an upright lat-long .hdr or .exr")
    header: dict[str, object] = {}
    for line in data[: size.start()].decode("latin-1").splitlines()[1:]:
        name, equals, value = line.partition("=")
        if equals and not line.startswith("#"):
            name, before = name.strip(), header.get(name.strip())
            several = before if isinstance(before, tuple) else () if before is None else (before,)
            header[name] = (*several, value.strip()) if several else value.strip()
    y, height, x, width = size[1], int(size[2]), size[3], int(size[4])
    check_shape(path, width, height)
    return height, width, y == b"+", x == b"-", header, size.end()


def _unpack_new(data: bytes, start: int, rows: int, width: int) -> tuple[NDArray[np.uint8], int]:
    """Unpack up to `rows` run-length coded scanlines, (k, width, 4), and say where they end.

    All lines are walked in step, one code a step. Where a line begins is known only once the one
    before it is walked, but each begins with the same four bytes: every place that holds them is
    walked, and those that no line leads to are dropped.
    """
    magic = bytes([2, 2, width >> 8, width & 255])
    done: list[NDArray[np.uint8]] = []
    most = rows  # places to walk at once: fewer where many of them led nowhere
    while len(done) < rows:
        begins, place = [], start
        while len(begins) < min(most, rows - len(done)) and (place := data.find(magic, place)) >= 0:
            begins.append(place)
            place += 1
        if not begins or begins[0] != start:
            break
        window = np.frombuffer(data, np.uint8, offset=start)
        lines, ends = _walk(window, np.array(begins) - start + 4, width)
        known = {begin: lane for lane, begin in enumerate(begins)}
        chain = []
        while (lane := known.get(start)) is not None and ends[lane] > 0:
            chain.append(lane)
            start = begins[0] + int(ends[lane])
        if not chain:
            break
        done.extend(lines[chain])
        most = 2 * len(chain) + 1
    stacked = np.array(done, np.uint8).reshape(-1, 4, width)
    return stacked.transpose(0, 2, 1), start


def _walk(
    data: NDArray[np.uint8], places: NDArray[np.int64], width: int
) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
    """Unpack the scanlines whose codes begin at `places`, (k, 4 * width); a bad one ends at -1."""
    total = 4 * width
    place, filled = places.copy(), np.zeros_like(places)
    good = np.ones(len(places), bool)
    walked, counts = [], []
    while (active := good & (filled < total)).any():
        good &= ~active | (place < len(data) - 1)  # every code is followed by at least one byte
        code = data[np.where(active & good, place, 0)]
        count = np.where(active & good, _COUNT[code], 0)
        # A count of 0 would never end; a run across two components is as damaged as one past
        # the line.
        good &= ~active | ((count > 0) & (filled // width == (filled + count - 1) // width))
        count[~good] = 0
        walked.append(place.copy())
        counts.append(count)
        place += np.where(count > 0, _ADVANCE[code], 0)
        filled += count
    good &= place <= len(data)
    counts_by_line = np.array(counts).T
    counts_by_line[~good] = 0
    used = counts_by_line > 0
    count, source = counts_by_line[used], np.array(walked).T[used] + 1
    literal = data[source - 1] <= 128
    first = np.cumsum(count) - count
    index = np.repeat(source - first * literal, count)
    index += np.repeat(literal, count) * np.arange(len(index))
    lines = np.zeros((len(places), total), np.uint8)
    lines[good] = data[index].reshape(-1, total)
    return lines, np.where(good, place, -1)


def _unpack_old(data: bytes, start: int, rows: int, width: int) -> tuple[NDArray[np.uint8], int]:
    """Unpack up to `rows` scanlines of plain pixels, where (1, 1, 1, n) repeats the last n times.

    Repeats in a row count higher digits: the second is worth n << 8.
    """
    done = np.empty((rows, width, 4), np.uint8)
    for row in range(rows):
        # A line takes no more than `width` entries, for a repeat of 0 is only ever a low digit.
        available = min(width, (len(data) - start) // 4)
        entries = np.frombuffer(data, np.uint8, 4 * available, start).reshape(-1, 4)
        repeats = (entries[:, :3] == 1).all(axis=1)
        order = np.arange(available)
        last = np.maximum.accumulate(np.where(repeats, -1, order))
        digit = np.minimum(order - last - 1, 3)
        count = np.where(repeats, entries[:, 3].astype(np.int64) << 8 * np.maximum(digit, 0), 1)
        total = np.cumsum(count)
        used = int(np.searchsorted(total, width)) + 1
        if used > available or total[used - 1] != width or repeats[0]:
            return done[:row], start
        done[row] = entries[np.repeat(last[:used], count[:used])]
        start += 4 * used
    return done, start
