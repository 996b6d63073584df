"""The spectrum of a wanted colour that is nearest to an expected one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .grid import WAVELENGTHS

_ENOUGH = 1e-10
"""Relative error of the colour at which the search ends."""

_STEPS, _HALVINGS = 60, 30

_MIDDLE, _WIDTH = 545.0, 80.0
"""[nm] of the curve from wavelengths to places from -1 to 1, flat where the eye sees little.
Of middles from 530 to 560 and widths from 60 to 120 among the best for light from ground, checker
patches and measured objects alike, and half as far off as the observer's own curves."""


def spectrum_with_colour(
    expected: NDArray[np.float64], rgb: ArrayLike, S: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Return a positive spectrum (81,) with ``S @ spectrum = rgb`` that is like another.

    It is ``expected`` (81,), which is positive, times a smooth factor: the exponential of a
    parabola over the wavelength, flattened at both ends. So the lines and bands of ``expected``
    stay. Where no such factor makes the colour, of lights near a single wavelength, it is the
    exponential of a mixture of the sensitivities S (3, 81), the nearest spectrum by relative
    entropy (I. Csiszár 1975, DOI 10.1214/aop/1176996454). None where no light has this colour.
    """
    rgb = np.asarray(rgb, dtype=float)
    # Channels of one size, for the numbers' sake alone.
    size = np.abs(S).sum(axis=1, keepdims=True)
    S, rgb = S / size, rgb / size[:, 0]
    largest = np.abs(rgb).max()
    if not np.isfinite(rgb).all() or largest <= 0 or not (expected > 0).all():
        return None
    start = expected / np.abs(S @ expected).max()
    place = np.tanh((WAVELENGTHS - _MIDDLE) / _WIDTH)
    smooth = np.stack([np.ones_like(place), place, place**2])
    for functions in (smooth, S):
        found = _search(start, rgb / largest, S, functions)
        if found is not None:
            return found * largest
    return None


def _search(
    start: NDArray, rgb: NDArray, S: NDArray, functions: NDArray
) -> NDArray[np.float64] | None:
    """Return ``start`` times the exponential of a mixture of functions (3, 81), or None.

    Newton's steps, each halved until the colour comes nearer.
    """
    mixture, spectrum = np.zeros(3), start
    for _ in range(_STEPS):
        missing = rgb - S @ spectrum
        left = np.linalg.norm(missing)
        if np.abs(missing).max() < _ENOUGH:
            return spectrum
        try:
            step = np.linalg.solve((S * spectrum) @ functions.T, missing)
        except np.linalg.LinAlgError:
            return None
        for _ in range(_HALVINGS):
            exponent = (mixture + step) @ functions
            if exponent.max() < 50.0:
                candidate = start * np.exp(exponent)
                if np.linalg.norm(rgb - S @ candidate) < left:
                    break
            step = step / 2.0
        else:
            return None
        mixture, spectrum = mixture + step, candidate
    return None
