"""Skies as lat-long panoramas: reading, checking, writing, and where each pixel looks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .exr_file import read_exr, write_exr
from .radiance_hdr import read_radiance

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Luminance weights of linear Rec.709 (ITU-R BT.709-6)."""


@dataclass(frozen=True)
class Panorama:
    """A checked lat-long sky: 2:1, finite, nowhere negative, not all black."""

    rgb: NDArray[np.float32]
    """Linear radiance, (h, 2 h, 3), as stored; row 0 at the zenith, column 0 at azimuth 180°."""
    name: str
    """File name, or what Blender calls the image."""
    metadata: dict[str, Any] = field(default_factory=dict)
    """What the file's header says, unconverted."""
    negatives: int = 0
    """Count of negative values that were set to zero."""


def read_panorama(path: str | Path) -> Panorama:
    """Read a sky from an OpenEXR (``.exr``) or Radiance (``.hdr``) file.

    The content decides, not the ending. While reading, less than twice the size of the result
    is held in memory.

    Raises
    ------
    InputError
        When there is no such file, it is of another kind (8-bit ones are named), cut short,
        or not a sky: see `from_pixels`.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            magic = file.read(16)
    except FileNotFoundError:
        raise InputError(path, "there is no such file", "check the path") from None
    except OSError as error:
        raise InputError(path, f"cannot be opened ({error.strerror})", "check the path") from None
    if magic.startswith(b"\x76\x2f\x31\x01"):
        rgb, metadata = read_exr(path)
    elif magic.startswith(b"#?"):
        rgb, metadata = read_radiance(path)
    elif not magic:
        raise InputError(path, "is empty", "copy or download the file again")
    else:
        raise InputError(path, *_other_kind(magic))
    return from_pixels(rgb, str(path), metadata)


def _other_kind(magic: bytes) -> tuple[str, str]:
    """Name a file's kind by its first bytes, and say why it will not do and what would."""
    kinds = {
        "PNG": magic.startswith(b"\x89PNG"),
        "JPEG": magic.startswith(b"\xff\xd8\xff"),
        "WebP": magic[8:12] == b"WEBP",
        "BMP": magic.startswith(b"BM"),
        "TIFF": magic.startswith((b"II*\0", b"MM\0*")),
    }
    kind = next((kind for kind, found in kinds.items() if found), "")
    cure = "use the same sky as .exr or .hdr (scene-linear, unclipped)"
    if kind == "TIFF":
        return "is a TIFF, which is not read here", "save it as .exr if it is linear float"
    if kind:
        return f"is a {kind}: its light is tone-mapped and clipped at white", cure
    return "is neither OpenEXR nor Radiance (.hdr), or its beginning is damaged", cure


def from_pixels(rgb: ArrayLike, name: str, metadata: Mapping[str, Any] | None = None) -> Panorama:
    """Check pixels that are to be a sky, and set negative values to zero.

    Parameters
    ----------
    rgb
        Linear radiance, (h, w, 3), row 0 at the top. A writeable float32 array is taken over
        and changed in place; anything else is copied.
    name
        What errors call it.

    Raises
    ------
    InputError
        When it is not 2:1 (cube maps are named), holds NaN or Inf, or is black all over.
    """
    pixels = np.asarray(rgb)
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise InputError(name, f"has shape {pixels.shape}, not (h, w, 3)", "pass RGB pixels")
    height, width = pixels.shape[:2]
    if width != 2 * height or height == 0:
        raise InputError(name, *_wrong_shape(width, height))
    if pixels.dtype != np.float32 or not pixels.flags.writeable:
        pixels = pixels.astype(np.float32)
    bad, first, negatives, brightest = 0, (0, 0), 0, 0.0
    for row in range(0, height, 256):  # in bands: masks of a 16k sky are large themselves
        band = pixels[row : row + 256]
        wrong = ~np.isfinite(band).all(axis=2)
        if wrong.any():
            if not bad:
                y, x = np.argwhere(wrong)[0]
                first = (int(x), int(y) + row)
            bad += int(wrong.sum())
            continue
        below = band < 0.0
        if below.any():
            negatives += int(below.sum())
            band[below] = 0.0
        brightest = max(brightest, float(band.max()))
    if bad:
        problem = f"{bad} pixels are NaN or Inf, the first at x = {first[0]}, y = {first[1]} from"
        raise InputError(name, f"{problem} the top left", "repair them in a picture editor")
    if brightest <= 0.0:
        raise InputError(name, "is black all over", "choose a sky that holds light")
    return Panorama(pixels, name, dict(metadata or {}), negatives)


