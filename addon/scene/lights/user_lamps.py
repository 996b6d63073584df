"""The user's own lamps: a twin of each shines in the light probe, by the class of its spectrum.

A twin is strong and of one of the probe's colours; its place, energy and visibility follow the
user's lamp, which stays as it is for all that is not managed.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ....node_groups import light_probe
from ....node_groups.drivers import drive
from ... import tags
from ...spectra.working_spaces import LUMINANCE, rec709_to_working
from ...transfer.lamps import Classes, classes, lamp_spectrum
from ...transfer.matrices import Transfer
from ...transfer.prefilter import balanced_rgb
from . import sun_lamp

TWIN = "twin"


def spectrum_of(light: bpy.types.Light) -> str:
    """What a lamp's spectrum is, as `transfer.lamps.lamp_spectrum` understands it; empty: color."""
    return light.get(tags.LAMP_SPECTRUM, "")


def set_spectrum(light: bpy.types.Light, spectrum: str) -> None:
    """Give a lamp a spectrum, or with an empty one let its color tell it again."""
    if spectrum.strip():
        light[tags.LAMP_SPECTRUM] = spectrum.strip()
    elif tags.LAMP_SPECTRUM in light:
        del light[tags.LAMP_SPECTRUM]


@dataclass(frozen=True)
class Lamps:
    """The lamps of a scene: their ``names``, ``colours`` (k, 3) with which their energy counts, and
    the ``classes`` of their spectra."""

    names: tuple[str, ...]
    colours: NDArray[np.float64]
    classes: Classes


def find(scene: bpy.types.Scene, transfer: Transfer, rho: NDArray[np.float64]) -> Lamps | None:
    """Return the lamps that shine on a scene's renders, None without.

    ``rho`` (m, 81): the materials by which spectra are told apart. Raises InputError for a
    spectrum that cannot be read, with the lamp's name.
    """
    shown = [
        obj
        for obj in scene.objects
        if obj.type == "LIGHT" and tags.LAMP not in obj and not obj.hide_render
        if obj.data.energy > 0.0
    ]
    if not shown:
        return None
    colours = np.array([_colour(obj.data) for obj in shown])
    spectra = []
    for obj, colour in zip(shown, colours, strict=True):
        given = obj.data.get(tags.LAMP_SPECTRUM)
        spectra.append(lamp_spectrum(given or colour * transfer.neutral, transfer.space))
    strengths = np.array([obj.data.energy for obj in shown]) * luminance(colours, transfer)
    names = tuple(obj.name for obj in shown)
    reference = rho if len(rho) else np.full((1, 81), 0.5)
    return Lamps(names, colours, classes(np.array(spectra), strengths, reference, names=names))


def place(scene: bpy.types.Scene, lamps: Lamps, transfer: Transfer) -> None:
    """Give each lamp its twin, up to date; twins of lamps that are gone leave."""
    sun_lamp.remove(scene, (TWIN,))
    brightness = luminance(lamps.colours, transfer)
    kinds = lamps.classes.assignment.tolist()
    for name, kind, Y in zip(lamps.names, kinds, brightness, strict=True):
        lamp = scene.objects[name]
        channel = 1 + kind
        twin = sun_lamp.new_lamp(scene, f"Skylight {name}", lamp.data, TWIN, channel)
        if hasattr(twin.data, "use_temperature"):
            twin.data.use_temperature = False
        twin.constraints.new("COPY_TRANSFORMS").target = lamp
        drive(twin.data, "energy", lamp.data, "energy", factor=light_probe.STRENGTH * Y)
        for path in ("hide_render", "hide_viewport"):
            drive(twin, path, lamp, path)
        spectrum = lamps.classes.spectra[kind]
        sun_lamp.set_cycles_colour(twin, balanced_rgb(spectrum, transfer), channel)


def _colour(light: bpy.types.Light) -> NDArray[np.float64]:
    """With what colour a lamp's energy counts, its temperature's too."""
    colour = np.array(light.color, dtype=float)
    if getattr(light, "use_temperature", False):
        colour = colour * np.array(light.temperature_color, dtype=float)
    return np.maximum(colour, 1e-6) * 2.0 ** getattr(light, "exposure", 0.0)


def luminance(colours: NDArray[np.float64], transfer: Transfer) -> NDArray[np.float64]:
    """Return the luminance (k,) of colours (k, 3) in the working space."""
    return colours @ np.linalg.inv(rec709_to_working(transfer.space)).T @ LUMINANCE
