"""How far one sky is from another: chromaticity, spectral shape, luminance, surface colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.sensitivities import cmfs, observer
from spectral_skylight.addon.transfer.measures import to_Lab


def chromaticity(ours: NDArray, theirs: NDArray) -> NDArray[np.float64]:
    """Return the distances in CIE 1976 u'v' between spectra (m, 81), (m,)."""
    return np.linalg.norm(_uv(ours) - _uv(theirs), axis=-1)


def _uv(spectra: NDArray) -> NDArray[np.float64]:
    X, Y, Z = spectra @ cmfs().T if spectra.ndim == 1 else (spectra @ cmfs().T).T
    return np.stack([4 * X, 9 * Y], axis=-1) / np.asarray(X + 15 * Y + 3 * Z)[..., None]


def shape(ours: NDArray, theirs: NDArray) -> NDArray[np.float64]:
    """Return the rms over bands (m, b) of the difference, each spectrum's mean being 1, (m,)."""
    ours, theirs = (spectra / spectra.mean(axis=1, keepdims=True) for spectra in (ours, theirs))
    return np.sqrt(np.mean((theirs - ours) ** 2, axis=1))


def luminance(ours: NDArray, theirs: NDArray) -> tuple[float, float]:
    """Return theirs over ours, as a mean over directions and as the scatter about it (one sigma).

    Both are of the logarithm: 1.0 and 0.0 for the same sky.
    """
    ratio = np.log((theirs @ cmfs()[1]) / (ours @ cmfs()[1]))
    return float(np.exp(ratio.mean())), float(ratio.std())


def surface_colours(ours: NDArray, theirs: NDArray) -> NDArray[np.float64]:
    """Return CIEDE2000 of the ColorChecker's colours under one light and the other, (m, 24).

    Each is seen by an eye at home under its own light: Lab white is the perfect diffuser there.
    """
    import colour

    _, rho = colorchecker()
    labs = []
    for light in (ours, theirs):
        light = light / (light @ cmfs()[1])[:, None]
        colours = np.einsum("il,pl,ml->mpi", observer(), rho, light, optimize=True)
        labs.append(to_Lab(colours, (light @ observer().T)[:, None]))
    return colour.delta_E(*labs, method="CIE 2000")