def _wrong_shape(width: int, height: int) -> tuple[str, str]:
    """Say what a picture that is not 2:1 probably is, and what to do about it."""
    size = f"is {width} x {height}"
    if height and (width, height) in [
        (6 * height, height),
        (width, 6 * width),
        (height * 4 // 3, height),
        (width, width * 4 // 3),
    ]:
        return f"{size}, a cube map", "convert it to lat-long (equirectangular, 2:1)"
    return f"{size}, not 2:1 as a lat-long panorama is", "export it as equirectangular, 2:1"


def write_panorama(
    path: str | Path, rgb: ArrayLike, attributes: Mapping[str, Any] | None = None
) -> None:
    """Write (h, w, 3) linear radiance as a float32 OpenEXR file, whole or not at all.

    Raises `InputError` when the place cannot be written to.
    """
    write_exr(Path(path), {"RGB": np.asarray(rgb, np.float32)}, attributes or {})


def write_spectral(
    path: str | Path, radiance: ArrayLike, wavelengths: Sequence[float] | NDArray[np.float64]
) -> None:
    """Write spectral radiance as OpenEXR, one channel a wavelength, whole or not at all.

    Layout: Fichet, Pacanowski and Wilkie, "An OpenEXR Layout for Spectral Images", Journal of
    Computer Graphics Techniques 10(3), 2021: channels ``S0.380,000000nm`` and so on.

    Parameters
    ----------
    radiance
        (h, w, n) [W m^-2 sr^-1 nm^-1]; the layout's unit string leaves the nm^-1 unsaid.
    wavelengths
        (n,) [nm].

    Raises
    ------
    InputError
        When the place cannot be written to.
    """
    radiance = np.asarray(radiance, np.float32)
    if radiance.ndim != 3 or radiance.shape[2] != len(wavelengths):
        raise ValueError(f"radiance {radiance.shape} does not fit {len(wavelengths)} wavelengths")
    channels = {
        f"S0.{wavelength:.6f}nm".replace(".", ",").replace("S0,", "S0."): radiance[..., index]
        for index, wavelength in enumerate(wavelengths)
    }
    attributes = {"spectralLayoutVersion": "1.0", "emissiveUnits": "W.m^-2.sr^-1"}
    write_exr(Path(path), channels, attributes)


def directions(height: int, width: int) -> NDArray[np.float64]:
    """Return where the pixels' centres look in Blender's world, unit vectors (h, w, 3).

    Row 0 is at the zenith; azimuth runs from +180° at the left edge through 0° (+x, east) in the
    middle to -180°, as Blender's equirectangular mapping has it.
    """
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    azimuth = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * np.pi
    result = np.empty((height, width, 3))
    result[..., 0] = np.cos(elevation)[:, None] * np.cos(azimuth)
    result[..., 1] = np.cos(elevation)[:, None] * np.sin(azimuth)
    result[..., 2] = np.sin(elevation)[:, None]
    return result


def solid_angles(height: int, width: int) -> NDArray[np.float64]:
    """Return the exact solid angle of one pixel in each row, (h,) [sr]; all sum to 4 pi / w."""
    edges = np.sin((0.5 - np.arange(height + 1) / height) * np.pi)
    return -np.diff(edges) * (2.0 * np.pi / width)
