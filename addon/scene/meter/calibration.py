"""What a World's numbers stand for in watts: told by its file, or by one measured value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ... import tags
from ...errors import InputError, parameter
from ...spectra.photometry import quantity
from ...transport import directions
from ..bake.light import SceneLight
from ..bake.sources import Sources
from ..blend_data import kept
from ..world import hdri, sky_image


@dataclass(frozen=True)
class Told:
    """One value that was measured, all else None.

    ``lux``: illuminance of sky and sun on the level in the open; ``spot``: luminance [cd/m²] of the
    sky, azimuth from +y clockwise and elevation [degrees] in the scene; ``white_luminance``
    [cd/m²]: of the HDRI's numbers (1, 1, 1).
    """

    lux: float | None = None
    spot: tuple[float, float, float] | None = None
    white_luminance: float | None = None


@dataclass(frozen=True)
class Calibration:
    """``scale``: from the light of a scene to W m^-2 sr^-1 nm^-1; ``line``: who says so."""

    scale: float
    absolute: bool
    line: str


def find(world: bpy.types.World, light: SceneLight, told: Told | None = None) -> Calibration:
    """Return what a World's light is in watts: as told, as kept with it, or as its file says.

    Where none is known, RGB (1, 1, 1) counts as 1 cd/m². Raises InputError for a value that is not
    above 0, and for a spot or a level without light.
    """
    told = told or Told(lux=kept_lux(world))
    sources, strength = light.sources, hdri.strength(world)
    if told.lux is not None:
        lux = _above_0("lux", told.lux)
        level = quantity("illuminance").row_on(level_spectrum(sources)[:, None])[0] * strength
        if level <= 0.0:
            raise InputError(parameter("lux"), "the sky is dark", "calibrate it by daylight")
        return Calibration(lux / level, True, f"calibrated by {lux:g} lx on the level")
    if told.spot is not None:
        luminance, azimuth, elevation = told.spot
        _above_0("spot", luminance)
        seen = quantity("luminance").row @ _seen(sources, azimuth, elevation) * strength
        if seen <= 0.0:
            raise InputError(parameter("spot"), "the sky is dark there", "give another direction")
        line = f"calibrated by {luminance:g} cd/m² at {azimuth:g}°, {elevation:g}° high"
        return Calibration(luminance / seen, True, line)
    white, line = told.white_luminance, "calibrated by the luminance of its white"
    if white is not None:
        _above_0("white_luminance", white)
    else:
        image = hdri.sky_of(world).image
        white = None if image is None else sky_image.white_luminance(image)
        line = "absolute: its file says the luminance of its white"
    # The luminance of what (1, 1, 1) restores to, 1 / efficacy for an HDRI that is colorimetric.
    mapping = sources.transfer
    ones = mapping.restoration @ mapping.unbalanced(np.ones(3))
    efficacy = quantity("luminance").row @ ones
    if white is None:
        line = "relative: tell the lux on the level, or the luminance of a spot"
        return Calibration(1.0 / efficacy, False, line)
    return Calibration(white / efficacy, True, line)


def level_spectrum(sources: Sources) -> np.ndarray:
    """Return the spectrum (81,) of irradiance / π of sky and sun on the level in the open."""
    up = np.array([[0.0, 0.0, 1.0]])
    seen = directions.open_light(sources.rgb.astype(np.float32), up)[0]
    spectrum = sources.transfer.restoration @ sources.transfer.unbalanced(seen)
    return spectrum + sum(
        (
            sources.restored(lamp.spectrum) * max(float(lamp.direction[2]), 0.0)
            for lamp in sources.lamps[: int(sources.sunny)]
        ),
        np.zeros(81),
    )


def _seen(sources: Sources, azimuth: float, elevation: float) -> np.ndarray:
    """The spectrum (81,) of the sky's radiance in a direction [degrees], the sun not in it."""
    a, e = np.radians([azimuth, elevation])
    way = np.array([[np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)]], np.float32)
    rgb = sources.rgb[directions.cells(way)[0]]
    return sources.transfer.restoration @ sources.transfer.unbalanced(rgb)


def kept_lux(world: bpy.types.World | None) -> float | None:
    """The lux on the level that are kept with a World, None without."""
    found: Any = None if world is None else world.get(tags.LEVEL_LUX)
    return float(found) if kept.is_number(found) and found > 0.0 else None


def keep_lux(world: bpy.types.World, lux: float) -> None:
    """Keep the lux on the level with a World; 0 takes them away."""
    if lux > 0.0:
        world[tags.LEVEL_LUX] = float(lux)
    elif tags.LEVEL_LUX in world:
        del world[tags.LEVEL_LUX]


def _above_0(name: str, value: float) -> float:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(parameter(name), f"{value:g}", "give a number above 0")
    return value
