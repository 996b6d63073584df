"""Glazing: what panes let through and send back, one after another and at an angle.

Light that is seen or lands behind a glazing of transmittance ``tau`` has the matrix M(tau), on a
material M(tau rho): the product's, as for light that was reflected twice (see `ground`). CSV files
of transmittance are read as those of reflectance are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.cielab import XYZ_to_Lab, delta_E_2000
from ..spectra.colour_rendering import rendering_index
from ..spectra.grid import WEIGHTS
from ..spectra.illuminants import D65
from ..spectra.sensitivities import cmfs
from .metals import conductor

INDEX = 1.52
"""Refractive index of window glass; 1.524 to 1.515 from 450 to 700 nm (M. Rubin 1985,
DOI 10.1016/0165-1633(85)90052-8)."""


@dataclass(frozen=True)
class Glazing:
    """Shares (..., 81) of light that pass, and that return to the ``front`` and to the ``back``."""

    transmittance: NDArray[np.float64]
    front: NDArray[np.float64]
    back: NDArray[np.float64]

    def __add__(self, behind: Glazing) -> Glazing:
        """Return both panes, light going to and fro between them. Free of phases: no thin films."""
        between = 1.0 / (1.0 - self.back * behind.front)
        through = self.transmittance * behind.transmittance * between
        return Glazing(
            through,
            self.front + self.transmittance**2 * behind.front * between,
            behind.back + behind.transmittance**2 * self.back * between,
        )


def uncoated(transmittance: ArrayLike, cosine: ArrayLike = 1.0, index: float = INDEX) -> Glazing:
    """Return a plain pane by its measured transmittance (81,) at normal incidence, (..., 81).

    The glass's own absorption is what its two surfaces of this ``index`` leave of it; at an angle
    of this ``cosine`` (...) within air light goes a longer way through the glass and its surfaces
    mirror more. Transmittances over what clear glass lets through read as clear glass.
    E. U. Finlayson et al. 1993, "WINDOW 4.0: Documentation of Calculation Procedures"
    (DOI 10.2172/10183795), section on single panes.
    """
    tau = np.asarray(transmittance, dtype=float)
    r = float(conductor(index, 0.0)[..., 0])
    # tau = (1 - r)^2 a / (1 - r^2 a^2), solved for a.
    half = (1.0 - r) ** 2
    a = 2.0 * tau / (half + np.sqrt(half**2 + 4.0 * r**2 * tau**2))
    cosine = np.asarray(cosine, dtype=float)[..., None]
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    a = np.clip(a, 0.0, 1.0) ** (1.0 / inside)
    passed, returned = 0.0, 0.0
    # Each polarisation goes to and fro by itself.
    for s in (
        (cosine - index * inside) / (cosine + index * inside),
        (index * cosine - inside) / (index * cosine + inside),
    ):
        r = s**2
        passed = passed + 0.5 * (1.0 - r) ** 2 * a / (1.0 - (r * a) ** 2)
        returned = returned + 0.5 * (r + (1.0 - r) ** 2 * r * a**2 / (1.0 - (r * a) ** 2))
    return Glazing(passed, returned, returned)


def light_transmittance(transmittance: ArrayLike) -> NDArray[np.float64]:
    """Return the part of daylight D65 that glass of a transmittance (..., 81) lets through, (...).

    τ_v of EN 410:2011, 5.2: weighted with D65 and V(λ).
    """
    weight = D65() * cmfs()[1] * WEIGHTS
    return np.asarray(transmittance, dtype=float) @ weight / weight.sum()


def daylight_rendering(transmittance: ArrayLike) -> float:
    """Return the color rendering index Ra of daylight through glass of a transmittance (81,).

    EN 410:2011, 5.6: CIE 13.3 with D65 itself as the reference. NaN where none comes through.
    """
    tau = np.asarray(transmittance, dtype=float)
    return rendering_index(D65() * tau, D65()) if tau.any() else float("nan")


def colour_shift(transmittance: ArrayLike, reflectances: ArrayLike) -> NDArray[np.float64]:
    """Return by how much glass changes the colors of reflectances (m, 81): CIEDE2000, (m,).

    Behind it under D65 through the glass, in front under D65: each beside a perfect diffuser in its
    own light, for the eye adapts to that. NaN of glass that lets nothing through.
    """
    XYZ = (cmfs() * WEIGHTS).T
    through = D65() * np.asarray(transmittance, dtype=float)
    rho = np.asarray(reflectances, dtype=float)
    if not through.any():
        return np.full(rho.shape[:-1], np.nan)
    behind, before = (XYZ_to_Lab((rho * light) @ XYZ, light @ XYZ) for light in (through, D65()))
    return delta_E_2000(behind, before)


def panes(*glazings: Glazing) -> Glazing:
    """Return several panes as one, the outer first."""
    return reduce(Glazing.__add__, glazings)
