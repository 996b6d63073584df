"""How far off RGB times RGB, and our matrices, will be under a given sky.

The HDRI tells three numbers of a light, not its spectrum. What else it may be is known from two
sides. Lights of this sun and this colour are drawn from the simulated ensemble, each moved to the
very three numbers that were seen, so that what is left of it is what they do not tell (a metameric
black: G. Wyszecki 1953). And no simulation knows every air, cloud and sun: each drawn spectrum
gets a smooth error of its own, as large as whole kinds of sky that were left out ask for.

Of a sky whose spectra are known nothing is drawn: they are the light.

A method's error under all of these is then a distribution. Its mean says what to expect, its 95th
percentile what to count on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.cielab import delta_E_2000
from ..spectra.daylight_locus import LIMIT, locus_distance
from ..spectra.ensemble import shipped
from ..spectra.grid import WAVELENGTHS
from ..spectra.illuminants import D65
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import DEFAULT_SPACE, XYZ_to_working
from .known_light import KnownLight
from .matrices import Transfer
from .measures import to_Lab

TODAY, FULL = "RGB × RGB", "3x3"
"""The methods that are always predicted: today's way, and the material matrix."""

_DRAWS = 100
_COVERED = 0.95

_STRANGER = 0.026, 30.0
"""What the ensemble does not know of a spectrum: a smooth relative error, its standard deviation
and its correlation length [nm]. Found by leaving out one kind of sky at a time (measured days,
others' models, our own with other air): with it the bound holds for 95 % of the cases of most."""

_FOREIGN = 0.5
"""How much larger that error is, per part of the light that is no skylight: leaves that give a
third of it leave a full matrix CIEDE2000 1.0 off (see tests/stability)."""


@dataclass(frozen=True)
class Prediction:
    """Predicted CIEDE2000 of each material by method: `TODAY` and the models asked for.

    ``mean`` (m,): over faces and spectra that the lights could have. ``bound`` (m,): a case's error
    is the 95th percentile over its faces; 95 % of the spectra stay under this. NaN where
    ``unknown`` says why nothing can be predicted. ``colour`` (m, 3): what the full matrix makes of
    the first light. ``out_of_gamut`` (m,): whether that colour has a negative component, which
    Blender's emission clamps to 0.
    """

    mean: dict[str, NDArray[np.float64]]
    bound: dict[str, NDArray[np.float64]]
    colour: NDArray[np.float64]
    out_of_gamut: NDArray[np.bool_]
    unknown: str = ""

    @property
    def rgb(self) -> NDArray[np.float64]:
        """Expected error of today's way, (m,)."""
        return self.mean[TODAY]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Expected error of the material matrix, (m,)."""
        return self.mean[FULL]

    @property
    def known(self) -> bool:
        """Whether errors could be predicted."""
        return not self.unknown


def predict(
    transfer: Transfer,
    reflectances: ArrayLike,
    light: KnownLight,
    models: Mapping[str, NDArray[np.float64]] | None = None,
) -> Prediction:
    """Predict the errors of reflectances (m, 81) under a sky's light.

    ``models``: further matrices (m, 3, 3) by name, judged as the full ones are. Lights without
    luminance are left out.
    """
    rho = np.atleast_2d(np.asarray(reflectances, dtype=float))
    lights = light.lights
    matrices = {FULL: transfer.matrices(rho), **(models or {})}
    colour = matrices[FULL] @ lights[0]
    out_of_gamut = (colour < -1e-6 * np.abs(colour).max(axis=-1, keepdims=True)).any(axis=-1)
    to_Y = np.linalg.inv(XYZ_to_working(transfer.space))[1]
    # As it was before it was balanced, whatever the size of the white: what is drawn has 1.
    luminance = transfer.unbalanced(lights) @ (transfer.S_out @ transfer.restoration).T @ to_Y
    bright = luminance > 0
    lights, luminance = lights[bright], luminance[bright]
    unknown = light.doubt or _unknown(transfer, lights, light)
    if unknown or not len(rho):
        nothing = {name: np.full(len(rho), np.nan) for name in (TODAY, *matrices)}
        return Prediction(nothing, nothing, colour, out_of_gamut, unknown)
    lights = lights / luminance[:, None]
    if light.spectra is None:
        rest = _unseen(transfer, lights, light)[None]
    else:
        rest = _unfitted(transfer, light.spectra[bright])[:, None]
    white = lights @ transfer.to_working.T
    mean, bound = {}, {}
    for start in range(0, len(rho), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        seen = np.einsum("mij,kj->kmi", matrices[FULL][some], lights)
        hidden = np.einsum("il,ml,knl->knmi", transfer.S_out, rho[some], rest, optimize=True)
        true = to_Lab(
            seen[:, None] + hidden / transfer.neutral, white[:, None, None], transfer.space
        )
        # A raw camera HDRI is developed before anyone multiplies by it: today's way sees that.
        estimates = {TODAY: rgb_albedo(rho[some], transfer.space) * white[:, None]}
        for name, M in matrices.items():
            estimates[name] = np.einsum("mij,kj->kmi", M[some], lights)
        for name, estimate in estimates.items():
            errors = delta_E_2000(to_Lab(estimate, white[:, None], transfer.space)[:, None], true)
            case = np.percentile(errors, 95, axis=0)
            mean.setdefault(name, []).append(errors.mean(axis=(0, 1)))
            bound.setdefault(name, []).append(np.quantile(case, _COVERED, axis=0))
    return Prediction(
        {name: np.concatenate(parts) for name, parts in mean.items()},
        {name: np.concatenate(parts) for name, parts in bound.items()},
        colour,
        out_of_gamut,
    )


_AT_ONCE = 64
"""Materials: bounds the memory."""


def rgb_albedo(reflectances: ArrayLike, space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return the linear RGB (..., 3) of reflectances (..., 81) under D65, white (1, 1, 1).

    It is the base colour that Blender's users type in today. Values out of gamut are kept.
    """
    S = observer(space) * D65()
    return np.asarray(reflectances) @ S.T / S.sum(axis=1)


