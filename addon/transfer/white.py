"""Whether an HDRI was white-balanced, and how: by the colours that sun and sky must have.

Balancing scales the channels, which moves all colours of a sky alike. How the sun and the light of
the sky on level ground are coloured at an elevation, and how much that varies with haze, ozone and
cloud, the ensemble of simulated light tells; what is left over is the balance. Clear skies tell it
well; a grey sky without a sun tells little more than whether it has a tint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.colorchecker import colorchecker
from ..spectra.ensemble import shipped
from .matrices import Transfer, check_white
from .measures import delta_E

if TYPE_CHECKING:
    from ..sky.light import SkyLight
    from ..sky.sun import Sun

_SKY, _SUN = 0.05, 0.1
"""How far the colours of photographed skies and suns stray beside those of the ensemble (standard
deviation of the logarithm): lenses, joined exposures, and a sun that no picture holds well."""

_CLEAR = 0.25
"""Share of the light on level ground over which the sun shines freely: the sky is then clear."""

_LOWEST_SUN = 3.0
"""[degrees]. A lower sun may have any colour."""

_SURE = 9.21
"""Squared distance from "not balanced" in standard deviations that chance passes once in a hundred
(chi-squared, two degrees of freedom): a suspicion makes every predicted error unknown. Of 160
simulated skies none raises a false alarm. Clear skies made grey are caught one time in two with the
sun over 8°, hardly under it; lamplight and tints always."""


@dataclass(frozen=True)
class WhiteEstimate:
    """What balance an HDRI seems to have.

    ``white`` (3,): the RGB of neutral light before, green 1, as `transfer` takes it; ``covariance``
    (2, 2) of the logarithms of its red and blue; ``light`` (3,): the sky's own light on level
    ground, as it is in the HDRI; ``mapping``: the matrices to come, without a white.
    """

    white: NDArray[np.float64]
    covariance: NDArray[np.float64]
    light: NDArray[np.float64]
    mapping: Transfer

    @cached_property
    def ignored_delta_E(self) -> float:
        """Mean CIEDE2000 over the ColorChecker where the balance is not undone."""
        return self._apart(np.ones(3))

    @cached_property
    def added_delta_E(self) -> float:
        """Mean CIEDE2000 that the estimate's own error (one standard deviation) adds."""
        sizes, axes = np.linalg.eigh(self.covariance)
        away = [
            np.mean([self._apart(self.white * _whites(sign * step)) for sign in (-1.0, 1.0)])
            for step in (np.sqrt(sizes) * axes).T
        ]
        return float(np.hypot(*away))

    @property
    def suspected(self) -> bool:
        """Whether the sky is surely balanced, and better undone by the estimate than left."""
        logs = np.log(self.white[[0, 2]])
        distance = logs @ np.linalg.solve(self.covariance, logs)
        return bool(distance > _SURE and self.ignored_delta_E > self.added_delta_E)

    @property
    def line(self) -> str:
        """One line for a person; empty where nothing is suspected."""
        if not self.suspected:
            return ""
        r, g, b = self.white
        return (
            f"this sky appears white-balanced, which adds ΔE {self.ignored_delta_E:.1f}; "
            f"set its neutral light to {r:.2f},{g:.2f},{b:.2f} (or auto) to leave ΔE "
            f"{self.added_delta_E:.1f}"
        )

    def _apart(self, other: NDArray[np.float64]) -> float:
        """Return how far another white moves the ColorChecker's colours from this one's."""
        here, there = (replace(self.mapping, white=white) for white in (self.white, other))
        rho, shown = colorchecker()[1], here.to_working @ self.light
        estimate, true = (mapping.matrices(rho) @ self.light for mapping in (there, here))
        return float(delta_E(estimate, true, shown, self.mapping.space).mean())


