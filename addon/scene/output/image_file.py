"""Files of pictures: whether they are whole, and without what tells one run from the next.

What Blender writes for `render_task`: EXR of 32 bits, ZIP, and PNG of 8 bits. By OpenEXR's file
layout (https://openexr.com/en/latest/OpenEXRFileLayout.html) and PNG, third edition
(https://www.w3.org/TR/png-3). A copy of this file lies beside each plan, so it imports nothing of
the package.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

CYCLES_STAMPS = b"cycles."
"""What Cycles notes of its own speed, which no setting turns off, starts with this."""

HEAD = 1 << 18
"""[bytes] Of a file: its header and the table of its scanlines, up to 65,536 lines, fit in."""

PNG_END = b"\0\0\0\0IEND\xaeB`\x82"


def whole(exr: Path, width: int, height: int, note: str) -> bool:
    """Return whether a picture's two files are there, complete, of this size and with this note."""
    try:
        for path in (exr, exr.with_suffix(".png")):
            _check_regular(path)
            check(path.read_bytes(), width, height, note)
    except (OSError, ValueError):
        return False
    return True


def _check_regular(path: Path) -> None:
    """Raise ValueError for what would be read for ever."""
    if path.exists() and not path.is_file():
        raise ValueError("it is no regular file")


def made_by(exr: Path, key: str) -> str:
    """Return the build of Blender that rendered a picture, by its header.

    Without decoding a scanline: a picture is decoded before it gets its name. Raises OSError or
    ValueError where its two files are not there, do not reach to their ends or have another key.
    """
    for path in (exr, exr.with_suffix(".png")):
        _check_regular(path)
    with exr.open("rb") as file:
        start, size = file.read(HEAD), file.seek(0, 2)
        try:
            attributes, end = _attributes(start)
            last = max(_blocks(start, end))
            file.seek(last)
            packed = struct.unpack("<2i", file.read(8))[1]
        except (struct.error, LookupError, OverflowError, ValueError) as error:
            raise ValueError(f"it is cut short or damaged ({error})") from None
    if last + 8 + packed != size:
        raise ValueError("it is cut short")
    with exr.with_suffix(".png").open("rb") as file:
        file.seek(max(0, file.seek(0, 2) - len(PNG_END)))
        if file.read() != PNG_END:
            raise ValueError("its PNG is cut short")
    header = {name: value.decode(errors="replace") for name, value, _, _ in attributes}
    found, _, build = header.get(b"Note", "").partition(" ")
    if found != key:
        raise ValueError("it was made from other data")
    return build or header.get(b"Software", "")


def check(content: bytes, width: int, height: int, note: str = "") -> None:
    """Decode a picture to its last scanline; ValueError says what is wrong with it.

    ``note``: all of the picture's, or its first word alone.
    """
    try:
        found = (_check_png if content[:4] == b"\x89PNG" else _check_exr)(content, width, height)
    except (struct.error, zlib.error, LookupError, OverflowError) as error:
        raise ValueError(f"it is cut short or damaged ({error})") from None
    if note and note not in (found, found.partition(" ")[0]):
        raise ValueError("it was made from other data")


def without_times(content: bytes) -> bytes:
    """Return a picture without what Cycles notes of its own speed."""
    if content[:4] == b"\x89PNG":
        keep = [c for kind, c in _chunks(content) if not c[8:].startswith(CYCLES_STAMPS)]
        return content[:8] + b"".join(keep)
    attributes, end = _attributes(content)
    gone = [(a, b) for name, _, a, b in attributes if name.startswith(CYCLES_STAMPS)]
    header, place = b"", 0
    for first, last in gone:
        header += content[place:first]
        place = last
    header += content[place:end]
    shift, lines = end - len(header), _blocks(content, end)
    table = struct.pack(f"<{len(lines)}Q", *(offset - shift for offset in lines))
    return header + table + content[end + len(table) :]


