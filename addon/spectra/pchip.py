"""Monotone piecewise cubics: curves through samples that never overshoot them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def pchip(
    x: NDArray[np.float64], y: NDArray[np.float64], at: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the monotone cubic through samples y (k,) or (k, m) at places, (n,) or (n, m).

    ``x`` (k,) strictly increasing, k >= 2; ``at`` (n,) inside it. Fritsch and Butland 1984
    (DOI 10.1137/0905021), ends as in Moler 2004 (DOI 10.1137/1.9780898717952): what SciPy's
    ``PchipInterpolator`` computes.
    """
    h = np.diff(x).reshape(-1, *[1] * (y.ndim - 1))
    secants = np.diff(y, axis=0) / h
    slopes = _slopes(h, secants)
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    s = (at - x[k]).reshape(-1, *h.shape[1:]) / h[k]
    # Hermite's form, its terms in the order of their size: y + h s (d + s (c + s b)).
    c = 3.0 * secants[k] - 2.0 * slopes[k] - slopes[k + 1]
    b = slopes[k] + slopes[k + 1] - 2.0 * secants[k]
    return y[k] + h[k] * s * (slopes[k] + s * (c + s * b))


def _slopes(h: NDArray[np.float64], secants: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slopes (k, ...) at samples by the widths and slopes (k - 1, ...) between them."""
    if len(secants) == 1:
        return np.concatenate([secants, secants])
    before, after = secants[:-1], secants[1:]
    w_before, w_after = h[:-1] + 2.0 * h[1:], 2.0 * h[:-1] + h[1:]
    turns = np.sign(before) * np.sign(after) <= 0
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (w_before + w_after) / (w_before / before + w_after / after)
    first = _end(h[0], h[1], secants[0], secants[1])
    last = _end(h[-1], h[-2], secants[-1], secants[-2])
    return np.concatenate([first[None], np.where(turns, 0.0, mean), last[None]])


def _end(h_0: NDArray, h_1: NDArray, secant_0: NDArray, secant_1: NDArray) -> NDArray[np.float64]:
    """Return the slope at an end: of the parabola through three samples, kept monotone."""
    slope = ((2.0 * h_0 + h_1) * secant_0 - h_0 * secant_1) / (h_0 + h_1)
    turns = np.sign(secant_0) != np.sign(secant_1)
    slope = np.where(turns & (np.abs(slope) > 3.0 * np.abs(secant_0)), 3.0 * secant_0, slope)
    return np.where(np.sign(slope) != np.sign(secant_0), 0.0, slope)
