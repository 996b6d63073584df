"""OpenEXR pictures: reading R, G, B in bands of scanlines, writing whole or not at all."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..whole_files import writing

_BAND = 256  # scanlines at once: the largest block of any compression, so none is unpacked twice


def read_exr(path: Path) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """Read the colours of an OpenEXR file, (h, w, 3) float32 with row 0 at the top, and its header.

    Scanlines or tiles, half or float. Of several layers the one without a name is taken, else
    Blender's *Combined*, else the first; ``header["layer"]`` says which. A lone Y is grey. Only
    the first part of a multi-part file is read. No colour space is converted; ``chromaticities``
    stays in the header.

    Raises
    ------
    InputError
        When the file is cut short or damaged, is cropped, or holds no such channels.
    """
    import OpenEXR

    check_complete(path)
    try:
        with OpenEXR.File(str(path), header_only=True) as file:
            header = {name: _plain(value) for name, value in file.header().items()}
        file = OpenEXR.InputFile(str(path))
    except Exception as error:  # the library raises whatever the damage leads it to
        raise InputError(path, f"OpenEXR cannot read it ({error})", _AGAIN) from None
    try:
        return _read_colours(path, file, header), header
    except InputError:
        raise
    except Exception as error:
        raise InputError(path, f"its pixels are cut short or damaged ({error})", _AGAIN) from None
    finally:
        file.close()


_AGAIN = "copy or download the file again"


def _read_colours(path: Path, file: Any, header: dict[str, Any]) -> NDArray[np.float32]:
    """Read the chosen layer band by band, so that little more than the result is ever held."""
    channels = file.header()["channels"]
    data, display = header["dataWindow"], header["displayWindow"]
    if data != display:
        raise InputError(
            path,
            f"its data window {data} is not its display window {display}",
            "save the whole panorama, not a crop",
        )
    names, header["layer"] = _colour_channels(path, channels)
    kinds = {str(channels[name].type) for name in names}
    if len(kinds) > 1 or not kinds <= {"HALF", "FLOAT"}:
        raise InputError(path, f"its colours are {sorted(kinds)}", "save them as half or float")
    kind = np.float16 if kinds == {"HALF"} else np.float32
    (left, top), (right, bottom) = data
    rgb = np.empty((bottom - top + 1, right - left + 1, 3), np.float32)
    for row in range(0, len(rgb), _BAND):
        band = rgb[row : row + _BAND]
        planes = file.channels(names, scanLine1=top + row, scanLine2=top + row + len(band) - 1)
        for index in range(3):
            plane = np.frombuffer(planes[min(index, len(planes) - 1)], kind)
            band[..., index] = plane.reshape(band.shape[:2])
    return rgb


def _colour_channels(path: Path, channels: Mapping[str, Any]) -> tuple[list[str], str]:
    """Return the names of one layer's R, G, B (or its Y), and that layer's name."""
    layers = sorted(
        (name[:-1] for name in channels if name[:-1] == "" or name[-2:-1] == "."),
        key=lambda layer: (layer != "", "Combined" not in layer, layer),
    )
    for layer in layers:
        if all(layer + letter in channels for letter in "RGB"):
            return [layer + letter for letter in "RGB"], layer.rstrip(".")
        if layer + "Y" in channels and layer + "RY" not in channels:
            return [layer + "Y"], layer.rstrip(".")
    held = ", ".join(sorted(channels)[:6]) + (", …" if len(channels) > 6 else "")
    raise InputError(path, f"has no channels R, G, B but {held}", "save it as RGB")


def _plain(value: Any) -> Any:
    """Turn an attribute into plain numbers, text and tuples of them."""
    if isinstance(value, np.ndarray):
        return tuple(value.tolist())
    if isinstance(value, tuple | list):
        return tuple(_plain(item) for item in value)
    return value if isinstance(value, str | int | float) else str(value)


def check_complete(path: Path) -> None:
    """Raise `InputError` when an OpenEXR file ends before its last block does.

    The library would find out too, but prints its own lines to stderr and reads for long before.
    It is left to it where blocks may stand in another order: multi-part, deep, decreasing y.
    """
    try:
        with path.open("rb") as file:
            size = path.stat().st_size
            head = file.read(1 << 16)
            while (table := _end_of_header(head)) < 0:
                more = file.read(len(head))
                if not more:
                    raise InputError(path, "is cut short in its header", _AGAIN)
                head += more
            flags = struct.unpack_from("<I", head, 4)[0] >> 8
            if flags & 0x18 or b"lineOrder\0lineOrder\0\1\0\0\0\0" not in head[:table]:
                return
            file.seek(table)
            first = int.from_bytes(file.read(8), "little")
            file.seek(table)
            blocks = np.frombuffer(file.read(max(first - table, 0)), "<u8")
            tiled = bool(flags & 0x2)
            leader = 20 if tiled else 8
            last = int(blocks.max()) if len(blocks) else 0
            file.seek(min(last + leader - 4, size))
            length = int.from_bytes(file.read(4), "little")
    except (struct.error, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(path, "its header is damaged", _AGAIN) from None
    missing = int(np.sum(blocks < table)) if len(blocks) else 1
    if missing or last + leader + length > size or len(blocks) * 8 < first - table:
        raise InputError(path, f"is cut short: it ends after {size} bytes", _AGAIN)


def _end_of_header(head: bytes) -> int:
    """Return where the first header of `head` ends, -1 when that lies beyond."""
    place = 8
    while place < len(head) and head[place]:
        kind = head.find(b"\0", place) + 1
        length = head.find(b"\0", kind) + 1
        if not kind or not length or length + 4 > len(head):
            return -1
        place = length + 4 + struct.unpack_from("<I", head, length)[0]
    return place + 1 if place < len(head) else -1


def write_exr(
    path: Path, channels: Mapping[str, NDArray[np.float32]], attributes: Mapping[str, Any]
) -> None:
    """Write an OpenEXR file (scanlines, ZIP), whole or not at all.

    Parameters
    ----------
    channels
        Planes (h, w) by name, or ``{"RGB": (h, w, 3)}``, float32.
    attributes
        Header entries: text, numbers, or what OpenEXR's own types want.

    Raises
    ------
    InputError
        When the place cannot be written to; what stood there stays.
    """
    import OpenEXR

    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **attributes,
    }
    planes = {name: np.ascontiguousarray(plane, np.float32) for name, plane in channels.items()}
    with writing(path) as part:
        OpenEXR.File(header, planes).write(str(part))
