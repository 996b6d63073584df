"""The least model that a scene needs: per material scalar, diagonal or full, and the sky's degree.

All are the same nodes with other values, so that choosing never compiles a shader.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import BASIS, SIMPLEST
from ..sky.irradiance import exact_irradiance, spread
from ..sky.polynomial import evaluate_polynomial
from ..spectra.working_spaces import LUMINANCE, XYZ_to_working
from .known_light import KnownLight
from .matrices import OWN, Transfer
from .measures import delta_E
from .prediction import FULL, TODAY, Prediction, predict

if TYPE_CHECKING:
    from ..sky.light import SkyLight

MODELS = ("scalar", "diagonal", FULL)
"""From the cheapest: one number, three, nine."""

TOLERANCE = 0.5
"""CIEDE2000 that a choice keeps to where none is given: half of what is just noticeable."""

CANDIDATES = ("rayleigh", BASIS)
"""`SIMPLEST` is the first of these with which every material keeps to the tolerance."""

_DEGREE_SHARE = 0.5
"""Of the tolerance, for the polynomial: brightness comes on top of a matrix's error in colour."""


@dataclass(frozen=True)
class Choice:
    """Each material's model and what it leaves.

    ``matrices`` (m, 3, 3) of the chosen models, ``models`` (m) of `MODELS`; ``prediction``: None
    where there was no light to predict from.
    """

    transfer: Transfer
    prediction: Prediction | None
    matrices: NDArray[np.float64]
    models: tuple[str, ...]
    tolerance: float | None

    def error(self, k: int) -> tuple[float, float]:
        """Return material k's expected CIEDE2000 and the one to count on; NaN where unknown."""
        if self.prediction is None:
            return np.nan, np.nan
        name = self.models[k]
        return float(self.prediction.mean[name][k]), float(self.prediction.bound[name][k])

    @property
    def kept(self) -> bool:
        """Whether every material is known to keep to the tolerance."""
        bounds = [self.error(k)[1] for k in range(len(self.models))]
        return self.tolerance is not None and all(bound <= self.tolerance for bound in bounds)

    def line(self, k: int, name: str) -> str:
        """Say in one line what was chosen for material k and why; empty without a light."""
        if self.prediction is None:
            return ""
        clamped = "; out of gamut: Blender clamps it" if self.prediction.out_of_gamut[k] else ""
        if not self.prediction.known:
            why = self.prediction.unknown
            return f"{name}: {self.models[k]}, error unknown: {why}{clamped}"
        mean, bound = self.error(k)
        text = (
            f"{name}: {self.models[k]}, ΔE {mean:.1f} (at most {bound:.1f}), "
            f"RGB × RGB {self.prediction.rgb[k]:.1f}"
        )
        if self.tolerance is not None and bound > self.tolerance:
            text += f"; above the tolerance of {self.tolerance:g}"
        return f"{text}{clamped}"

    def report(self, k: int, name: str) -> dict[str, Any]:
        """Return what is predicted of material k, ready for JSON: nothing without a light.

        ``predicted_delta_E``: the expected error of today's way (``rgb``), of the full ``matrix``
        and of the ``model`` chosen, and of each the one to count on (``bounds``); where no error
        can be predicted ``unknown`` says why instead.
        """
        prediction = self.prediction
        if prediction is None:
            return {}
        found: dict[str, Any] = {
            "line": self.line(k, name),
            "colour": prediction.colour[k].tolist(),
            "out_of_gamut": bool(prediction.out_of_gamut[k]),
        }
        if not prediction.known:
            return found | {"unknown": prediction.unknown}
        names = {"rgb": TODAY, "matrix": FULL, "model": self.models[k]}
        return found | {
            "predicted_delta_E": {
                **{key: float(prediction.mean[name][k]) for key, name in names.items()},
                "bounds": {key: float(prediction.bound[name][k]) for key, name in names.items()},
            }
        }


def choose(
    transfer: Transfer,
    reflectances: ArrayLike,
    light: KnownLight | None,
    tolerance: float | None = TOLERANCE,
) -> Choice:
    """Choose for reflectances (m, 81) the cheapest models that keep to a tolerance [CIEDE2000].

    Without a tolerance or a light, where the sky cannot be predicted, and where no model keeps to
    it, the full matrices.
    """
    rho = np.atleast_2d(np.asarray(reflectances, dtype=float))
    models = {FULL: transfer.matrices(rho)}
    chosen = np.full(len(rho), MODELS.index(FULL))
    prediction = None
    if light is not None:
        models |= reduced(transfer, rho, light.lights)
        prediction = predict(transfer, rho, light, models)
        if tolerance is not None and prediction.known:
            kept = np.stack([prediction.bound[name] <= tolerance for name in MODELS])
            chosen = np.where(kept.any(axis=0), kept.argmax(axis=0), chosen)
    names = tuple(MODELS[k] for k in chosen)
    matrices = np.array([models[name][k] for k, name in enumerate(names)]).reshape(-1, 3, 3)
    return Choice(transfer, prediction, matrices, names, tolerance)


