"""Files of spectra as bytes, text, lines and numbers: never more than the file itself holds.

What a file says of its own size is not believed, and only regular files are opened: reading a pipe
or a device would never end.
"""

from __future__ import annotations

import codecs
import re
import stat
from collections.abc import Iterator
from pathlib import Path

from ..errors import InputError
from .text_encodings import national

HEAD = 1 << 14
"""Bytes of a text by which its encoding is known: headings are among them."""

LARGEST_FILE = 1 << 26
"""Bytes of a text: the largest published ones have a few million."""

LONGEST_LINE = 1 << 22
"""Characters: 100,000 columns fit; a longer line is no table of spectra."""

LONGEST_NUMBER = 64
"""Characters: a longer one is no measurement, and what reads it may take long."""

LONGEST_NAME = 1000
"""Characters of a spectrum's name."""

_FORTRAN = re.compile(r"[+-]?\d+\.?\d*[Dd][+-]?\d{1,3}")

_BLANKS = "\u00a0\u202f\u2009\u3000"

_NEVER_IN_TEXT = bytes([*range(1, 9), *range(14, 27), 28, 29, 30, 31])

_MARKS = (b"\xff\xfe", b"\xfe\xff")


def regular(path: Path) -> int:
    """Return a file's size [bytes]; `InputError` where it is none, a pipe or a device."""
    try:
        found = path.stat()
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(path, f"cannot be read ({why})", "check the path") from error
    if stat.S_ISDIR(found.st_mode):
        raise InputError(path, "cannot be read (Is a directory)", "check the path")
    if not stat.S_ISREG(found.st_mode):
        raise InputError(path, "is not a regular file", "give a file, not a pipe or a device")
    return found.st_size


def start(path: Path, size: int = 4096) -> bytes:
    """Return a file's first bytes; `InputError` where it cannot be read."""
    regular(path)
    try:
        with path.open("rb") as handle:
            return handle.read(size)
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "check the path") from error


def content(path: Path, largest: int = LARGEST_FILE) -> bytes:
    """Return a file's bytes; `InputError` where it cannot be read or is larger than ``largest``."""
    size = regular(path)
    if size > largest:
        raise InputError(path, f"is larger than {largest >> 20} MiB", "split the file")
    try:
        with path.open("rb") as handle:
            return handle.read(size)
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "check the path") from error


def text(path: Path) -> str:
    """Return a file's text: UTF-16 with or without a byte-order mark, UTF-8, else `national`."""
    found = content(path)
    encoding = _utf_16(found[:4096])
    if encoding:
        return found.decode(encoding, errors="replace")
    try:
        return found.decode("utf-8-sig")
    except UnicodeDecodeError:
        return found.decode(national(found[:HEAD]), errors="replace")


def lines(path: Path) -> list[str]:
    """Return the lines of a text, numbered as editors do: a form feed ends none."""
    return text(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")


def streamed(path: Path) -> Iterator[tuple[int, str]]:
    """Yield number and text of each line that is not empty, however large the file.

    Raises `InputError` for a file that cannot be read, a line over 4 MiB and more than 64 MiB;
    `BinaryFile` for what is no text.
    """
    head = start(path)
    encoding = _utf_16(head)
    if encoding is None:
        if _is_binary(head):
            raise BinaryFile(path, "is binary, not text", "export it as CSV")
        encoding = "utf-8-sig" if _is_utf_8(path) else national(start(path, HEAD))
    read = number = 0
    try:
        with path.open(encoding=encoding, errors="replace", newline=None) as handle:
            while line := handle.readline(LONGEST_LINE):
                number += 1
                read += len(line)
                if len(line) == LONGEST_LINE and not line.endswith("\n"):
                    raise InputError(
                        f"{path}:{number}",
                        f"the line is longer than {LONGEST_LINE >> 20} MiB",
                        "put one wavelength on each line",
                    )
                if read > LARGEST_FILE:
                    raise InputError(
                        f"{path}:{number}",
                        f"more than {LARGEST_FILE >> 20} MiB of text",
                        "split the file",
                    )
                if not line.isspace():
                    yield number, line.rstrip("\r\n").replace("\0", "")
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "check the path") from error


def _is_binary(head: bytes) -> bool:
    """Whether bytes are no text; instruments pad words with a few zeros."""
    strange = sum(head.count(byte) for byte in _NEVER_IN_TEXT)
    return head.count(0) > len(head) / 20 or strange > len(head) / 200


class BinaryFile(InputError):
    """A file that is no text."""


def _utf_16(head: bytes) -> str | None:
    """Return which UTF-16 it is: by its mark, or by every other byte of its digits being 0."""
    if head.startswith(_MARKS):
        return "utf-16"
    even, odd = head[:200:2], head[1:200:2]
    if len(odd) >= 8:
        if odd.count(0) > 0.9 * len(odd) and not even.count(0):
            return "utf-16-le"
        if even.count(0) > 0.9 * len(even) and not odd.count(0):
            return "utf-16-be"
    return None


def _is_utf_8(path: Path) -> bool:
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        with path.open("rb") as handle:
            for _ in range(LARGEST_FILE >> 20):
                chunk = handle.read(1 << 20)
                decoder.decode(chunk, final=not chunk)
                if not chunk:
                    break
    except UnicodeDecodeError:
        return False
    except OSError:
        return True  # told when it is read
    return True


def number(text: str) -> float | None:
    """Return the number that a text is, with a decimal point or comma; None where it is none."""
    if len(text) > LONGEST_NUMBER or "_" in text:
        return None
    if "," in text and "." not in text:
        text = text.replace(",", ".", 1)
    try:
        return float(text)
    except ValueError:
        return float(text.upper().replace("D", "E")) if _FORTRAN.fullmatch(text) else None


def plain(text: str) -> str:
    """Return a name as it can be shown and written: without control characters and half pairs."""
    whole = text[:LONGEST_NAME].encode("utf-8", "replace").decode("utf-8")
    return "".join(c if c.isprintable() or c in _BLANKS else " " for c in whole).strip()
