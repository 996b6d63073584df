"""A part of an OpenEXR file as a plain file of its own: blocks as they are, under a new header.

The blocks hold the samples of all channels in the order of their names, so channels cannot be left
out, but they can be called otherwise as long as that order stays: the wanted ones B, G, R or Y,
the others so that no program takes them for colours.
"""

from __future__ import annotations

import struct
from typing import BinaryIO

from .exr_header import COMPRESSIONS, MAGIC, TILED, Channel, Part

_READ_BY_ALL = {
    *("box2i", "chlist", "chromaticities", "compression", "double", "float", "int"),
    *("lineOrder", "string", "tiledesc", "v2f", "v2i", "v3f"),
}

_RULED = {"R", "G", "B", "Y", "RY", "BY", "A"}
"""Last words of names by which DWAA and DWAB choose how a channel is packed."""


def is_plain(part: Part) -> bool:
    """Return whether a file can be handed on as it is: one part, R, G, B or Y, nothing unusual."""
    names = {channel.name for channel in part.channels}
    texts = [*part.kinds, *(v for v in part.attributes.values() if isinstance(v, str))]
    return (
        part.number is None
        and (names <= set("ABGR") or names <= set("AY"))
        and set(part.kinds.values()) <= _READ_BY_ALL
        and all(text.isascii() for text in texts)
    )


def plain_names(part: Part, wanted: tuple[Channel, ...]) -> dict[str, str]:
    """Return what each channel is called in the plain file; the order of the names stays.

    With DWAA and DWAB all keep their names where another name would change how they are unpacked.
    """
    letters = iter("BGR" if len(wanted) == 3 else "Y")
    chosen = {channel.name for channel in wanted}
    names, last = {}, "!"
    for index, channel in enumerate(part.channels):
        if channel.name in chosen:
            last = names[channel.name] = next(letters)
        else:
            names[channel.name] = f"{last}{index:04}"
    if COMPRESSIONS.get(part.compression, ("",))[0].startswith("DWA"):
        words = {name.rpartition(".")[2] for name in names}
        for name, new in names.items():
            word = name.rpartition(".")[2]
            if word != new and (word in _RULED or new in words):
                return {name: name for name in names}
    return names


def write_plain(
    source: BinaryIO,
    part: Part,
    places: list[tuple[int, int]],
    names: dict[str, str],
    target: BinaryIO,
) -> None:
    """Write one part, whose blocks lie at ``places``, as a file of its own."""
    channels = b"".join(
        names[channel.name].encode()
        + b"\0"
        + struct.pack("<4i", channel.kind, channel.linear, *channel.sampling)
        for channel in part.channels
    )
    window = struct.pack("<4i", *part.data_window)
    order = part.attributes.get("lineOrder")
    attributes = {
        "channels": ("chlist", channels + b"\0"),
        "compression": ("compression", bytes([part.compression])),
        "dataWindow": ("box2i", window),
        "displayWindow": ("box2i", window),
        "lineOrder": ("lineOrder", bytes([order if order in (0, 1, 2) else 0])),
        "pixelAspectRatio": ("float", struct.pack("<f", 1.0)),
        "screenWindowCenter": ("v2f", bytes(8)),
        "screenWindowWidth": ("float", struct.pack("<f", 1.0)),
    }
    if part.tiles:
        attributes["tiles"] = ("tiledesc", part.tiles)
    header = pack_header(attributes, TILED if part.tiles else 0)
    skip = 0 if part.number is None else 4
    place, table = len(header) + 8 * len(places), []
    for start, end in places:
        table.append(place)
        place += end - start - skip
    target.write(header + struct.pack(f"<{len(table)}Q", *table))
    for start, end in places:
        source.seek(start + skip)
        target.write(source.read(end - start - skip))


def pack_header(attributes: dict[str, tuple[str, bytes]], flags: int = 0) -> bytes:
    """Return the header of a file of one part from type and bytes of each attribute."""
    entries = b"".join(
        f"{name}\0{kind}\0".encode() + struct.pack("<i", len(content)) + content
        for name, (kind, content) in attributes.items()
    )
    return MAGIC + struct.pack("<I", 2 | flags << 8) + entries + b"\0"
