"""Whether a .blend is whole, for Blender calls a file saved that a full disk has cut short.

By the layout that Blender's `doc/blender_file_format` describes (from 5.0 on with blocks of 64-bit
sizes) and, of compressed ones, by Zstandard's frames (RFC 8878) and its seekable format. Nothing is
decompressed: a file of a gigabyte takes a fraction of a second.
"""

from __future__ import annotations

import contextlib
import mmap
import os
import re
import struct
from collections.abc import Iterator
from pathlib import Path

from ...whole_files import writing

_HEAD = re.compile(rb"BLENDER(?:(?P<old>[-_])[vV]\d{3}|17-01v\d{4})")
_BLOCK = {b"-": "<4si16x", b"_": "<4si12x", None: "<4s12xq8x"}  # code and length of a block
_CODE = re.compile(rb"[A-Z\d_]{4}|[A-Z\d_]{2}\0\0")
_FRAME, _SEEK_TABLE, _SEEKABLE = 0xFD2FB528, 0x184D2A5E, 0x8F92EAB1


@contextlib.contextmanager
def writing_blend(path: Path) -> Iterator[Path]:
    """Yield a path to save to, which replaces ``path`` once it is proved whole.

    Raises InputError as `whole_files.writing`, also for a file that came out cut short.
    """
    with writing(path) as part:
        yield part
        check(part)


def check(path: Path) -> None:
    """Read a file's structure to its end; raises OSError where it is no whole .blend."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())  # where the network or a quota refuses, it is only now said
        if not os.fstat(file.fileno()).st_size:
            raise OSError("the file came out empty: the disk may be full")
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            try:
                head = _HEAD.match(content)
                _check_blocks(content, head) if head else _check_frames(content)
            except (struct.error, IndexError, ValueError):
                raise OSError("the file came out cut short: the disk may be full") from None


def _check_blocks(content: mmap.mmap, head: re.Match[bytes]) -> None:
    """Go from block to block to the last one, ``ENDB``, at the end of the file."""
    form, place, codes = struct.Struct(_BLOCK[head["old"]]), head.end(), set[bytes]()
    while b"ENDB" not in codes:
        code, length = form.unpack_from(content, place)
        codes.add(code)
        place += form.size + length
        if length < 0 or not _CODE.fullmatch(code):  # zeros would lead back into step
            raise ValueError
    if place != len(content) or b"DNA1" not in codes:
        raise ValueError


def _check_frames(content: mmap.mmap) -> None:
    """Go from frame to frame to the table of them all, at the end of the file."""
    place, sizes = 0, list[int]()
    while struct.unpack_from("<I", content, place)[0] == _FRAME:
        end = _end_of_frame(content, place)
        sizes.append(end - place)
        place = end
    magic, length = struct.unpack_from("<II", content, place)
    count, flags, last = struct.unpack("<IBI", content[-9:])
    row = 12 if flags & 0x80 else 8
    if (magic, last, count) != (_SEEK_TABLE, _SEEKABLE, len(sizes)) or not sizes:
        raise ValueError
    if place + 8 + length != len(content) or length != row * count + 9:
        raise ValueError
    rows = struct.iter_unpack(f"<I{row - 4}x", content[place + 8 : -9])
    if [size for (size,) in rows] != sizes:
        raise ValueError


def _end_of_frame(content: mmap.mmap, place: int) -> int:
    """Return where a frame that starts at ``place`` ends, by the sizes of its blocks."""
    flags = content[place + 4]
    single = flags >> 5 & 1
    place += 5 + (1 - single) + (0, 1, 2, 4)[flags & 3] + (single, 2, 4, 8)[flags >> 6]
    last = 0
    while not last:
        block = int.from_bytes(content[place : place + 3], "little")
        last, kind, size = block & 1, block >> 1 & 3, block >> 3
        if kind == 3 or place + 3 > len(content):
            raise ValueError
        place += 3 + (1 if kind == 1 else size)
    return place + (4 if flags & 4 else 0)
