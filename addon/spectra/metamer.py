"""The spectrum of a wanted colour that is nearest to an expected one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

_ENOUGH = 1e-10
"""Relative error of the colour at which the search ends."""

_STEPS = 60


def with_colour(
    expected: NDArray[np.float64], rgb: ArrayLike, S: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Return the positive spectrum (81,) with ``S @ spectrum = rgb`` that is nearest to another.

    Nearest by relative entropy: the spectrum is ``expected`` times the exponential of a mixture of
    the sensitivities ``S`` (3, 81), so it keeps the lines and bands of ``expected`` (81,), which
    is positive, and changes only where S sees (I. Csiszár 1975, DOI 10.1214/aop/1176996454).
    None where no light has such a colour, or only one of a few wavelengths.
    """
    rgb = np.asarray(rgb, dtype=float)
    # Channels of one size, and the spectrum of the wanted one, for the numbers' sake alone.
    size = np.abs(S).sum(axis=1, keepdims=True)
    S, rgb = S / size, rgb / size[:, 0]
    largest = np.abs(rgb).max()
    seen = S @ expected
    if not np.isfinite(rgb).all() or largest <= 0 or not (expected > 0).all():
        return None
    scale = largest / np.abs(seen).max()
    spectrum, rgb = expected * scale / largest, rgb / largest
    start = spectrum
    mixture = np.zeros(3)
    # Newton's steps on the convex dual, sum(start exp(S^T c)) - c rgb, halved until it falls.
    value = start.sum() - mixture @ rgb
    for _ in range(_STEPS):
        missing = rgb - S @ spectrum
        if np.abs(missing).max() < _ENOUGH:
            return spectrum * largest
        try:
            step = np.linalg.solve((S * spectrum) @ S.T, missing)
        except np.linalg.LinAlgError:
            return None
        for _ in range(30):
            trial = mixture + step
            exponent = trial @ S
            if exponent.max() < 50.0:
                candidate = start * np.exp(exponent)
                lower = candidate.sum() - trial @ rgb
                if lower <= value + 1e-12 * abs(value):
                    break
            step = step / 2.0
        else:
            return None
        mixture, spectrum, value = trial, candidate, lower
    return None