def choose_with(
    transfer_of: Callable[[str], Transfer],
    basis: str,
    reflectances: ArrayLike,
    light: KnownLight | None,
    tolerance: float | None = None,
) -> Choice:
    """Choose models with a basis, or with the `SIMPLEST` whose every model keeps to the tolerance.

    ``transfer_of`` makes a basis's name into its `Transfer`; the rest as in `choose`, but that the
    simplest basis keeps to `TOLERANCE` where none is given. Where none keeps to it, or there is no
    light to judge by, the last of `CANDIDATES`.
    """
    if basis != SIMPLEST:
        return choose(transfer_of(basis), reflectances, light, tolerance)
    for name in CANDIDATES:
        choice = choose(transfer_of(name), reflectances, light, tolerance or TOLERANCE)
        if choice.kept:
            break
    return choice


def reduced(
    transfer: Transfer, reflectances: ArrayLike, lights: ArrayLike
) -> dict[str, NDArray[np.float64]]:
    """Return ``scalar`` and ``diagonal`` models as matrices (m, 3, 3).

    They are the ones that come nearest to the full matrix's colours under lights (k, 3) of the same
    luminance, by least squares: in luminance, and in each channel.
    """
    M = transfer.matrices(np.atleast_2d(reflectances))
    to_Y = np.linalg.inv(XYZ_to_working(transfer.space))[1]
    white = np.atleast_2d(lights) @ transfer.to_working.T
    white = white[white @ to_Y > 0]
    if not len(white):
        white = np.ones((1, 3))
    white = white / (white @ to_Y)[:, None]
    seen = np.einsum("mij,kj->kmi", M @ np.linalg.inv(transfer.to_working), white)
    channels = np.einsum("kmi,ki->mi", seen, white) / np.sum(white**2, axis=0)
    luminance = (seen @ to_Y).mean(axis=0)
    return {
        "scalar": luminance[:, None, None] * transfer.to_working,
        "diagonal": channels[:, :, None] * transfer.to_working,
    }


def lowest_degree(light: SkyLight, to_rec709: NDArray[np.float64], tolerance: float) -> SkyLight:
    """Return the light with the lowest degree that white faces keep to half of the tolerance with.

    ``to_rec709`` (3, 3): from the sky's numbers to linear Rec.709. 95 of 100 faces that do not look
    down must keep to it; where no degree does, the highest.
    """
    normals = spread(800)
    normals = normals[normals[:, 2] >= 0.0]
    true = exact_irradiance(light.sky, normals) @ to_rec709.T
    if not np.all(true @ LUMINANCE > 0.0):
        return light

    def keeps(coefficients: NDArray[np.float64]) -> bool:
        estimate = evaluate_polynomial(coefficients, normals) @ to_rec709.T
        error = np.percentile(delta_E(estimate, true, true), 95)
        return bool(error <= _DEGREE_SHARE * tolerance)

    fits = light.fit.of_degrees
    degree = next((d for d, fit in enumerate(fits) if keeps(fit)), len(fits) - 1)
    chosen = replace(light.fit, degree=degree, coefficients=fits[degree])
    return replace(light, fitting=lambda: chosen)


def sky_line(choice: Choice, light: SkyLight) -> str:
    """Say in one line what the sky was modelled with, and whether the sun would be needed."""
    basis = choice.transfer.basis
    told = "matrices from this sky's own spectrum" if basis == OWN else f"basis {basis}"
    text = f"sky: {told}, degree {light.fit.degree}"
    if light.sun is None:
        return f"{text}, no sun"
    needed = "needs a" if _darker(light.sun_share) > (choice.tolerance or 0.0) else "needs no"
    return f"{text}; the sun ({100 * light.sun_share:.0f} % of the light) {needed} term of its own"


def visibility_line(hidden: float, tolerance: float) -> str:
    """Say whether what hides this part of the sky, 0 to 1, is worth modelling."""
    noticeable = "are noticeable" if _darker(hidden) > tolerance else "are not noticeable"
    return (
        f"{100 * hidden:.0f} % of the sky is hidden from these materials: sky shadows {noticeable}"
    )


def _darker(share: float) -> float:
    """Return the CIEDE2000 of a white that lacks this part, 0 to 1, of its light."""
    white = np.ones(3)
    return float(delta_E((1.0 - share) * white, white, white))
