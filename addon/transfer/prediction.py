"""How far off RGB times RGB, and our matrix, will be under a given sky.

The HDRI tells a pixel's three numbers, not its spectrum, so the prediction rests on models of
skylight. Our best estimate of the true colour is the matrix itself: from it follows how far RGB
times RGB is off. How far the matrix may be off is what *another* model of skylight makes of the
same three numbers: `rayleigh` against `daylight`, physics against measured days. On 1,076 measured
daylight spectra that difference and the true error have the same mean, 0.18 and 0.17 CIEDE2000.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra import bases
from ..spectra.grid import resample
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import DEFAULT_SPACE
from .matrices import Transfer
from .measures import delta_E


@dataclass(frozen=True)
class Prediction:
    """Predicted CIEDE2000 of each material, means over the given lights, each (m,).

    ``rgb``: today's way, RGB times RGB. ``matrix``: the material matrix. ``colour`` (m, 3):
    what the matrix makes of the first light. ``out_of_gamut`` (m,): whether that colour has a
    negative component, which Blender's emission clamps to 0.
    """

    rgb: NDArray[np.float64]
    matrix: NDArray[np.float64]
    colour: NDArray[np.float64]
    out_of_gamut: NDArray[np.bool_]

    @property
    def known(self) -> bool:
        """Whether there was light to predict from."""
        return bool(np.isfinite(self.matrix).all())


def predict(transfer: Transfer, reflectances: ArrayLike, lights: ArrayLike) -> Prediction:
    """Predict the errors of reflectances (m, 81) under lights (k, 3), RGB irradiances of the HDRI.

    Lights without luminance are left out; without any light the errors are NaN.
    """
    rho = np.atleast_2d(reflectances)
    lights = np.atleast_2d(lights).astype(float)
    colours, white = _reflected(transfer, rho, lights)
    lit = white.sum(axis=-1) > 0
    if not lit.any():
        unknown = np.full(len(rho), np.nan)
        return Prediction(unknown, unknown, colours[0], np.zeros(len(rho), dtype=bool))
    other_colours, _ = _reflected(_other_model(transfer), rho, lights[lit])
    # A raw camera HDRI is developed before anyone multiplies by it: today's way gets that white.
    today = rgb_albedo(rho, transfer.space) * white[lit][:, None]
    seen, white = colours[lit], white[lit][:, None]
    return Prediction(
        rgb=delta_E(today, seen, white, transfer.space).mean(axis=0),
        matrix=delta_E(other_colours, seen, white, transfer.space).mean(axis=0),
        colour=colours[0],
        out_of_gamut=(colours[0] < -1e-6 * np.abs(colours[0]).max(axis=-1, keepdims=True)).any(-1),
    )


def rgb_albedo(reflectances: ArrayLike, space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return the linear RGB (..., 3) of reflectances (..., 81) under D65, white (1, 1, 1).

    It is the base colour that Blender's users type in today. Values out of gamut are kept.
    """
    S = observer(space) * _D65()
    return np.asarray(reflectances) @ S.T / S.sum(axis=1)


def _reflected(
    transfer: Transfer, rho: NDArray[np.float64], lights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the colours (k, m, 3) of the materials and of white (k, 3) under each light."""
    colours = np.einsum("mij,kj->kmi", transfer.matrices(rho), lights)
    return colours, lights @ transfer.to_working.T


def _other_model(transfer: Transfer) -> Transfer:
    other = "daylight" if transfer.basis != "daylight" else "rayleigh"
    return replace(
        transfer, basis=other, restoration=bases.restoration(bases.BASES[other](), transfer.S_in)
    )


@cache
def _D65() -> NDArray[np.float64]:
    from colour.colorimetry import SDS_ILLUMINANTS

    D65 = SDS_ILLUMINANTS["D65"]
    return resample(D65.wavelengths, D65.values)
