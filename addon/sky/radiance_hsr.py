"""Radiance's hyperspectral pictures (``.hsr``): n components a pixel with one exponent for all.

A header as of ``.hdr`` with ``FORMAT=Radiance_spectra``, ``NCOMP`` and ``WAVELENGTH_SPLITS``, four
wavelengths of which the first and the last are the ends of the components' range; then each pixel
as n + 1 bytes, never packed. Written by `genssky`, `rtrace` and `rpict` since Radiance 6:
https://radsite.lbl.gov/radiance/refer/filefmts.pdf and the manual pages.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .exr_header import AGAIN
from .exr_layers import shown
from .file_claims import check_size
from .radiance_hdr import SPECTRA, parse_header
from .spectral_panorama import check_amount

_SPLITS = "780 588 480 380"
"""[nm], which Radiance takes where the header says nothing: long waves come first."""

_COMPONENTS = 4, 400

GENSSKY = (
    "laid out as by genssky, whose azimuths grow from left to right: mirrored to where the sky is"
)


def read_hsr(
    path: Path,
) -> tuple[NDArray[np.float32], NDArray[np.float64], dict[str, Any], list[str]]:
    """Read a hyperspectral picture.

    Returns radiance (h, w, n) [W m^-2 sr^-1 nm^-1], row 0 at the top; wavelengths (n,) [nm],
    ascending; the header; and what was done, a sentence each. An ``EXPOSURE`` is divided out, and
    `genssky`'s layout is brought to that of other panoramas: it looks from outside, and its first
    and last rows and columns are the poles and the seam themselves.

    Raises
    ------
    InputError
        When the header is damaged, names no components or wavelengths that neither ascend nor
        descend, the picture is not 2:1, or pixels are missing.
    """
    data = path.read_bytes()
    height, width, flip_y, flip_x, header, start = parse_header(path, data)
    if header.get("FORMAT") != SPECTRA:
        raise InputError(path, "is no spectral picture", "give an .hsr with FORMAT=" + SPECTRA)
    count = _count(header.get("NCOMP"), path)
    ends = _ends(header.get("WAVELENGTH_SPLITS", _SPLITS), path)
    check_size(path, (width, height), 4 * count * width * height, len(data))
    check_amount(path, (width, height), count)
    line = width * (count + 1)
    if len(data) - start < height * line:
        whole = (len(data) - start) // line
        raise InputError(path, f"ends early: scanline {whole + 1} of {height} is cut short", AGAIN)
    pixels = np.frombuffer(data, np.uint8, height * line, start).reshape(height, width, count + 1)
    pixels = pixels[:: -1 if flip_y else 1, :: -1 if flip_x else 1]
    # The middle of what each byte stands for, as Radiance reads them, over the whole range.
    scale = np.ldexp(1.0, pixels[..., -1].astype(int) - 136) / abs(ends[1] - ends[0])
    scale = (np.where(pixels[..., -1] > 0, scale, 0.0) / _exposure(header)).astype(np.float32)
    radiance = (pixels[..., :-1] + np.float32(0.5)) * scale[..., None]
    middles = ends[0] + (np.arange(count) + 0.5) / count * (ends[1] - ends[0])
    if ends[1] < ends[0]:
        radiance, middles = radiance[..., ::-1], middles[::-1]
    notes = []
    if _is_of_genssky(pixels):
        notes.append(GENSSKY)
        radiance = _between(_between(radiance[:, ::-1], 0), 1)
    return np.ascontiguousarray(radiance), middles, header, notes


def _count(text: object, path: Path) -> int:
    try:
        count = int(str(text))
    except ValueError:
        count = 0
    low, high = _COMPONENTS
    if not low <= count <= high:
        told = "does not say how many components it has" if text is None else f"has NCOMP={text}"
        told = shown([told])
        raise InputError(path, f"{told}", f"save it with NCOMP of {low} to {high}")
    return count


def _ends(text: object, path: Path) -> tuple[float, float]:
    """Return the wavelengths [nm] at which the components begin and end."""
    try:
        splits = np.array([float(part) for part in str(text).split()])
    except ValueError:
        splits = np.zeros(0)
    steps = np.diff(splits)
    alike = (steps > 0).all() or (steps < 0).all()
    if splits.size != 4 or not np.isfinite(splits).all() or not alike or splits.min() < 100.0:
        raise InputError(
            path,
            f"has WAVELENGTH_SPLITS={shown([str(text)])}, which are not four wavelengths in order",
            f"save it with splits in nm, such as {_SPLITS}",
        )
    return float(splits[0]), float(splits[-1])


def _exposure(header: dict[str, Any]) -> float:
    """Take what all values were multiplied by out of a header; 1 where nothing sane is said."""
    found = header.pop("EXPOSURE", ())
    product = 1.0
    for text in found if isinstance(found, tuple) else (found,):
        try:
            product *= float(text)
        except ValueError:
            return 1.0
    return product if 0.0 < product < np.inf else 1.0


def _is_of_genssky(pixels: NDArray[np.uint8]) -> bool:
    """Whether poles and seam are pixels of their own, which they are in no other panorama."""
    poles = (pixels[0] == pixels[0, 0]).all() and (pixels[-1] == pixels[-1, 0]).all()
    return bool(poles and (pixels[:, 0] == pixels[:, -1]).all())


def _between(values: NDArray[np.float32], axis: int) -> NDArray[np.float32]:
    """Return samples whose first and last lie on the edges as means of as many even parts."""
    count = values.shape[axis]
    at = (np.arange(count) + 0.5) / count * (count - 1)
    low = np.minimum(at.astype(int), count - 2)
    share = (at - low).reshape([-1 if k == axis else 1 for k in range(values.ndim)])
    first, second = (np.take(values, low + k, axis) for k in (0, 1))
    return (first + share * (second - first)).astype(np.float32)
