"""Whether predicted errors hold: against true ones, under light whose spectrum is known."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import BASIS
from ..spectra.sensitivities import observer
from ..transfer.choice import FULL, TOLERANCE, choose
from ..transfer.known_light import KnownLight
from ..transfer.matrices import transfer
from ..transfer.measures import delta_E
from .evaluation import of_one_luminance, one_each, true_colours

SMALLEST = 0.1
"""CIEDE2000 under which an error counts as this one where a prediction is compared to it."""

ROUNDING = 1e-5
"""CIEDE2000 that rounding makes of no error: a grey's bound is 0, its true error seldom quite."""


@dataclass(frozen=True)
class Calibration:
    """Predicted and true errors of all cases, each a sky and a material.

    ``true`` (skies, m): the full matrix's error, the 95th percentile of CIEDE2000 over the sky's
    faces; ``predicted`` (skies, m): the bound, NaN where unknown; ``chosen`` (skies, m): the true
    error of the model that was chosen for the ``tolerance``.
    """

    true: NDArray[np.float64]
    predicted: NDArray[np.float64]
    chosen: NDArray[np.float64]
    tolerance: float

    @property
    def cases(self) -> int:
        """How many there are."""
        return self.true.size

    @property
    def unknown(self) -> float:
        """The part of the cases, 0 to 1, that no error was predicted for."""
        return float(np.isnan(self.predicted).mean())

    @property
    def covered(self) -> float:
        """The part of the cases that stay under their bound; the unknown ones do not count so."""
        return float((self.true <= self.predicted + ROUNDING).mean())

    @property
    def sharpness(self) -> float:
        """Median of bound over true error: how much the prediction is on the safe side."""
        known = ~np.isnan(self.predicted)
        ratio = self.predicted[known] / np.maximum(self.true[known], SMALLEST)
        return float(np.median(ratio)) if known.any() else np.nan

    @property
    def rank_correlation(self) -> float:
        """Spearman's, of bounds and true errors."""
        from scipy.stats import spearmanr

        known = ~np.isnan(self.predicted)
        if known.sum() < 3:
            return np.nan
        return float(spearmanr(self.predicted[known], self.true[known]).statistic)

    @property
    def kept(self) -> float:
        """The part of the cases whose chosen model keeps to the tolerance."""
        return float((self.chosen <= self.tolerance).mean())

    def report(self) -> dict[str, Any]:
        """Return the figures, ready for JSON."""
        figures = {
            "cases": self.cases,
            "covered": self.covered,
            "sharpness": self.sharpness,
            "rank_correlation": self.rank_correlation,
            "unknown": self.unknown,
            "tolerance": self.tolerance,
            "tolerance_kept": self.kept,
        }
        return {key: None if np.isnan(value) else value for key, value in figures.items()}


def calibrate(
    lights: ArrayLike,
    reflectances: ArrayLike,
    sun_elevation: ArrayLike | None = None,
    *,
    basis: str = BASIS,
    camera: str | None = None,
    skies: Sequence[str] | None = None,
    tolerance: float = TOLERANCE,
) -> Calibration:
    """Predict errors from the three numbers of lights, and compare them to the true ones.

    Parameters
    ----------
    lights
        Spectra, (k, 81): light on faces.
    reflectances
        (m, 81) on the grid.
    sun_elevation
        [degrees], one or each, (k,).
    skies
        The sky of each light, (k,); without, each is one of its own.

    Raises
    ------
    InputError
        As `evaluate` does.
    """
    lights = of_one_luminance(lights)
    rho = np.atleast_2d(np.asarray(reflectances, dtype=float))
    elevations = one_each(sun_elevation, len(lights))
    names = [str(k) for k in range(len(lights))] if skies is None else list(skies)
    true, predicted, chosen = [], [], []
    for name in dict.fromkeys(names):
        of = [k for k, each in enumerate(names) if each == name]
        mapping = transfer(camera=camera)
        seen = lights[of] @ mapping.S_in.T
        mapping = transfer(basis, camera=camera, sun_elevation=elevations[of[0]], sky_rgb=seen)
        choice = choose(mapping, rho, KnownLight(seen, elevations[of[0]]), tolerance)
        assert choice.prediction is not None
        true.append(_case_errors(mapping.matrices(rho), seen, lights[of], rho))
        predicted.append(choice.prediction.bound[FULL])
        chosen.append(_case_errors(choice.matrices, seen, lights[of], rho))
    return Calibration(np.array(true), np.array(predicted), np.array(chosen), tolerance)


def _case_errors(
    M: NDArray[np.float64],
    seen: NDArray[np.float64],
    lights: NDArray[np.float64],
    rho: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return what matrices (m, 3, 3) leave of one sky's lights (k, 81), seen as (k, 3): (m,)."""
    estimate = np.einsum("mij,kj->kmi", M, seen)
    errors = delta_E(estimate, true_colours(lights, rho), (lights @ observer().T)[:, None])
    return np.percentile(errors, 95, axis=0)


def joined(sites: Iterable[Calibration]) -> Calibration:
    """Return the cases of several sites as one; their materials must be the same."""
    sites = list(sites)
    return Calibration(
        np.concatenate([site.true for site in sites]),
        np.concatenate([site.predicted for site in sites]),
        np.concatenate([site.chosen for site in sites]),
        sites[0].tolerance,
    )
