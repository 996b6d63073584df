"""Which channels of an OpenEXR file are the sky's colours: the beauty, whatever it is called."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ..errors import InputError
from .exr_header import Channel, Part

BEAUTY = {"combined", "beauty", "rgba", "rgb", "color", "colour", "composite", "main", "final"}
"""What programs call the layer of the whole light, in small letters."""

AUXILIARY = (
    *("ao", "ambient", "albedo", "alpha", "crypto", "denois", "depth", "diff"),
    *("direct", "emi", "gi", "gloss", "id", "index", "indirect", "light", "mask", "mat"),
    *("mist", "motion", "n", "normal", "obj", "p", "pos", "reflect", "refract", "shadow", "spec"),
    *("sss", "subsurface", "trans", "uv", "variance", "vector", "velocity", "vol", "z"),
)
"""How the names of layers start that hold a part of the light or none; short ones are whole."""

COLOURS = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}
TRISTIMULUS = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class Colours:
    """Where a file's colours are.

    ``kind``: "RGB", "XYZ" or "Y"; ``channels``: three, or one of "Y"; ``layer``: its name, empty
    where it has none; ``others``: how many more layers of colours there are.
    """

    part: Part
    kind: str
    channels: tuple[Channel, ...]
    layer: str
    others: int


def find_colours(parts: list[Part], place: object) -> Colours:
    """Return the channels that hold the beauty.

    Before all others comes R, G, B without a layer, then a layer that is called as in `BEAUTY`,
    then the first that is not called as in `AUXILIARY`, then a lone one. X, Y, Z counts where no
    layer holds R, G, B, and a lone Y where none holds X, Y, Z. Small letters count as well. Raises
    `InputError` where there is nothing of the kind, or nothing but several auxiliary layers.
    """
    found = [
        (*_rank(label), order, Colours(part, kind, channels, label, 0))
        for part in parts
        if not part.deep
        for order, (label, kind, channels) in enumerate(_layers(part, len(parts) > 1))
    ]
    for kind in ("RGB", "XYZ", "Y"):
        of_kind = [each for each in found if each[-1].kind == kind]
        if of_kind:
            break
    else:
        raise InputError(place, *_without_colours(parts))
    best = min(of_kind, key=lambda each: each[:2])
    if best[0] == _LAST and len(of_kind) > 1:
        names = shown([each[-1].layer for each in of_kind])
        raise InputError(
            place,
            f"holds the layers {names} and no beauty layer",
            "save only the sky's beauty layer",
        )
    chosen = best[-1]
    return Colours(chosen.part, kind, chosen.channels, chosen.layer, len(of_kind) - 1)


_LAST = 4


def _rank(label: str) -> tuple[int, int]:
    """Return how good a layer's name is, the least being best, and how long it is."""
    words = [word for word in re.split(r"[^a-z0-9]+", label.lower()) if word]
    if not words:
        return 0, 0
    if words[-1] in BEAUTY:
        return 1, 0
    if BEAUTY & {*words}:
        return 2, len(words)
    auxiliary = any(
        word == start or (len(start) > 2 and word.startswith(start))
        for word in words
        for start in AUXILIARY
    )
    return (_LAST if auxiliary else 3), 0


def _layers(part: Part, several: bool) -> list[tuple[str, str, tuple[Channel, ...]]]:
    """Return label, kind and channels of each layer of colours in a part, in the file's order."""
    layers: dict[str, dict[str, Channel]] = {}
    for channel in part.channels:
        if channel.kind and channel.sampling == (1, 1):
            layer, _, component = channel.name.rpartition(".")
            layers.setdefault(layer, {})[component.lower()] = channel
    name = str(part.attributes.get("name", "")) if several else ""
    found: list[tuple[str, str, tuple[Channel, ...]]] = []
    for layer, held in layers.items():
        label = layer if not name or layer.startswith(name) else f"{name}.{layer}".rstrip(".")
        for kind, letters in (("RGB", COLOURS), ("XYZ", TRISTIMULUS)):
            triple = {letters[key]: channel for key, channel in held.items() if key in letters}
            if len(triple) == 3 and (kind == "RGB" or _rank(label)[0] < _LAST):
                found.append((label, kind, (triple[0], triple[1], triple[2])))
                break
        else:
            if "y" in held and not {"ry", "by"} & {c.name.lower() for c in part.channels}:
                found.append((label, "Y", (held["y"],)))
    return found


def _without_colours(parts: list[Part]) -> tuple[str, str]:
    """Say what a file holds that has no colours, and what to do about it."""
    if all(part.deep for part in parts):
        return "holds deep data instead of a flat picture", "flatten it and save it as RGB"
    names = [channel.name for part in parts for channel in part.channels]
    if not any(channel.kind for part in parts for channel in part.channels):
        return f"holds integers: {_some(names)}", "save it as RGB, half or float"
    if sum(bool(re.search(r"\d[\d,.]*nm$", name)) for name in names) > 3:
        cure = "use the sky's RGB file, or convert it to RGB with color matching functions"
        return f"is spectral: {_some(names)}; it has no channels R, G, B but those", cure
    return f"has no channels R, G, B but {_some(names)}", "save it as RGB, half or float"


def _some(names: list[str]) -> str:
    return shown(sorted(names)[:6]) + (", …" if len(names) > 6 else "")


def shown(names: list[str]) -> str:
    """Return names as a line can show them."""
    return ", ".join("".join(c for c in name if c.isprintable())[:60] for name in names)
