"""What a sky's header says of its numbers, as sentences for a person."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, BinaryIO

from ..errors import InputError
from .declared_colours import Declared, declared
from .exr_file import look
from .exr_header import AGAIN, MAGIC, read_header
from .exr_layers import shown
from .known_spectrum import ATTRIBUTE, KnownSpectrum
from .radiance_hdr import SPECTRA, read_radiance_header
from .spectral_layout import find_spectra


@dataclass(frozen=True)
class Said:
    """What is said: of colours, and a sentence on each other thing, empty where there is none.

    ``black``: which part (0 to 1) of the panorama a cropped file leaves black; ``spectrum``: the
    sky's spectra, where the header holds them.
    """

    declared: Declared
    layer: str
    primaries: str
    factors: str
    black: float
    white_luminance: float | None = None
    """[cd/m²] of (1, 1, 1), OpenEXR's ``whiteLuminance``; None where it is not said."""
    spectrum: KnownSpectrum | None = None
    in_channels: bool = False
    """Whether the pixels themselves are spectra, of which Blender shows three channels or none."""


def said_by(header: Mapping[str, Any], place: object) -> Said:
    """Return what a header says; raises `InputError` as `declared` does."""
    found = declared(header, place)
    layers, name = header.get("layers", 1), shown([str(header.get("layer", ""))])
    layer = primaries = factors = ""
    if name or layers > 1:
        layer = f"the layer {name} is read" if name else "the layer without a name is read"
        layer += f", of {layers} layers" if layers > 1 else ""
    if header.get("channels") == "XYZ":
        primaries = "its channels are X, Y, Z"
    elif found.to_rec709 is not None:
        called = f" ({found.space})" if found.space else ""
        primaries = f"its header names other primaries than Rec.709{called}"
    if found.factors is not None:
        values = ", ".join(f"{factor:.4g}" for factor in found.factors)
        factors = (
            f"its header says that red, green and blue were multiplied by {values} (COLORCORR)"
        )
    white = header.get("whiteLuminance")
    if not isinstance(white, int | float) or not 0.0 < white < math.inf:
        white = None
    spectrum = None
    if isinstance(text := header.get(ATTRIBUTE), str):
        spectrum = KnownSpectrum.from_text(text)
        if spectrum is None:
            told = "the spectra in its header are damaged, or of a later version: not used"
            found = replace(found, told=(*found.told, told))
    return Said(found, layer, primaries, factors, header.get("black", 0.0), white, spectrum)


def read_said(file: BinaryIO, size: int, place: object) -> Said:
    """Return what the header of an open OpenEXR or Radiance file of ``size`` bytes says.

    Raises `InputError` where that cannot be read.
    """
    magic = file.read(len(MAGIC))
    file.seek(0)
    if magic == MAGIC:
        layout = find_spectra(read_header(file, size, place), place)
        if layout is not None:
            return replace(said_by({}, place), in_channels=True)
        file.seek(0)
        return said_by(look(file, size, place)[2], place)
    if magic.startswith(b"#?"):
        header = read_radiance_header(file, size, place)
        return replace(said_by(header, place), in_channels=header.get("FORMAT") == SPECTRA)
    raise InputError(place, "is neither OpenEXR nor Radiance (.hdr)", AGAIN)
