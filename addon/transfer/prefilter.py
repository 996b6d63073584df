"""Reflectance under light of one known spectrum: three numbers a material, and exact.

A sun or lamp brightens and dims but keeps its spectrum, so that the colour of a material under it
is one colour times a number. As an albedo, a colour over that of the light itself, it is what
Ward and Eydelberg-Vileshin prefilter (2002, DOI 10.2312/EGWR/EGWR02/117-124).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.sensitivities import observer
from ..spectra.working_spaces import DEFAULT_SPACE
from .matrices import Transfer

_LEAST = 0.01
"""A channel of a light counts as at least this part of its largest: a quotient of two small numbers
would be as large as it likes."""


def prefiltered(
    reflectances: ArrayLike, spectrum: ArrayLike, space: str = DEFAULT_SPACE
) -> NDArray[np.float64]:
    """Return ``a`` (m, 3) of reflectances (m, 81) under a light: ``a * light_rgb`` is their colour.

    (3,) for one reflectance (81,). ``spectrum`` (81,): the light's, of any size. Linear in the
    reflectance; exact, for colours out of gamut too, where entries may be negative or over 1. 0
    under a spectrum of zeros. Raises `InputError` for an unknown ``space``.
    """
    S = observer(space) * np.asarray(spectrum, dtype=float)
    light = light_rgb(spectrum, space)
    return np.asarray(reflectances, dtype=float) @ S.T / np.where(light == 0, 1.0, light)


def light_rgb(spectrum: ArrayLike, space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return what `prefiltered` is relative to, (3,): the light's RGB in ``space``.

    Never negative: a channel of a light out of gamut counts by its size, at least as a hundredth
    of the largest. Irradiance / pi where the spectrum is. Use it, and not the light's RGB in the
    HDRI, as the colour to multiply by.
    """
    rgb = observer(space) @ np.asarray(spectrum, dtype=float)
    return np.maximum(np.abs(rgb), _LEAST * rgb.max())


def balanced_rgb(spectrum: ArrayLike, mapping: Transfer) -> NDArray[np.float64]:
    """Return `light_rgb` as the scene under ``mapping`` has it, (3,).

    That is in its working space, and over the white where the HDRI was balanced; the spectrum is
    in units of the HDRI before that, as `sky.direct_sun.restored_sun` gives it.
    """
    return light_rgb(spectrum, mapping.space) / mapping.neutral
