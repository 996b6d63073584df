"""Smooth metals: what they mirror at every angle, from n and k, and as colours for a shader."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.working_spaces import DEFAULT_SPACE
from .prefilter import prefiltered

EDGE = 1.0 / 7.0
"""Cosine of the angle, 82°, at which Schlick's curve is furthest from a metal's."""


def conductor(n: ArrayLike, k: ArrayLike, cosine: ArrayLike = 1.0) -> NDArray[np.float64]:
    """Return what smooth matter in air mirrors of unpolarised light, (..., 81), from 0 to 1.

    Fresnel's equations for the index n + ik, (81,) each, and the cosine (...) of the angle to
    the normal, 0 to 1. With k = 0 it is a dielectric's first surface. M. Born and E. Wolf,
    "Principles of Optics" (DOI 10.1017/CBO9781139644181), section 14.2.
    """
    cosine = np.asarray(cosine, dtype=float)[..., None]
    index = np.asarray(n, dtype=float) + 1j * np.asarray(k, dtype=float)
    inside = np.sqrt(index**2 - (1.0 - cosine**2))
    s = (cosine - inside) / (cosine + inside)
    p = (index**2 * cosine - inside) / (index**2 * cosine + inside)
    return 0.5 * (np.abs(s) ** 2 + np.abs(p) ** 2)


def tints(
    n: ArrayLike, k: ArrayLike, spectrum: ArrayLike, space: str = DEFAULT_SPACE
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return a metal's F0 (3,) and edge tint (3,) under a light (81,), RGB in ``space``.

    For Blender's Metallic and Principled shaders: colours over that of the light, so that a metal
    mirrors this very light rightly at 0° and at 82°. Blender cuts them off at 0 and 1; some metals
    leave Rec.709 a little. Raises `InputError` for an unknown ``space``.
    """
    F0, at_edge = prefiltered(np.stack([conductor(n, k), conductor(n, k, EDGE)]), spectrum, space)
    return F0, at_edge / (F0 + (1.0 - F0) * (1.0 - EDGE) ** 5)
