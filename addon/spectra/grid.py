"""The wavelength grid that every spectrum of this package is sampled on, and the ways onto it.

A spectrum on the grid holds one mean per node under the node's *hat* (the triangle that falls to
zero at the two neighbours). For sensitivities and reflectances that are straight between nodes
the weighted sum of products is then the exact integral, Fraunhofer lines of the sun included,
where point samples of a line spectrum would alias by several per cent.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .pchip import pchip
from .sorting import distinct, median

STEP = 5.0
"""Distance between nodes [nm]."""

WAVELENGTHS: NDArray[np.float64] = np.arange(380.0, 780.0 + STEP, STEP)
"""The n = 81 nodes [nm], 380 to 780."""

WEIGHTS: NDArray[np.float64] = np.full(WAVELENGTHS.size, STEP)
"""Quadrature weights [nm]: the integrals of the hats, half a step at both ends."""
WEIGHTS[[0, -1]] = STEP / 2


def band_average(wavelengths: ArrayLike, values: ArrayLike) -> NDArray[np.float64]:
    """Average a finely sampled spectrum under the hat of every node of the grid.

    Parameters
    ----------
    wavelengths
        Sample positions [nm], strictly increasing, (k,). Outside them the end values are held.
    values
        Samples, straight lines between them, (k,) or (k, m).

    Returns
    -------
    Means under the hats, (81,) or (m, 81): exact for the piecewise linear curve.
    """
    x = np.asarray(wavelengths, dtype=float)
    y = np.asarray(values, dtype=float)
    fine = distinct(np.concatenate([x, WAVELENGTHS]))[0]
    fine = fine[(fine >= WAVELENGTHS[0]) & (fine <= WAVELENGTHS[-1])]
    curves = np.stack([np.interp(fine, x, column) for column in np.atleast_2d(y.T)], axis=1)
    # Between fine nodes both hat and curve are straight: their product integrates exactly to
    # d/6 (2 h0 y0 + 2 h1 y1 + h0 y1 + h1 y0).
    hats = np.clip(1.0 - np.abs(fine[:, None] - WAVELENGTHS) / STEP, 0.0, None)
    half = np.diff(fine)[:, None] / 6.0
    lower, upper = hats[:-1] * half, hats[1:] * half
    means = (
        (2.0 * lower + upper).T @ curves[:-1] + (lower + 2.0 * upper).T @ curves[1:]
    ) / WEIGHTS[:, None]
    return means[:, 0] if y.ndim == 1 else means.T


def resample(wavelengths: ArrayLike, values: ArrayLike) -> NDArray[np.float64]:
    """Bring a smooth spectrum to the grid.

    Samples at least half a step apart are joined by monotone cubics (`pchip`), which never
    overshoot a step or leave 0 to 1; denser ones are averaged with `band_average`, so that
    instrument noise is not sampled at random.

    Parameters
    ----------
    wavelengths
        Sample positions [nm], strictly increasing, (k,), k >= 2.
    values
        Samples, (k,) or (k, m).

    Returns
    -------
    Values on the grid, (81,) or (m, 81). Outside the samples the end values are held.
    """
    x = np.asarray(wavelengths, dtype=float)
    y = np.asarray(values, dtype=float)
    inside = (x >= WAVELENGTHS[0]) & (x <= WAVELENGTHS[-1])
    if median(np.diff(x[inside] if inside.sum() > 1 else x)) < STEP / 2:
        return band_average(x, y)
    return pchip(x, y, np.clip(WAVELENGTHS, x[0], x[-1])).T
