"""The header of an OpenEXR file, read by Python alone, and where its blocks of pixels lie.

https://openexr.com/en/latest/OpenEXRFileLayout.html. No length is believed that the file itself
cannot hold, so a damaged or hostile header costs no more than its own bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

from ..errors import InputError

MAGIC = b"\x76\x2f\x31\x01"
COMPRESSIONS = {
    0: ("NONE", 1),
    1: ("RLE", 1),
    2: ("ZIPS", 1),
    3: ("ZIP", 16),
    4: ("PIZ", 32),
    5: ("PXR24", 16),
    6: ("B44", 32),
    7: ("B44A", 32),
    8: ("DWAA", 32),
    9: ("DWAB", 256),
    10: ("HTJ2K256", 256),
    11: ("HTJ2K32", 32),
}
"""By number: name, and scanlines in a block. Of newer ones the file's own table tells."""

AGAIN = "copy or download the file again"
TILED, LONG_NAMES, DEEP, SEVERAL = 0x2, 0x4, 0x8, 0x10
_LARGEST = 1 << 26  # bytes of one attribute: manifests of Cryptomatte have a few million
_MOST = 1 << 12  # attributes of a part, its channels, and parts
_FARTHEST = 1 << 24  # pixels from 0


@dataclass(frozen=True)
class Channel:
    """One channel: name, kind (0 whole numbers, 1 half, 2 float), and pixels between samples."""

    name: str
    kind: int
    linear: int
    """What B44 needs to know."""
    sampling: tuple[int, int]


