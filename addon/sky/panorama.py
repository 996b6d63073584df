"""Skies as lat-long panoramas: reading, checking, writing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .clear_sky import WHITE_LUMINANCE
from .declared_colours import Declared
from .exr_file import Decode, decode_by_openexr, read_exr
from .exr_header import AGAIN, MAGIC, read_header
from .exr_spectral import read_spectra
from .exr_writer import write_exr
from .file_claims import check_shape, regular_size
from .header_notes import said_by
from .known_spectrum import KnownSpectrum
from .radiance_hdr import is_spectral, read_radiance
from .radiance_hsr import read_hsr
from .spectral_layout import find_spectra
from .spectral_panorama import check_wavelengths, spectral_sky, to_grid

LARGEST_HALF = 65504.0
"""What infinite light is set to, unless there is more in the same sky: half floats end here."""


@dataclass(frozen=True)
class Panorama:
    """A checked lat-long sky: 2:1, finite, nowhere negative, not all black."""

    rgb: NDArray[np.float32]
    """Linear radiance, (h, 2 h, 3); row 0 at the zenith, column 0 at azimuth 180°."""
    name: str
    """File name, or what Blender calls the image."""
    metadata: dict[str, Any] = field(default_factory=dict)
    """What the file's header says, unconverted."""
    negatives: int = 0
    """Count of negative values that were set to zero."""
    notes: tuple[str, ...] = ()
    """What was done to the numbers, or should be known of them, a sentence each."""
    space: str = ""
    """Blender's name of the colour space whose numbers, as stored, are this sky; empty where no
    space is enough: a layer was chosen, or values were changed or filled in."""
    spectrum: KnownSpectrum | None = None
    """Its spectra, where they are known."""


def read_panorama(
    path: str | Path, raw: bool = False, decode: Decode = decode_by_openexr
) -> Panorama:
    """Read a sky from an OpenEXR (``.exr``) or Radiance (``.hdr``, ``.hsr``) file, Linear Rec.709.

    Of spectra it is what the standard observer sees of them, and they come along.
    The content decides, not the ending. Other primaries that the header names are converted, and
    what it says that the channels were multiplied by (``COLORCORR``) is divided out. The numbers of
    a ``raw`` sky are a camera's, whatever primaries its header names. ``decode``: what unpacks
    OpenEXR; inside Blender that is Blender.

    Raises
    ------
    InputError
        When there is no such file, it is of another kind (8-bit ones are named), cut short,
        or not a sky: see `from_pixels`.
    """
    path = Path(path)
    size = regular_size(path)
    try:
        with path.open("rb") as file:
            magic = file.read(16)
        if magic.startswith(MAGIC) and (spectral := _of_exr(path, size, decode)) is not None:
            return spectral
        if magic.startswith(MAGIC):
            rgb, metadata = read_exr(path, size, decode)
        elif magic.startswith(b"#?") and is_spectral(path):
            return _of_hsr(path)
        elif magic.startswith(b"#?"):
            rgb, metadata = read_radiance(path)
        elif not magic:
            raise InputError(path, "is empty", AGAIN)
        else:
            raise InputError(path, *_other_kind(magic))
    except OSError as error:
        raise InputError(path, f"cannot be opened ({error.strerror})", "check the path") from None
    except MemoryError:
        raise InputError(path, "is too large for the memory", "use a smaller one") from None
    said = said_by(metadata, path)
    infinite = _clip_infinite(rgb)
    _convert(rgb, said.declared, raw)
    sky = from_pixels(rgb, str(path), metadata)
    notes = [
        *said.declared.told,
        *([said.layer] if said.layer else []),
        *([f"{said.primaries}: converted"] if said.primaries and not raw else []),
        *([f"{said.factors}: that is divided out"] if said.factors else []),
        *([_cropped(said.black)] if said.black else []),
        *([_infinite(infinite)] if infinite else []),
    ]
    as_stored = not (said.layer or said.factors or said.black or infinite)
    as_stored &= metadata.get("one_letter", True)
    space = "Non-Color" if raw else said.declared.space
    space = space if as_stored else ""
    return replace(sky, notes=tuple(notes), space=space, spectrum=said.spectrum)


