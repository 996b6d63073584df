"""The light that is to be expected outdoors: many simulated spectra, and the basis they make.

Where light is known by three numbers ``rgb = S_in s`` alone, the spectrum to expect is the Wiener
estimate ``C S_in^T (S_in C S_in^T)^-1 rgb`` with the second moment ``C`` of the spectra that can
be (N. Wiener 1949; for colours H. Haneishi et al. 2000, DOI 10.1364/AO.39.006621). So three
functions ``S_in C`` are the best basis for them. Which spectra can be depends on the sun's
elevation, or, where that is not known, on the colour of the light: members of the ensemble count
by how near they are.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, fields
from functools import cache, cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from .chromaticity import uv
from .grid import WEIGHTS
from .sensitivities import cmfs
from .sorting import distinct

TABLE = Path(__file__).with_name("ensemble.npz")
"""What `sky.daylight_ensemble` wrote."""

_NEAR_ELEVATION = 2.0, 0.15
"""Standard deviation [degrees] of the elevations that count, and its growth with elevation: the
air a sunbeam crosses changes ever more slowly. Two degrees also hold refraction and a date or place
known roughly."""

_NEAR_COLOUR = 0.02, 0.005
"""Standard deviation of the colours that count, in CIE 1976 u'v': where they alone are known, and
beside the elevation, which leaves less for them to tell."""

_DAY = 8.0, 3.0, 0.02
"""Elevation [degrees] over which skies are expected when none is told, how softly that begins,
and what is left for lower suns. Three numbers do not tell a twilight's ozone; guessed by day, it
costs."""

_WITHOUT_OZONE = 0.25
"""How much members without ozone count where the colour is known, and may tell; else they do not.
The air always holds ozone, but many a model of the sky does not, and HDRIs are made with those."""

_SHARES = {"shade": 4.0, "daylight": 4.0, "overcast": 4.0, "tilted": 2.0}
"""How much the kinds of light count, others 1: a matrix meets irradiances, all of the sky at once,
more than single directions of it."""

_KEPT = 16
"""Restorations that are kept: those of one sky and its bases."""

_FLOOR = 1e-3
"""Weight of members of any other colour: where no member is near, all count."""


@dataclass(frozen=True)
class Ensemble:
    """Spectra of light, each over its own luminance, as sums of a few components.

    ``components`` (c, 81), ``scores`` (m, c), ``elevations`` of the sun (m,) [degrees], ``kinds``
    (m,): names from `sky.daylight_ensemble.KINDS`, ``ozone`` (m,): whether the air held any.
    """

    components: NDArray[np.float32]
    scores: NDArray[np.float32]
    elevations: NDArray[np.float32]
    kinds: NDArray[np.str_]
    ozone: NDArray[np.bool_]

    @classmethod
    def compressed(
        cls, spectra: NDArray, elevations: NDArray, kinds: NDArray, ozone: NDArray, count: int
    ) -> Ensemble:
        """Keep of ``spectra`` (m, 81) the ``count`` components that hold most of them."""
        components = np.linalg.svd(spectra.T @ spectra)[0].T[:count]
        return cls(
            components.astype(np.float32),
            (spectra @ components.T).astype(np.float32),
            np.asarray(elevations, np.float32),
            np.asarray(kinds),
            np.asarray(ozone, bool),
        )

    def save(self, path: Path) -> None:
        """Write all arrays to one file."""
        np.savez_compressed(path, **{f.name: getattr(self, f.name) for f in fields(self)})

    @property
    def spectra(self) -> NDArray[np.float64]:
        """All members on the grid, (m, 81)."""
        return self.scores.astype(float) @ self.components

    def weights(
        self,
        S_in: NDArray[np.float64],
        sun_elevation: float | None = None,
        colours: ArrayLike | None = None,
        cautious: bool = False,
    ) -> NDArray[np.float64]:
        """Return how much each member is to be expected, (m,), in sum 1.

        Parameters
        ----------
        S_in
            What makes the three numbers, (3, 81), quadrature weights included.
        sun_elevation
            [degrees]. Beyond the ensemble's own elevations the nearest counts. None: by day.
        colours
            The light's own colours as S_in sees them, (3,) or (k, 3), where known; each counts as
            much as it is bright. Without luminance they are left out.
        cautious
            For all that may be, not for the best estimate: kinds of light count alike, and beside
            a known elevation colours are near that are twice as far.
        """
        XYZ = None if colours is None else self._XYZ(S_in, sun_elevation, colours)
        weights = self._prior(sun_elevation, XYZ is not None, 1.0 if cautious else self._shares)
        if XYZ is not None:
            distance = np.sum((self._uv - uv(XYZ)[:, None]) ** 2, axis=-1)
            width = _NEAR_COLOUR[sun_elevation is not None]
            if cautious and sun_elevation is not None:
                width *= 2.0
            near = XYZ[:, 1] / XYZ[:, 1].sum() @ np.exp(-0.5 * distance / width**2)
            weights = weights * (near + _FLOOR)
        return weights / weights.sum()

    def restoration(
        self,
        S_in: NDArray[np.float64],
        sun_elevation: float | None = None,
        colours: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Return the Wiener estimate (81, 3): ``restoration @ rgb`` is the spectrum to expect.

        Arguments as those of `weights`.
        """
        known = None if colours is None else np.asarray(colours, dtype=float)
        parts = (S_in,) if known is None else (S_in, known)
        key = sun_elevation, *((part.shape, part.tobytes()) for part in parts)
        if key not in self._restorations:
            if len(self._restorations) >= _KEPT:
                self._restorations.clear()
            found = self._wiener(S_in, self.weights(S_in, sun_elevation, known))
            found.flags.writeable = False
            self._restorations[key] = found
        return self._restorations[key]

    def _XYZ(
        self, S_in: NDArray, sun_elevation: float | None, colours: ArrayLike
    ) -> NDArray[np.float64] | None:
        """What the observer sees of lights that S_in sees as ``colours``, (k, 3); None if dark."""
        expected = self._wiener(S_in, self._prior(sun_elevation, False, self._shares))
        XYZ = np.atleast_2d(colours) @ (cmfs() * WEIGHTS @ expected).T
        XYZ = XYZ[(XYZ > 0).all(axis=1)]
        return XYZ if len(XYZ) else None

    def _prior(
        self, sun_elevation: float | None, colour_known: bool, shares: ArrayLike
    ) -> NDArray[np.float64]:
        """Return how much each member counts (m,) before its colour is looked at."""
        elevations = self.elevations.astype(float)
        nodes, _, place = distinct(elevations)
        weights = np.gradient(nodes)[place] * shares
        if sun_elevation is None:
            start, softness, rest = _DAY
            weights *= rest + (1.0 - rest) / (1.0 + np.exp((start - elevations) / softness))
            # Over a year and the earth the sun stands high the more rarely, the higher it stands.
            weights *= np.cos(np.radians(np.maximum(elevations, 0.0)))
        else:
            sun_elevation = float(np.clip(sun_elevation, nodes[0], nodes[-1]))
            width = np.hypot(_NEAR_ELEVATION[0], _NEAR_ELEVATION[1] * max(sun_elevation, 0.0))
            weights *= np.exp(-0.5 * ((elevations - sun_elevation) / width) ** 2)
        without = _WITHOUT_OZONE if colour_known else 0.0
        for ozone, share in ((True, 1.0 - without), (False, without)):
            weights[self.ozone == ozone] *= share / weights[self.ozone == ozone].sum()
        return weights

    def some(self, members: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the spectra of members (n,) on the grid, (n, 81)."""
        return self.scores[members].astype(float) @ self.components

    @cached_property
    def _restorations(self) -> dict[Hashable, NDArray[np.float64]]:
        """What `restoration` found: one update of a scene asks for the same again and again."""
        return {}

    @cached_property
    def _shares(self) -> NDArray[np.float64]:
        return np.array([_SHARES.get(kind, 1.0) for kind in self.kinds.tolist()])

    @cached_property
    def _uv(self) -> NDArray[np.float64]:
        """CIE 1976 u'v' of every member, (m, 2)."""
        return uv(self.scores @ (self.components @ (cmfs() * WEIGHTS).T))

    def _wiener(self, S_in: NDArray, weights: NDArray) -> NDArray[np.float64]:
        scores = self.scores.astype(float)
        seen = scores @ (self.components @ S_in.T)  # by three sensors: no second moment is needed
        cross = self.components.T @ (scores.T @ (seen * (weights / weights.sum())[:, None]))
        return np.linalg.solve((S_in @ cross).T, cross.T).T


@cache
def shipped() -> Ensemble:
    """Return the ensemble that ships. Raises `InputError` where its file is missing."""
    try:
        with np.load(TABLE) as table:
            return Ensemble(**table)
    except OSError as error:
        raise InputError(TABLE, f"cannot be read ({error})", "install the add-on again") from error
