"""What a meter shows of spectra: lux, luminance, equivalent daylight, color temperature."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..choices import QUANTITIES
from ..spectra.colour_temperature import cct_and_duv
from ..spectra.grid import WEIGHTS
from ..spectra.photometry import ALPHA_OPIC, D65_EFFICACY, quantity
from ..spectra.sensitivities import cmfs

HEADINGS = (
    "illuminance_lx",
    "luminance_cd_m2",
    *(f"{name.replace('-', '_')}_edi_lx" for name in ALPHA_OPIC),
    *(f"{name.replace('-', '_')}_irradiance_W_m2" for name in ALPHA_OPIC),
    "cct_K",
    "duv",
)
"""Of the columns of `Readings.rows`."""

_UNIT = re.compile("_(lx|cd_m2|W_m2)$")


def headings(absolute: bool) -> list[str]:
    """Return `HEADINGS`, of light that is only relative without its units."""
    return [name if absolute else _UNIT.sub("_relative", name) for name in HEADINGS]


@dataclass(frozen=True)
class Readings:
    """What n meters read.

    ``irradiance`` (n, 81) [W m^-2 nm^-1]: on the meters; ``radiance`` (n, 81) [W m^-2 sr^-1 nm^-1]:
    what they look at. Both relative where the light is not calibrated.
    """

    irradiance: NDArray[np.float64]
    radiance: NDArray[np.float64]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return one of `choices.QUANTITIES`, (n,)."""
        found = quantity(name)
        return (self.radiance if found.of_radiance else self.irradiance) @ found.row

    @cached_property
    def temperature(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Correlated color temperature [K] and Duv of the light on the meters, (n,) each."""
        return cct_and_duv(self.irradiance @ (cmfs() * WEIGHTS).T)

    def alpha_opic(self, name: str) -> NDArray[np.float64]:
        """Return the irradiance for one of the receptors in `ALPHA_OPIC`, (n,) [W/m²]."""
        return self[name] * D65_EFFICACY[name]

    @property
    def rows(self) -> NDArray[np.float64]:
        """All of it, (n, `HEADINGS`)."""
        linear = [self["illuminance"], self["luminance"], *(self[name] for name in ALPHA_OPIC)]
        opic = [self.alpha_opic(name) for name in ALPHA_OPIC]
        return np.stack([*linear, *opic, *self.temperature], axis=1)

    def plain(self, k: int) -> dict[str, Any]:
        """Return what the k-th meter reads as plain data, ready for JSON; None for what is none."""
        T, Duv = (float(each[k]) for each in self.temperature)
        return {
            "illuminance": float(self["illuminance"][k]),
            "luminance": float(self["luminance"][k]),
            "edi": {name: float(self[name][k]) for name in ALPHA_OPIC},
            "alpha_opic_irradiance": {name: float(self.alpha_opic(name)[k]) for name in ALPHA_OPIC},
            "cct": None if math.isnan(T) else T,
            "duv": None if math.isnan(Duv) else Duv,
            "spectrum": self.irradiance[k].tolist(),
        }

    def lines(self, k: int, absolute: bool = True) -> list[str]:
        """Return what the k-th meter reads in words."""
        T, Duv = (float(each[k]) for each in self.temperature)
        units = {name: quantity(name).unit if absolute else "(relative)" for name in QUANTITIES}
        kelvin = "no white light" if math.isnan(T) else f"{T:.0f} K"
        duv = "" if math.isnan(Duv) else f", Duv {Duv:+.4f}"
        found = [
            f"{QUANTITIES[name].label}: {number(float(self[name][k]))} {units[name]}"
            for name in _SHOWN
        ]
        return [*found, f"Color Temperature: {kelvin}{duv}"]


_SHOWN: Sequence[str] = "illuminance", "melanopic", "luminance"


def number(value: float) -> str:
    """Return a number of three or four digits, as meters show them: 12,300 or 0.0123."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{digits}f}" if digits else f"{float(f'{value:.3g}'):,.0f}"
