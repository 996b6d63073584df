"""How a floor is lit: mean, minimum, uniformity, daylight factor, and where it is enough."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, parameter
from ...progress import Progress, mapped
from ...sky.cie_skies import cie_overcast
from ...spectra.illuminants import D65
from ...spectra.photometry import quantity
from ...transport import directions
from ..bake.light import SceneLight
from . import calibration, light_meter, lit_scene
from .calibration import Told
from .light_meter import Measured
from .places import Places

THRESHOLD = 300.0
"""[lx] that EN 17037 asks for on half of a floor, and EN 12464-1 for reading at a desk."""

GROUND = 0.2
"""Reflectance of the ground outdoors, where nothing in the scene stands there."""


@dataclass(frozen=True)
class Room:
    """What a grid of meters over a floor reads.

    ``measured``: in the scene's light; ``daylight_factor`` (n,), 0 to 1: the illuminance under the
    CIE's overcast sky over that in the open, without lamps; ``threshold`` [lx].
    """

    measured: Measured
    daylight_factor: NDArray[np.float64]
    threshold: float

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which meters (n,) do not stand in something solid."""
        return ~self.measured.inside

    def share_over(self, lux: float) -> float:
        """Which part of the floor, 0 to 1, has so many lux or more."""
        return float((self.measured.readings["illuminance"][self.valid] >= lux).mean())

    def on_grid(self, values: NDArray) -> NDArray[np.float64]:
        """Values (n,) as (rows, columns) of the grid, NaN where it has no meter."""
        places = self.measured.places
        assert places.shape is not None and places.cells is not None
        result = np.full(places.shape, np.nan)
        result.flat[places.cells[self.valid]] = values[self.valid]
        return result

    def figures(self, values: NDArray) -> tuple[float, float, float, float]:
        """Mean, minimum, maximum and uniformity (minimum over mean) of values (n,)."""
        found = values[self.valid]
        mean, low, high = float(found.mean()), float(found.min()), float(found.max())
        return mean, low, high, low / mean if mean > 0.0 else 0.0


class Overcast(SceneLight):
    """The CIE's overcast sky over what another light shines on: no sun, no lamps, nothing glows.

    Its color is D65's; the ground outdoors reflects `GROUND`.
    """

    def __init__(self, light: SceneLight) -> None:
        before = light.sources
        mapping = before.transfer
        white = mapping.S_in @ D65()
        white = white / mapping.unbalanced(np.ones(3))
        ways, _ = directions.centres()
        up = ways[:, 2]
        luminance = np.where(up > 0.0, cie_overcast(np.arcsin(up)), GROUND * LEVEL)
        dark = np.zeros_like(before.ground)
        rgb = luminance[:, None] * white
        found = replace(before, rgb=rgb, ground=dark, lamps=[], sunny=False)
        super().__init__(found, 1.0, emits=False)


LEVEL = 7.0 / 9.0
"""Irradiance / pi of level ground under an overcast sky whose zenith is 1."""


def surveying(
    world: bpy.types.World,
    light: SceneLight,
    places: Places,
    told: Told | None = None,
    threshold: float | None = None,
) -> Generator[Progress, None, Room]:
    """Measure a floor in the scene's light and under the overcast sky, yielding how far that is.

    ``threshold`` [lx]: `THRESHOLD` where None. Raises InputError as `light_meter.measuring` does,
    for a threshold where the light is only relative, and where all meters stand in something solid.
    """
    if threshold is not None and not (np.isfinite(threshold) and threshold > 0.0):
        raise InputError(parameter("threshold"), f"{threshold:g}", "give a number above 0")
    work = light_meter.measuring(world, light, places, told)
    measured = yield from mapped(work, lambda step: Progress(0.6 * step.done, step.line))
    if threshold is not None and not measured.calibration.absolute:
        cure = "tell the lux on the level, or the luminance of a spot"
        raise InputError(parameter("threshold"), "the sky's light is only relative", cure)
    if measured.inside.all():
        raise InputError(parameter("grid"), "all of it lies inside something solid", "raise it")
    lit = yield from lit_scene.casting(light)
    overcast = Overcast(light)
    again = lit.reading(overcast, places.points, places.normals)
    irradiance, _, _ = yield from mapped(
        again, lambda step: Progress(0.2 + 0.8 * step.done, "the overcast sky")
    )
    row = quantity("illuminance").row
    outdoors = np.pi * row @ calibration.level_spectrum(overcast.sources)
    factor = irradiance @ row / outdoors
    return Room(measured, factor, threshold or THRESHOLD)