def _of_exr(path: Path, size: int, decode: Decode) -> Panorama | None:
    """Return the sky of an OpenEXR file of spectra, None of any other."""
    with path.open("rb") as file:
        layout = find_spectra(read_header(file, size, path), path)
    if layout is None:
        return None
    check_wavelengths(layout.wavelengths, path)
    samples = read_spectra(path, size, layout, decode)
    header = dict(layout.part.attributes)
    if layout.absolute:
        header["whiteLuminance"] = WHITE_LUMINANCE
    onto = to_grid(layout.wavelengths) @ layout.sharpen
    return _spectral(path, samples, onto, layout.notes, header)


def _of_hsr(path: Path) -> Panorama:
    """Return the sky of a hyperspectral picture of Radiance."""
    radiance, wavelengths, header, notes = read_hsr(path)
    check_wavelengths(wavelengths, path)
    header["whiteLuminance"] = WHITE_LUMINANCE
    return _spectral(path, radiance, to_grid(wavelengths), notes, header)


def _spectral(
    path: Path,
    samples: NDArray[np.float32],
    onto: NDArray[np.float64],
    notes: Sequence[str],
    header: Mapping[str, Any],
) -> Panorama:
    """Return a sky of spectra (h, w, n) as the observer sees it, in Linear Rec.709."""
    rgb, spectrum = spectral_sky(samples, onto, path)
    sky = from_pixels(rgb, str(path), header)
    return replace(sky, notes=(*notes, *sky.notes), spectrum=spectrum)


def _convert(rgb: NDArray[np.float32], said: Declared, raw: bool) -> None:
    """Undo what a header says, in place: factors first, for they were applied last."""
    matrix = np.eye(3) if said.to_rec709 is None or raw else said.to_rec709
    if said.factors is not None:
        matrix = matrix / said.factors
    if np.array_equal(matrix, np.eye(3)):
        return
    to_rec709 = matrix.T.astype(np.float32)
    with np.errstate(over="ignore", invalid="ignore"):  # `from_pixels` finds what overflows
        for row in range(0, len(rgb), 256):
            rgb[row : row + 256] = rgb[row : row + 256] @ to_rec709


def _clip_infinite(rgb: NDArray[np.float32]) -> int:
    """Set infinite values to the largest that a half float or this sky holds; return how many."""
    infinite, most = 0, LARGEST_HALF
    for row in range(0, len(rgb), 256):
        band = rgb[row : row + 256]
        endless = np.isposinf(band)
        infinite += int(np.count_nonzero(endless))
        most = max(most, float(np.max(band, initial=0.0, where=np.isfinite(band))))
    for row in range(0, len(rgb) if infinite else 0, 256):
        band = rgb[row : row + 256]
        band[np.isposinf(band)] = most
    return infinite


def _cropped(black: float) -> str:
    return f"the file is cropped: {100 * black:.0f} % of the panorama is black"


def _infinite(count: int) -> str:
    return (
        f"{count} infinite value(s), brighter than half floats hold, were clipped: the sun was "
        "brighter than that"
    )


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
        return "is a TIFF, which cannot be read", "save it as .exr if it is linear float"
    if kind:
        return f"is a {kind}: its light is tone-mapped and clipped at white", cure
    return "is neither OpenEXR nor Radiance (.hdr), or its beginning is damaged", cure


def from_pixels(rgb: ArrayLike, name: str, metadata: Mapping[str, Any] | None = None) -> Panorama:
    """Check pixels that are to be a sky; set negative values to zero and clip infinite ones.

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
        When it is not 2:1 (cube maps are named), holds NaN, or is black all over.
    """
    pixels = np.asarray(rgb)
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise InputError(name, f"has shape {pixels.shape}, not (h, w, 3)", "pass RGB pixels")
    height, width = pixels.shape[:2]
    check_shape(name, width, height)
    if pixels.dtype != np.float32 or not pixels.flags.writeable:
        pixels = pixels.astype(np.float32)
    infinite = _clip_infinite(pixels)
    bad, first, negatives, brightest = 0, (0, 0), 0, 0.0
    for row in range(0, height, 256):  # in bands: masks of a 16k sky are large themselves
        band = pixels[row : row + 256]
        wrong = np.isnan(band).any(axis=2)
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
        problem = f"{bad} pixels are NaN, the first at x = {first[0]}, y = {first[1]} from"
        raise InputError(name, f"{problem} the top left", "repair them in a picture editor")
    if brightest <= 0.0:
        raise InputError(name, "is completely black", "choose a sky that holds light")
    notes = (_infinite(infinite),) if infinite else ()
    return Panorama(pixels, name, dict(metadata or {}), negatives, notes)


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