@dataclass
class Part:
    """One picture of a file; most files hold one."""

    attributes: dict[str, Any] = field(default_factory=dict)
    """Text, numbers and tuples of numbers by name; others are left out."""
    kinds: dict[str, str] = field(default_factory=dict)
    """What each attribute is called in the file to be."""
    channels: tuple[Channel, ...] = ()
    tiles: bytes = b""
    """The description of its tiles; empty for scanlines."""
    deep: bool = False
    number: int | None = None
    """Which part of several; None in a file of one."""
    table: int = 0
    """Where the table of its blocks starts [bytes]."""
    blocks: int = 0
    """How many blocks it has."""

    @property
    def data_window(self) -> tuple[int, int, int, int]:
        """Left, top, right and bottom of the pixels that there are, both ends included."""
        return self.attributes["dataWindow"]

    @property
    def display_window(self) -> tuple[int, int, int, int]:
        """Left, top, right and bottom of the picture that they are part of."""
        return self.attributes["displayWindow"]

    @property
    def compression(self) -> int:
        """One of `COMPRESSIONS`, or a newer one."""
        return self.attributes["compression"]

    @property
    def leader(self) -> int:
        """Bytes before a block's own: part, place and length."""
        return (4 if self.number is not None else 0) + (20 if self.tiles else 8)

    @property
    def decoded(self) -> int:
        """Bytes of all its pixels, those of whole tiles included: readers make room for these."""
        left, top, right, bottom = self.data_window
        width, height = right - left + 1, bottom - top + 1
        if self.tiles:
            across, down = struct.unpack_from("<2I", self.tiles)
            width, height = -(-width // across) * across, -(-height // down) * down
        pixels = width * height
        return sum(
            pixels * (2 if channel.kind == 1 else 4) // (channel.sampling[0] * channel.sampling[1])
            for channel in self.channels
        )


def read_header(file: BinaryIO, size: int, place: object) -> list[Part]:
    """Read what an OpenEXR file of ``size`` bytes says of its parts.

    Text that is not UTF-8 is read as Latin-1. ``place`` is what errors call the file. Raises
    `InputError` for a header that is cut short or contradicts itself.
    """
    source = _Source(file, size)
    try:
        magic, version = struct.unpack("<4sI", source.take(8))
        if magic != MAGIC or version & 0xFF != 2:
            raise _Damaged("it is not an OpenEXR 2 file")
        flags, parts = version >> 8, []
        while part := _part(source):
            if flags & SEVERAL:
                part.number = len(parts)
            else:  # a lone part need not say its type
                part.tiles = part.tiles if flags & TILED else b""
                part.deep |= bool(flags & DEEP)
            if flags & TILED and not flags & SEVERAL and not part.tiles:
                raise _Damaged("it does not describe its tiles")
            parts.append(part)
            if not flags & SEVERAL or len(parts) > _MOST:
                break
        if not parts or len(parts) > _MOST:
            raise _Damaged(f"it has {len(parts)} parts")
        table = source.place
        for part in parts:
            part.table = table
            part.blocks = _count(part, source)
            table += 8 * part.blocks
        if table > size:
            raise _Damaged(f"its {table - source.place} bytes of offsets end after the file")
    except (_Damaged, struct.error) as error:
        raise InputError(place, f"its header is cut short or damaged ({error})", AGAIN) from None
    return parts


class _Damaged(Exception):
    """A header that contradicts itself or its file."""


class _Source:
    """The bytes of a file one after another, never past its end."""

    def __init__(self, file: BinaryIO, size: int) -> None:
        self.file, self.size, self.place = file, size, 0

    def take(self, count: int, keep: bool = True) -> bytes:
        if not 0 <= count <= self.size - self.place:
            raise _Damaged(f"{count} bytes are announced where {self.size - self.place} are left")
        self.place += count
        if not keep:
            self.file.seek(self.place)
            return b""
        found = self.file.read(count)
        if len(found) != count:
            raise _Damaged("it ends early")
        return found

    def name(self) -> bytes:
        """What stands before the next zero byte: 255 bytes at most."""
        found = bytearray()
        while (byte := self.take(1)) != b"\0":
            found += byte
            if len(found) > 255:
                raise _Damaged("a name does not end")
        return bytes(found)


def _part(source: _Source) -> Part | None:
    """Read one part's attributes; None where the list of parts ends."""
    part = Part()
    while name := text(source.name()):
        kind = text(source.name())
        length = struct.unpack("<i", source.take(4))[0]
        part.kinds[name] = kind
        if len(part.kinds) > _MOST:
            raise _Damaged(f"it has over {_MOST} attributes")
        if kind == "preview" or length > _LARGEST:
            source.take(length, keep=False)
            continue
        content = source.take(length)
        if kind == "chlist":
            part.channels = _channels(content)
        elif kind == "tiledesc":
            part.tiles = content
        elif kind == "string":
            part.attributes[name] = text(content)
        elif kind in _READERS:
            found = _READERS[kind](content)
            part.attributes[name] = found[0] if len(found) == 1 else found
    if not part.kinds:
        return None
    _check(part)
    return part


def _numbers(form: str) -> Callable[[bytes], tuple[Any, ...]]:
    return struct.Struct("<" + form).unpack


_READERS = {
    "int": _numbers("i"),
    "float": _numbers("f"),
    "double": _numbers("d"),
    "compression": _numbers("B"),
    "lineOrder": _numbers("B"),
    "box2i": _numbers("4i"),
    "chromaticities": _numbers("8f"),
    "v2f": _numbers("2f"),
    "v2i": _numbers("2i"),
    "v3f": _numbers("3f"),
}


def text(content: bytes) -> str:
    """Return text as it was meant: UTF-8, else Latin-1, which never fails."""
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _channels(content: bytes) -> tuple[Channel, ...]:
    found, place = [], 0
    while content[place : place + 1] not in (b"\0", b""):
        stop = content.find(b"\0", place)
        if not 0 < stop - place <= 255 or len(found) >= _MOST:
            raise _Damaged("its channels' names do not end")
        kind, linear, across, down = struct.unpack_from("<4i", content, stop + 1)
        if kind not in (0, 1, 2) or across < 1 or down < 1:
            raise _Damaged(f"channel {text(content[place:stop])} is of kind {kind}")
        found.append(Channel(text(content[place:stop]), kind, linear, (across, down)))
        place = stop + 17
    return tuple(found)


def _check(part: Part) -> None:
    """Raise `_Damaged` where what every part must say is missing or makes no sense."""
    kinds = {"dataWindow": "box2i", "displayWindow": "box2i", "compression": "compression"}
    for name, kind in {**kinds, "channels": "chlist"}.items():
        if part.kinds.get(name) != kind:
            raise _Damaged(f"it does not say {name}")
    if not part.channels:
        raise _Damaged("it has no channels")
    for left, top, right, bottom in (part.data_window, part.display_window):
        if right < left or bottom < top or max(map(abs, (left, top, right, bottom))) > _FARTHEST:
            raise _Damaged(f"it claims pixels {left} to {right} by {top} to {bottom}")
    kind = str(part.attributes.get("type", ""))
    part.deep = kind in ("deepscanline", "deeptile")
    if not kind.endswith(("tile", "tiledimage")) and kind:
        part.tiles = b""
    if part.tiles and not all(struct.unpack("<2IB", part.tiles)[:2]):
        raise _Damaged("its tiles have no size")


def _count(part: Part, source: _Source) -> int:
    """Return how many blocks a part has."""
    told = part.attributes.get("chunkCount", -1)
    known = part.compression in COMPRESSIONS
    if part.number is not None:
        count = int(told) if part.kinds.get("chunkCount") == "int" else -1
    elif part.tiles:
        count = _tiles(part)
    elif known:
        _, top, _, bottom = part.data_window
        count = -(-(bottom - top + 1) // COMPRESSIONS[part.compression][1])
    else:  # the first block follows the table at once
        source.file.seek(source.place)
        count = (struct.unpack("<Q", source.file.read(8))[0] - source.place) // 8
    if not 0 < count <= (source.size - source.place) // 8:
        raise _Damaged(f"it announces {count} blocks in {source.size} bytes")
    return count


def _tiles(part: Part) -> int:
    """Return how many tiles a part has in all levels."""
    across, down, mode = struct.unpack("<2IB", part.tiles)
    if mode & 15 > 2 or mode >> 4 > 1:
        raise _Damaged(f"its tiles are {across} x {down} of mode {mode}")
    left, top, right, bottom = part.data_window
    width, height = right - left + 1, bottom - top + 1
    up = mode >> 4

    def levels(length: int) -> list[int]:
        found = [length]
        while found[-1] > 1:
            found.append((length + (up << len(found)) - up) >> len(found))
        return found

    if mode & 15 == 0:
        sizes = [(width, height)]
    elif mode & 15 == 1:
        count = len(levels(max(width, height)))
        sizes = [
            (max(1, (width + (up << i) - up) >> i), max(1, (height + (up << i) - up) >> i))
            for i in range(count)
        ]
    else:
        sizes = [(w, h) for w in levels(width) for h in levels(height)]
    return sum(-(-w // across) * -(-h // down) for w, h in sizes)


def block_places(file: BinaryIO, size: int, part: Part, place: object) -> list[tuple[int, int]]:
    """Return where each block of a part starts and ends [bytes], its leader included.

    Raises `InputError` where one lies outside the file of ``size`` bytes, or all of them together
    are longer than that: so a part is whole, or nothing of it is read.
    """
    file.seek(part.table)
    offsets = struct.unpack(f"<{part.blocks}Q", file.read(8 * part.blocks))
    first, total, found = part.table + 8 * part.blocks, 0, []
    for offset in offsets:
        if not first <= offset <= size - part.leader:
            raise InputError(place, f"is cut short: it ends after {size} bytes", AGAIN)
        file.seek(offset + part.leader - 4)
        length = struct.unpack("<i", file.read(4))[0]
        end = offset + part.leader + length
        total += end - offset
        if length < 0 or end > size:
            raise InputError(place, f"is cut short: it ends after {size} bytes", AGAIN)
        if total > size:
            raise InputError(place, "its blocks lie upon one another: it is damaged", AGAIN)
        found.append((offset, end))
    return found


def header_of(path: Path) -> list[Part]:
    """Return the parts of a file by its path, as `read_header` does."""
    with path.open("rb") as file:
        return read_header(file, path.stat().st_size, path)
