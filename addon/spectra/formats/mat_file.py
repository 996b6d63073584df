"""Variables in MATLAB files of version 5 to 7, and of version 4.

MathWorks, "MAT-File Format". Not with scipy: its reader takes the sizes in a damaged file at their
word and crashes the process that it runs in, Blender and all that is not saved (seen with 1.18).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np

UNPACKED = 1 << 23
"""Bytes of all variables, unpacked, or 16 times as many as are packed: surfaces are packed to a
half, and zeros alone to a thousandth."""

_TYPES = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
_TEXT = {1: "latin-1", 2: "latin-1", 4: "utf-16-{}", 16: "utf-8", 17: "utf-16-{}", 18: "utf-32-{}"}
_OLD = ("f8", "f4", "i4", "i2", "u2", "u1")
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR, _NUMBERS = 1, 2, 4, range(6, 16)
_DEPTH = 8


class BrokenFile(ValueError):
    """What cannot be a MATLAB file of these versions."""


def variables(content: bytes) -> dict[str, Any]:
    """Return a file's variables: numbers as arrays, text as str, cells as lists, structs as dicts.

    Anything else is None. Raises `BrokenFile`, `NotImplementedError` for version 7.3 (HDF5).
    """
    try:
        if b"\x89HDF" in (content[:4], content[512:516]):
            raise NotImplementedError
        if content[126:128] in (b"IM", b"MI") and content[:4].strip(b"\x00"):
            order = "<" if content[126:128] == b"IM" else ">"
            return dict(_matrix(body, order) for body in _bodies(content[128:], order))
        return dict(_of_version_4(content))
    except (struct.error, zlib.error, ValueError, KeyError, IndexError, OverflowError) as error:
        raise BrokenFile(str(error)) from None


def _bodies(data: bytes, order: str) -> Iterator[bytes]:
    """Yield what is in each variable, unpacked."""
    left = max(UNPACKED, 16 * len(data))
    for kind, body in _elements(data, order):
        if kind == _COMPRESSED:
            packed = zlib.decompressobj()
            unpacked = packed.decompress(body, left)
            if packed.unconsumed_tail:
                raise BrokenFile("it unpacks to far more than its size")
            left -= len(unpacked) - (len(unpacked) > 0)
            kind, body = _next(_elements(unpacked, order))
        if kind == _MATRIX:
            yield body


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Yield type and bytes of each element."""
    at = 0
    while at + 8 <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind >> 16:  # a small one: both in the first word
            kind, size, start, step = kind & 0xFFFF, kind >> 16, at + 4, 8
            if size > 4:
                raise BrokenFile(f"an element of {size} bytes in four")
        else:
            start = at + 8
            step = 8 + (size if kind == _COMPRESSED else -(-size // 8) * 8)
        if start + size > len(data):
            raise BrokenFile(f"an element of {size} bytes in {len(data) - start}")
        yield kind, data[start : start + size]
        at += step


def _matrix(body: bytes, order: str, depth: int = 0) -> tuple[str, Any]:
    """Return a variable's name and value."""
    parts = _elements(body, order)
    flags = struct.unpack(f"{order}II", _next(parts)[1])[0] & 0xFF
    shape = tuple(_numbers(*_next(parts), order).astype(int).tolist())
    name = _next(parts)[1].decode("latin-1")
    count = int(np.prod(shape, dtype=float))
    # Each number takes a byte at least, each cell or record an element of eight.
    if min(shape, default=-1) < 0 or count > len(body) or depth > _DEPTH:
        raise BrokenFile(f"'{name[:40]}' is of size {shape}")
    if flags in _NUMBERS:
        return name, _numbers(*_next(parts), order).reshape(shape, order="F")
    if flags == _CHAR:
        kind, data = _next(parts)
        return name, data.decode(_TEXT[kind].format("le" if order == "<" else "be"), "replace")
    if flags == _CELL:
        return name, [_matrix(_next(parts)[1], order, depth + 1)[1] for _ in range(count)]
    if flags == _STRUCT:
        length = max(int(_numbers(*_next(parts), order)[0]), 1)
        text = _next(parts)[1].decode("latin-1")
        fields = [text[k : k + length].partition("\0")[0] for k in range(0, len(text), length)]
        if count * len(fields) > len(body) or not fields:
            raise BrokenFile(f"'{name[:40]}' has {count} records")
        rows = [
            [_matrix(_next(parts)[1], order, depth + 1)[1] for _ in fields] for _ in range(count)
        ]
        return name, {field: [row[k] for row in rows] for k, field in enumerate(fields)}
    return name, None


def _next(parts: Iterator[tuple[int, bytes]]) -> tuple[int, bytes]:
    try:
        return next(parts)
    except StopIteration:
        raise BrokenFile("it ends too early") from None


def _numbers(kind: int, data: bytes, order: str) -> np.ndarray:
    return np.frombuffer(data, order + _TYPES[kind])


def _of_version_4(content: bytes) -> Iterator[tuple[str, Any]]:
    """Yield name and value of each variable; they have no more than rows and columns."""
    at = 0
    while at < len(content):
        order = "<" if struct.unpack_from("<I", content, at)[0] < 5000 else ">"
        kind, rows, columns, imaginary, length = struct.unpack_from(f"{order}5I", content, at)
        thousands, precision, what = kind // 1000, kind // 10 % 10, kind % 10
        if thousands > 1 or kind // 100 % 10 or not 0 < length < 200:
            raise BrokenFile("it begins as none")
        dtype = np.dtype(order + _OLD[precision])
        start = at + 20 + length
        size = rows * columns * dtype.itemsize
        if start + size > len(content):
            raise BrokenFile(f"a matrix of {size} bytes in {len(content) - start}")
        name = content[at + 20 : start].partition(b"\0")[0].decode("latin-1")
        values = np.frombuffer(content, dtype, rows * columns, start).reshape(columns, rows).T
        yield name, values if what == 0 else None
        at = start + size * (2 if imaginary else 1)
