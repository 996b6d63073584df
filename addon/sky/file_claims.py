"""What a picture's file claims of itself, held against the file before anything is unpacked."""

from __future__ import annotations

import stat
from pathlib import Path

from ..errors import InputError

RATIO = 100
"""Times that unpacked pixels may be larger than their file: skies pack to a tenth at best."""

SMALL = 1 << 27
"""Bytes of pixels that any file may claim: 4096 x 2048 in float."""


def regular_size(path: Path) -> int:
    """Return a file's size [bytes].

    Raises `InputError` where there is none, and for what is no regular file: a folder, or a pipe,
    whose reading would never end.
    """
    try:
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        raise InputError(path, "there is no such file", "check the path") from None
    except (OSError, ValueError) as error:
        what = getattr(error, "strerror", None) or error
        raise InputError(path, f"cannot be opened ({what})", "check the path") from None
    if stat.S_ISDIR(found.st_mode):
        raise InputError(path, "cannot be opened (it is a folder)", "check the path")
    if not stat.S_ISREG(found.st_mode):
        raise InputError(path, "cannot be opened (it is not a regular file)", "give a file")
    return found.st_size


def check_size(place: object, pixels: tuple[int, int], unpacked: int, size: int) -> None:
    """Raise `InputError` for pixels of ``unpacked`` bytes that a file of ``size`` cannot hold.

    ``pixels``: width and height, for the message.
    """
    if unpacked > max(SMALL, RATIO * size):
        width, height = pixels
        raise InputError(
            place,
            f"claims {width} x {height} pixels in {size} bytes, which is too few for a sky",
            "save it again",
        )


def check_shape(place: object, width: int, height: int) -> None:
    """Raise `InputError` unless a picture is 2:1; cube maps are named."""
    if height and width == 2 * height:
        return
    size = f"is {width} x {height}"
    if height and (width, height) in [
        (6 * height, height),
        (width, 6 * width),
        (height * 4 // 3, height),
        (width, width * 4 // 3),
    ]:
        raise InputError(
            place, f"{size}, a cube map", "convert it to lat-long (equirectangular, 2:1)"
        )
    raise InputError(
        place, f"{size}, not 2:1 as a lat-long panorama is", "export it as equirectangular, 2:1"
    )
