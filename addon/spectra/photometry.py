"""Photometric quantities: each is a row of numbers that a spectrum is multiplied by.

So what an observer's three rows are to a color, one row is to lux, cd/m² or melanopic lux, and the
matrices that make colors make these quantities too (`Quantity.row_on`).

The α-opic action spectra are those of CIE S 026:2018, *CIE System for Metrology of Optical
Radiation for ipRGC-Influenced Responses to Light* (DOI 10.25039/S026.2018): how strongly light acts
on the five receptors of the eye. ``.ci/datasets/alpha_opic.py`` writes their file.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import QUANTITIES, listed
from ..errors import InputError, parameter
from .grid import WAVELENGTHS, WEIGHTS
from .sensitivities import cmfs

FILE = Path(__file__).with_name("alpha_opic.csv")

LUMINOUS_EFFICACY = 683.002
"""[lm/W] at 555 nm, CIE 018:2019."""

ALPHA_OPIC = "s-cone-opic", "m-cone-opic", "l-cone-opic", "rhodopic", "melanopic"
"""The receptors: cones for short, middle and long waves, rods, and the cells of melanopsin."""

D65_EFFICACY = dict(
    zip(ALPHA_OPIC, (0.8173e-3, 1.4558e-3, 1.6289e-3, 1.4497e-3, 1.3262e-3), strict=True)
)
"""[W/lm]: α-opic efficacy of luminous radiation of daylight D65, CIE S 026:2018. An α-opic
irradiance over this is the equivalent daylight illuminance (EDI): the lux of D65 that act alike."""


@dataclass(frozen=True)
class Quantity:
    """A quantity that is linear in a spectrum.

    ``row`` (81,), quadrature included: ``row @ spectrum`` is it in ``unit``, of spectral irradiance
    [W m^-2 nm^-1] or, where ``of_radiance``, of spectral radiance [W m^-2 sr^-1 nm^-1].
    """

    name: str
    unit: str
    row: NDArray[np.float64]
    of_radiance: bool = False

    def row_on(
        self,
        to_spectrum: ArrayLike,
        reflectance: ArrayLike = 1.0,
        white_luminance: float = LUMINOUS_EFFICACY,
    ) -> NDArray[np.float64]:
        """Return the row (k,) that makes this quantity of k numbers of an irradiance divided by π.

        Parameters
        ----------
        to_spectrum
            (81, k), what the numbers restore to: of an HDRI's RGB
            ``transfer.unbalanced(transfer.restoration)``, for which the row takes the place of a
            row of the material's matrix; of bands ``spline() * shape[:, None]``.
        reflectance
            (81,) or one number. Of a radiance, as luminance: what a diffuser of it sends. Of an
            irradiance leave it at 1.
        white_luminance
            [cd/m²] of the numbers' (1, 1, 1), for a result in ``unit``; without it spectra are in
            W m^-2 sr^-1 nm^-1; 1 where neither is known: a relative number.
        """
        weights = self.row * (1.0 if self.of_radiance else np.pi) * reflectance
        return weights @ np.asarray(to_spectrum) * (white_luminance / LUMINOUS_EFFICACY)


@cache
def action_spectra() -> NDArray[np.float64]:
    """Return the α-opic action spectra on the grid, (5, 81), in the order of `ALPHA_OPIC`.

    Largest value 1. CIE S 026:2018, table 2; DOI 10.25039/CIE.DS.vqqhzp5a (CC BY-SA 4.0). Raises
    `InputError` where the file is missing or damaged.
    """
    try:
        table = np.loadtxt(FILE, delimiter=",", skiprows=1)
        # Tabulated at every nanometre: the grid's nodes are rows of the table.
        rows = np.searchsorted(table[:, 0], WAVELENGTHS)
        spectra = np.array(table[rows, 1:].T)
    except (OSError, ValueError, IndexError) as error:
        raise InputError(FILE, f"cannot be read ({error})", "install the add-on again") from error
    spectra.flags.writeable = False
    return spectra


@cache
def quantity(name: str) -> Quantity:
    """Return one of `choices.QUANTITIES`; raises `InputError` for another name.

    The α-opic ones are equivalent daylight (D65) illuminances; times `D65_EFFICACY` they are the
    α-opic irradiances [W/m²].
    """
    if name not in QUANTITIES:
        raise InputError(
            parameter("quantity"), f"'{name}' is not a quantity", f"choose {listed(QUANTITIES)}"
        )
    if name in ALPHA_OPIC:
        row = action_spectra()[ALPHA_OPIC.index(name)] * WEIGHTS / D65_EFFICACY[name]
        return Quantity(name, "lx", row)
    row = cmfs()[1] * WEIGHTS * LUMINOUS_EFFICACY
    if name == "luminance":
        return Quantity(name, "cd/m²", row, of_radiance=True)
    return Quantity(name, "lx", row)
