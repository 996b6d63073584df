"""Skies in OpenEXR files: what is read of them, and in which order.

The pixels are unpacked by OpenEXR, or inside Blender by Blender. Neither is given more than it
needs: a file that holds other layers, other parts or an unusual header is copied first, block by
block, under a plain header (`exr_plain`). So both see the same, and nothing in a header can harm
them: OpenEXR for Python can end the process on a thumbnail.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .exr_header import AGAIN, COMPRESSIONS, Part, block_places, read_header
from .exr_layers import Colours, find_colours
from .exr_plain import is_plain, plain_names, write_plain
from .file_claims import check_shape, check_size

Decode = Callable[[Path, tuple[str, ...]], NDArray[np.float32]]
"""From a plain file of one part, and names of channels, to (h, w, k) float32, top row first.

It raises what it wants where the pixels are damaged or packed in a way that it does not know.
"""


def decode_by_openexr(path: Path, names: tuple[str, ...]) -> NDArray[np.float32]:
    """Unpack channels of a plain file by OpenEXR, (h, w, k) float32."""
    import OpenEXR

    if names == ("R", "G", "B"):
        # At once where all are of one kind: so little more than the result is ever held.
        with contextlib.suppress(ValueError), quiet(), OpenEXR.File(str(path)) as file:
            planes = file.channels()
            whole = planes["RGB" if "RGB" in planes else "RGBA"].pixels
            return whole[..., :3].astype(np.float32, copy=False)
    with quiet(), OpenEXR.File(str(path), separate_channels=True) as file:
        if not file.parts:
            raise ValueError("OpenEXR cannot unpack it")
        planes = file.channels()
        pixels = np.empty((*planes[names[0]].pixels.shape, len(names)), np.float32)
        for index, name in enumerate(names):
            pixels[..., index] = planes[name].pixels
    return pixels


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep off the terminal what libraries print of each damaged block: an error says it once."""
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
        with contextlib.suppress(OSError, ValueError):  # there may be no terminal
            nothing = stack.enter_context(Path(os.devnull).open("wb"))
            for number, stream in ((1, sys.__stdout__), (2, sys.__stderr__)):
                if stream is not None:
                    stream.flush()
                kept = os.dup(number)
                stack.callback(os.close, kept)
                stack.callback(os.dup2, kept, number)
                os.dup2(nothing.fileno(), number)
        yield


def look(
    file: BinaryIO, size: int, place: object
) -> tuple[Colours, tuple[int, int, int, int], dict[str, Any]]:
    """Return which channels of an OpenEXR file are the sky, the window that it fills, its header.

    The window is the display window, or the data window where that alone is 2:1. The header holds
    the file's attributes, and ``layer``, ``layers`` (how many there are), ``channels`` ("RGB",
    "XYZ", "Y"), ``one_letter`` (whether that is all that they are called) and ``black`` (the part
    of the window that no pixels cover). Raises `InputError` as `read_exr` does.
    """
    parts = read_header(file, size, place)
    colours = find_colours(parts, place)
    part = colours.part
    left, top, right, bottom = window = window_of(part.data_window, part.display_window)
    across, down = overlap(part.data_window, window)
    header = {
        **part.attributes,
        "layer": colours.layer,
        "layers": 1 + colours.others,
        "channels": colours.kind,
        "one_letter": len(parts) == 1 and all(len(each.name) == 1 for each in colours.channels),
        "black": 1.0 - len(across) * len(down) / ((right - left + 1) * (bottom - top + 1)),
    }
    return colours, window, header


def read_exr(
    path: Path, size: int, decode: Decode = decode_by_openexr
) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """Read the sky of an OpenEXR file of ``size`` bytes, and its header as `look` returns it.

    Colours (h, 2 h, 3) float32 as stored, row 0 at the top; black where no pixels are.

    Raises
    ------
    InputError
        When the file is cut short or damaged, holds no colours, or is no 2:1 picture.
    """
    with path.open("rb") as file:
        colours, window, header = look(file, size, path)
        part = colours.part
        left, top, right, bottom = window
        width, height = right - left + 1, bottom - top + 1
        check_shape(path, width, height)
        check_size(path, (width, height), max(part.decoded, 12 * width * height), size)
        places = block_places(file, size, part, path)
        pixels = _unpacked(path, file, colours, places, decode)
    if part.data_window == window:
        return pixels, header
    whole = np.zeros((height, width, 3), np.float32)
    across, down = overlap(part.data_window, window)
    if across and down:
        x, y, _, _ = part.data_window
        there = pixels[down.start - y : down.stop - y, across.start - x : across.stop - x]
        whole[down.start - top : down.stop - top, across.start - left : across.stop - left] = there
    return whole, header


def window_of(
    data: tuple[int, int, int, int], display: tuple[int, int, int, int]
) -> tuple[int, int, int, int]:
    """Return the display window, or the data window where that alone is 2:1."""
    for left, top, right, bottom in (display, data):
        if right - left + 1 == 2 * (bottom - top + 1):
            return left, top, right, bottom
    return data


def overlap(
    data: tuple[int, int, int, int], window: tuple[int, int, int, int]
) -> tuple[range, range]:
    """Return which columns and rows of a window have pixels."""
    return (
        range(max(data[0], window[0]), min(data[2], window[2]) + 1),
        range(max(data[1], window[1]), min(data[3], window[3]) + 1),
    )


@contextlib.contextmanager
def packed_unknown(path: Path, part: Part) -> Iterator[None]:
    """Say in one `InputError` what any decoder finds wrong with a part's pixels."""
    try:
        yield
    except (InputError, MemoryError):
        raise
    except ImportError:
        raise InputError(path, "is read by OpenEXR", "install it: pip install OpenEXR") from None
    except Exception as error:  # a library raises whatever the damage leads it to
        kind = COMPRESSIONS.get(part.compression, (f"number {part.compression}", 0))[0]
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            path,
            f"its pixels are damaged, or packed in a way that is not known here ({kind}: {reason})",
            f"{AGAIN}, or save it with ZIP compression",
        ) from None


def _unpacked(
    path: Path,
    file: BinaryIO,
    colours: Colours,
    places: list[tuple[int, int]],
    decode: Decode,
) -> NDArray[np.float32]:
    """Return the pixels of the data window, (h, w, 3)."""
    part = colours.part
    with packed_unknown(path, part):
        if is_plain(part):
            pixels = decode(path, tuple(channel.name for channel in colours.channels))
        else:
            with tempfile.TemporaryDirectory(prefix="skylight-") as folder:
                copy = Path(folder) / "plain.exr"
                names = plain_names(part, colours.channels)
                with copy.open("wb") as target:
                    write_plain(file, part, places, names, target)
                pixels = decode(copy, tuple(names[channel.name] for channel in colours.channels))
    left, top, right, bottom = part.data_window
    if pixels.shape[:2] != (bottom - top + 1, right - left + 1):
        raise InputError(path, f"unpacks to {pixels.shape[1]} x {pixels.shape[0]} pixels", AGAIN)
    return pixels if pixels.shape[2] == 3 else np.repeat(pixels, 3, axis=2)