def estimate_white(
    light: SkyLight,
    mapping: Transfer,
    sun_elevation: float | None = None,
    to_working: ArrayLike | None = None,
) -> WhiteEstimate:
    """Estimate the balance of a sky from its light on level ground, and from its sun if it has one.

    Parameters
    ----------
    light
        The sky, its numbers as they are.
    mapping
        How they were made (``S_in``), and what becomes of them; its white is not looked at.
    sun_elevation
        [degrees]; that of the HDRI's sun where None. Without both, a sky by day.
    to_working
        (3, 3): what takes the sky's numbers to those of ``mapping``; None where they are.
    """
    sun = light.sun
    if sun_elevation is None and sun is not None:
        sun_elevation = sun.elevation
    to_working = np.eye(3) if to_working is None else np.asarray(to_working)
    level = to_working @ light.faces[0]
    clear = sun is not None and sun.share > _CLEAR
    if light.spectrum is not None:  # its numbers are those of its spectra
        return WhiteEstimate(np.ones(3), np.eye(2), level, replace(mapping, white=None))
    known = [(level, ("shade",) if clear else ("shade", "overcast", "cloudy sky"), _SKY)]
    if sun is not None and _is_known(sun):
        known.append((to_working @ sun.irradiance, ("sun",), _SUN))
    precision, balance = np.zeros((2, 2)), np.zeros(2)
    for rgb, kinds, stray in known:
        if np.all(rgb > 0):
            mean, covariance = _expected(mapping.S_in, kinds, sun_elevation)
            weight = np.linalg.inv(covariance + stray**2 * np.eye(2))
            precision += weight
            balance += weight @ (mean - _logs(rgb))
    mapping = replace(mapping, white=None)
    if not precision.any():  # dark, or bluer than the space holds: nothing to tell by
        return WhiteEstimate(np.ones(3), np.eye(2), level, mapping)
    covariance = np.linalg.inv(precision)
    return WhiteEstimate(_whites(covariance @ balance), covariance, level, mapping)


AUTO = "auto"
"""Stands for the estimated white wherever a white can be given."""


def settle_white(
    white: ArrayLike | None, estimate: Callable[[], WhiteEstimate]
) -> tuple[tuple[float, float, float] | None, str]:
    """Return the white to undo and a line for a person, empty where there is nothing to say.

    A white that is given is taken; `AUTO` takes the estimate where a balance is suspected, and
    None undoes nothing but says where one is.
    """
    if not (white is None or isinstance(white, str)):
        r, g, b = check_white(white)
        return (float(r), float(g), float(b)), ""
    found = estimate()
    if white is None:
        return None, found.line
    if not found.suspected:
        return None, "this sky does not appear white-balanced; no white balance is undone"
    r, g, b = (round(float(value), 4) for value in found.white)
    return (r, g, b), (
        f"white balance undone as {r:.2f},{g:.2f},{b:.2f}, estimated from the sky: ΔE "
        f"{found.ignored_delta_E:.1f} falls to {found.added_delta_E:.1f}"
    )


def _is_known(sun: Sun) -> bool:
    """Whether the picture holds the sun's colour, and the elevation tells it."""
    return not sun.clipped and sun.elevation >= _LOWEST_SUN and sun.share > 0.05


def _expected(
    S_in: NDArray[np.float64], kinds: tuple[str, ...], sun_elevation: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean (2,) and covariance (2, 2) of the logarithms of red and blue over green."""
    ensemble = shipped()
    elevations = ensemble.elevations
    if sun_elevation is None:
        near = elevations >= 8.0
    else:
        sun_elevation = float(np.clip(sun_elevation, elevations.min(), elevations.max()))
        near = np.abs(elevations - sun_elevation) <= np.hypot(2.0, 0.2 * max(sun_elevation, 0.0))
    rgb = ensemble.spectra[near & np.isin(ensemble.kinds, kinds)] @ S_in.T
    logs = _logs(rgb[(rgb > 0).all(axis=1)])
    return logs.mean(axis=0), np.cov(logs.T)


def _logs(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.log(rgb[..., [0, 2]] / rgb[..., [1]])


def _whites(logs: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.exp([logs[0], 0.0, logs[1]])