def _unknown(transfer: Transfer, lights: NDArray, light: KnownLight) -> str:
    if not len(lights):
        return "the sky is dark"
    if light.spectra is not None:
        return ""
    sun_elevation = light.sun_elevation
    lowest = shipped().elevations.min()
    if sun_elevation is not None and sun_elevation < lowest:
        return f"the sun is below {lowest:g}°"
    away = locus_distance(transfer.unbalanced(lights), transfer.S_in, sun_elevation).max()
    if away > LIMIT:
        return f"its color is not a color of skylight (off by {away:.3f} in u'v')"
    return ""


def _unseen(
    transfer: Transfer, lights: NDArray[np.float64], light: KnownLight
) -> NDArray[np.float64]:
    """Return what S_in does not see of possible lights, each of luminance 1, (n, 81)."""
    ensemble = shipped()
    weights = ensemble.weights(
        transfer.S_in, light.sun_elevation, transfer.unbalanced(lights), cautious=True
    )
    # Members as often as they are expected, without chance.
    places = np.searchsorted(np.cumsum(weights), (np.arange(_DRAWS) + 0.5) / _DRAWS)
    scale = np.hypot(_STRANGER[0], _FOREIGN * light.foreign)
    spectra = ensemble.some(np.minimum(places, len(weights) - 1)) * (1.0 + scale * _strange())
    spectra /= (spectra @ observer().T @ np.linalg.inv(XYZ_to_working(DEFAULT_SPACE))[1])[:, None]
    return spectra - spectra @ transfer.S_in.T @ transfer.restoration.T


def _unfitted(transfer: Transfer, spectra: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what the basis leaves of known spectra, each of luminance 1, (k, 81)."""
    to_Y = np.linalg.inv(XYZ_to_working(DEFAULT_SPACE))[1]
    spectra = spectra / (spectra @ observer().T @ to_Y)[:, None]
    return spectra - spectra @ transfer.S_in.T @ transfer.restoration.T


@cache
def _strange() -> NDArray[np.float64]:
    """Smooth errors of deviation 1, (n, 81): normal, covariance a Gaussian of the distance."""
    distance = (WAVELENGTHS[:, None] - WAVELENGTHS) / _STRANGER[1]
    sizes, shapes = np.linalg.eigh(np.exp(-0.5 * distance**2))
    shapes *= np.sqrt(np.maximum(sizes, 0.0))
    return np.random.default_rng(0).standard_normal((_DRAWS, len(sizes))) @ shapes.T
