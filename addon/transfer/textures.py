"""Textures with a spectral meaning: reflectances mixed of three, by each pixel's colour.

A texture holds a colour a pixel, not a reflectance. As a mixture of three basis reflectances that
reproduces this colour under D65 (I. Mallett and C. Yuksel 2019, DOI 10.2312/sr.20191216) each pixel
has one, and as all is linear, its matrix is the same mixture of three matrices.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.datasets import BASIS_REFLECTANCES, dataset
from ..spectra.grid import resample
from ..spectra.working_spaces import DEFAULT_SPACE, XYZ_to_working
from .prediction import rgb_albedo

_DARKEST = 1e-3
"""Under this mean of a channel a texture's colour says nothing about the material's."""


def basis(space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return three reflectances (3, 81) of which ``rgb @ basis()`` is a pixel's, rgb in ``space``.

    Their sum is 1, so that white is 1 and grey is grey; `prediction.rgb_albedo` of the mixture
    is ``rgb``. Mallett and Yuksel's, from colour-science, brought to the grid; for another space
    than Linear Rec.709 mixed accordingly. Colours out of Rec.709's gamut give reflectances under 0
    or over 1: their matrices are right for the colour, and no more. Raises `InputError` for an
    unknown ``space``.
    """
    table = dataset(BASIS_REFLECTANCES, "Mallett 2019")
    reflectances = resample(table.wavelengths, table.values)
    reflectances /= reflectances.sum(axis=0)  # printed to six digits
    # For the space, and for what the grid makes of the paper's own numbers, 1e-4.
    return np.linalg.solve(rgb_albedo(reflectances, space), reflectances)


def carried(
    reflectance: ArrayLike, mean_rgb: ArrayLike, space: str = DEFAULT_SPACE
) -> NDArray[np.float64]:
    """Return the basis (3, 81) of a texture that belongs to a measured material.

    ``rgb @ carried(...)``: at the texture's mean colour ``mean_rgb`` (3,), linear in ``space``, it
    is the measured ``reflectance`` (81,); a brighter or darker pixel's is that times as much. A
    pixel of another colour has that colour's change: channel by channel the texture is brought to
    the measured colour, and what the measurement has and its colour does not tell, its metameric
    black, goes with the luminance. A channel that the texture lacks in the mean keeps its size.
    Raises `InputError` for an unknown ``space``.
    """
    rho = np.asarray(reflectance, dtype=float)
    mean = np.asarray(mean_rgb, dtype=float)
    plain, measured = basis(space), rgb_albedo(rho, space)
    black = rho - measured @ plain
    # Where the measured colour itself is black, there is no luminance for it to go with.
    Y = np.linalg.inv(XYZ_to_working(space))[1]
    share = Y / max(float(Y @ measured), 1e-9)
    gain = np.where(mean > _DARKEST, measured / np.maximum(mean, _DARKEST), 1.0)
    return gain[:, None] * (plain + np.outer(share, black))
