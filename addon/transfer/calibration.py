"""Whether predicted errors hold: against true ones, under light whose spectrum is known."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..spectra.sensitivities import observer
from .choice import FULL, TOLERANCE, choose
from .evaluation import one_each, true_colours
from .matrices import transfer
from .measures import delta_E

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
    basis: str = "atmosphere",
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
    lights = np.atleast_2d(np.asarray(lights, dtype=float))
    luminance = lights @ observer().T @ [0.2126, 0.7152, 0.0722]
    if np.any(luminance <= 0):
        raise InputError("daylight", "a spectrum holds no light", "leave it out")
    lights = lights / luminance[:, None]
    rho = np.atleast_2d(np.asarray(reflectances, dtype=float))
    elevations = one_each(sun_elevation, len(lights))
    names = [str(k) for k in range(len(lights))] if skies is None else list(skies)
    true, predicted, chosen = [], [], []
    for name in dict.fromkeys(names):
        of = [k for k, each in enumerate(names) if each == name]
        mapping = transfer(camera=camera)
        seen = lights[of] @ mapping.S_in.T
        mapping = transfer(basis, camera=camera, sun_elevation=elevations[of[0]], sky_rgb=seen)
        choice = choose(mapping, rho, seen, elevations[of[0]], tolerance)
        colours, white = true_colours(lights[of], rho), (lights[of] @ observer().T)[:, None]

        def error(M: NDArray, seen=seen, colours=colours, white=white) -> NDArray:
            estimate = np.einsum("mij,kj->kmi", M, seen)
            return np.percentile(delta_E(estimate, colours, white), 95, axis=0)

        true.append(error(mapping.matrices(rho)))
        assert choice.prediction is not None
        predicted.append(choice.prediction.bound[FULL])
        chosen.append(error(choice.matrices))
    return Calibration(np.array(true), np.array(predicted), np.array(chosen), tolerance)


def joined(sites: Iterable[Calibration]) -> Calibration:
    """Return the cases of several sites as one; their materials must be the same."""
    sites = list(sites)
    return Calibration(
        np.concatenate([site.true for site in sites]),
        np.concatenate([site.predicted for site in sites]),
        np.concatenate([site.chosen for site in sites]),
        sites[0].tolerance,
    )