def _attributes(content: bytes) -> tuple[list[tuple[bytes, bytes, int, int]], int]:
    """Return name, value, start and end of each entry of an EXR's header, and where that ends."""
    if content[:5] != b"v/1\x01\x02" or content[5] & ~4:  # bit 10 allows long names
        raise ValueError("it is not an OpenEXR file of scanlines")
    found, place = [], 8
    while content[place]:
        start = place
        name = content[place : content.index(b"\0", place)]
        place = content.index(b"\0", place + len(name) + 1) + 1
        length = struct.unpack_from("<i", content, place)[0]
        found.append((name, content[place + 4 : place + 4 + length], start, place + 4 + length))
        place += 4 + length
    return found, place + 1


def _blocks(content: bytes, end: int) -> tuple[int, ...]:
    """Return where an EXR's blocks of 16 scanlines start, by the table behind its header."""
    header = {name: value for name, value, _, _ in _attributes(content)[0]}
    _, top, _, bottom = struct.unpack("<4i", header[b"dataWindow"])
    return struct.unpack_from(f"<{(bottom - top) // 16 + 1}Q", content, end)


def _check_exr(content: bytes, width: int, height: int) -> str:
    attributes, end = _attributes(content)
    header = {name: value for name, value, _, _ in attributes}
    left, top, right, bottom = struct.unpack("<4i", header[b"dataWindow"])
    if (right - left + 1, bottom - top + 1) != (width, height):
        raise ValueError(f"it has {right - left + 1} x {bottom - top + 1} pixels")
    channels, place = [], 0
    while header[b"channels"][place]:
        stop = header[b"channels"].index(b"\0", place)
        kind = struct.unpack_from("<i", header[b"channels"], stop + 1)[0]
        channels.append((header[b"channels"][place:stop].decode(), kind))
        place = stop + 17
    if channels not in ([(c, 2) for c in "BGR"], [(c, 2) for c in "ABGR"]):
        raise ValueError(f"its channels are {channels}, not R, G, B in 32 bits")
    if header[b"compression"] != b"\3":
        raise ValueError("it is not ZIP compressed")
    for row, offset in zip(range(0, height, 16), _blocks(content, end), strict=True):
        y, packed = struct.unpack_from("<2i", content, offset)
        data = content[offset + 8 : offset + 8 + packed]
        wanted = min(16, height - row) * width * 4 * len(channels)
        if y - top != row or len(data) != packed:
            raise ValueError(f"it is cut short at line {row}")
        if packed < wanted:
            data = zlib.decompress(data)
        if len(data) != wanted:
            raise ValueError(f"it is damaged at line {row}")
        if packed < wanted:  # undo the predictor, then the halves of the words
            steps = np.frombuffer(data, np.uint8).cumsum(dtype=np.uint8)
            steps[1::2] -= 128
            data = np.stack(np.split(steps, 2), axis=1).tobytes()
        if not np.isfinite(np.frombuffer(data, "<f4")).all():
            raise ValueError(f"it holds values that are not finite at line {row} or below")
    return header.get(b"Note", b"").decode()


def _chunks(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Give kind and all bytes of each chunk of a PNG."""
    place, kind = 8, b""
    while kind != b"IEND":
        length, kind = struct.unpack_from(">I4s", content, place)
        chunk = content[place : place + 12 + length]
        if zlib.crc32(chunk[4:-4]) != struct.unpack_from(">I", content, place + 8 + length)[0]:
            raise ValueError("it is damaged")
        yield kind, chunk
        place += len(chunk)


def _check_png(content: bytes, width: int, height: int) -> str:
    chunks = list(_chunks(content))
    found = struct.unpack_from(">IIBB", chunks[0][1], 8)
    if found not in ((width, height, 8, 2), (width, height, 8, 6)):
        raise ValueError(f"it has {found[0]} x {found[1]} pixels of {found[2]} bits")
    pixels = zlib.decompress(b"".join(chunk[8:-4] for kind, chunk in chunks if kind == b"IDAT"))
    if len(pixels) != height * (1 + width * (3 if found[3] == 2 else 4)):
        raise ValueError("it is cut short")
    texts = [chunk[8:-4].partition(b"\0") for kind, chunk in chunks if kind == b"tEXt"]
    return next((text.decode("latin-1") for name, _, text in texts if name == b"Note"), "")
