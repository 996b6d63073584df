"""Measuring light at places of the open scene, in absolute units where it is calibrated."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress
from ...spectra.grid import WAVELENGTHS
from ...transfer.readings import Readings, number
from ..bake.light import SceneLight
from . import calibration, lit_scene
from .calibration import Calibration, Told
from .places import Places

_UNITS = {
    "illuminance": "lx",
    "edi": "lx",
    "luminance": "cd/m²",
    "alpha_opic_irradiance": "W/m²",
    "spectrum": "W/(m² nm)",
}
"""Of `Measured.plain`; color temperatures are in kelvin."""

UNTOLD = 0.5
"""A meter of whose rays less than this part tell anything stands in something solid."""


@dataclass(frozen=True)
class Measured:
    """What meters read: ``told`` (n,) is what part of their rays tells anything."""

    places: Places
    readings: Readings
    told: NDArray[np.float64]
    calibration: Calibration

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Which meters (n,) stand in something solid: what they read is worth nothing."""
        return self.told < UNTOLD

    def lines(self) -> list[str]:
        """All of it in words."""
        found = [f"Light: {self.calibration.line}"]
        pairs = zip(self.places.points, self.places.normals, self.inside, strict=True)
        for k, (point, normal, inside) in enumerate(pairs):
            at, way = (", ".join(f"{value:.4g}" for value in each) for each in (point, normal))
            found.append(f"At {at}, looking along {way}:")
            own = self.readings.lines(k, self.calibration.absolute)
            own = ["inside something solid: move it"] if inside else own
            found += [f"  {line}" for line in own]
        return found

    def plain(self) -> dict[str, Any]:
        """All of it as plain data, ready for JSON."""
        points = []
        for k, (point, normal) in enumerate(
            zip(self.places.points, self.places.normals, strict=True)
        ):
            found = {"at": point.tolist(), "normal": normal.tolist()}
            inside = bool(self.inside[k])
            points.append({**found, "inside": inside, **self.readings.plain(k)})
        return {
            "absolute": self.calibration.absolute,
            "calibration": self.calibration.line,
            "units": _UNITS if self.calibration.absolute else dict.fromkeys(_UNITS, "relative"),
            "wavelengths": WAVELENGTHS.tolist(),
            "points": points,
        }


def measuring(
    world: bpy.types.World, light: SceneLight, places: Places, told: Told | None = None
) -> Generator[Progress, None, Measured]:
    """Measure the light at places of the open scene, yielding how far that is.

    ``light``: what shines on it; ``told``: what it is calibrated by, else what is known of it.
    Raises InputError as `calibration.find` does.
    """
    known = calibration.find(world, light, told)
    lit = yield from lit_scene.casting(light)
    irradiance, radiance, shares = yield from lit.reading(light, places.points, places.normals)
    return Measured(
        places, Readings(irradiance * known.scale, radiance * known.scale), shares, known
    )


def said(measured: Measured) -> str:
    """What one meter reads in a line: lux, melanopic lux and temperature."""
    readings = measured.readings
    T = float(readings.temperature[0][0])
    unit = "lx" if measured.calibration.absolute else "(relative)"
    kelvin = "" if np.isnan(T) else f", {T:.0f} K"
    lux, melanopic = (float(readings[name][0]) for name in ("illuminance", "melanopic"))
    return f"{number(lux)} {unit}, melanopic {number(melanopic)}{kelvin}"
