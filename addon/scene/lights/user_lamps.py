"""The user's own lamps: a twin of each shines in the light probe, by the class of its spectrum.

A twin is strong and of one of the probe's colours; its place, energy and visibility follow the
user's lamp, which stays as it is for all that is not managed.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ....node_groups import light_probe
from ....node_groups.drivers import drive
from ... import tags
from ...grouping import grouped
from ...spectra.sensitivities import observer
from ...spectra.working_spaces import LUMINANCE, rec709_to_working
from ...transfer.lamps import Classes, classes, lamp_spectrum
from ...transfer.matrices import Transfer
from ...transfer.prefilter import balanced_rgb
from ..blend_data import kept
from . import rendered_lamps, sun_lamp
from .rendered_lamps import RenderedLamp

TWIN = "twin"

NOTICED = 0.02
"""By which part a lamp's color is off where one would see it: CIEDE2000 1 or so."""


def spectrum_of(light: bpy.types.Light) -> str:
    """What a lamp's spectrum is, as `transfer.lamps.lamp_spectrum` understands it; empty: color."""
    return kept.text(light, tags.LAMP_SPECTRUM)


def set_spectrum(light: bpy.types.Light, spectrum: str) -> None:
    """Give a lamp a spectrum, or with an empty one let its color tell it again."""
    if spectrum.strip():
        light[tags.LAMP_SPECTRUM] = spectrum.strip()
    elif tags.LAMP_SPECTRUM in light:
        del light[tags.LAMP_SPECTRUM]


@dataclass(frozen=True)
class Lamps:
    """The lamps of a scene: where they ``shine``, ``colours`` (k, 3) with which their energy
    counts, the ``classes`` of their spectra, and ``left_out``, lines on what is not carried."""

    shining: tuple[RenderedLamp, ...]
    colours: NDArray[np.float64]
    classes: Classes
    left_out: tuple[str, ...] = ()


def find(scene: bpy.types.Scene, transfer: Transfer, rho: NDArray[np.float64]) -> Lamps | None:
    """Return the lamps that shine on a scene's renders, None without.

    ``rho`` (m, 81): the materials by which spectra are told apart. Raises InputError for a
    spectrum that cannot be read, with the lamp's name.
    """
    shining = rendered_lamps.of_scene(scene)
    if not shining:
        return None
    spectra, colours, left_out = [], [], []
    for one in shining:
        light, nodes = one.lamp.data, rendered_lamps.nodes_of(one.lamp.data)
        own = _colour(light)
        if nodes.left_out:
            left_out.append((one.lamp.name, f"shines without its nodes: {nodes.left_out}"))
        if not one.everywhere:
            left_out.append((one.lamp.name, "lights spectral materials in all view layers"))
        given: str | NDArray[np.float64] = kept.text(light, tags.LAMP_SPECTRUM)
        if not given and nodes.kelvin and np.ptp(own) < 1e-6 * own.max():
            given = f"{nodes.kelvin:g}K"
        colour = own * nodes.factor * _black_body(nodes.kelvin, transfer)
        spectra.append(lamp_spectrum(given or colour * transfer.neutral, transfer.space))
        colours.append(colour)
    energies = np.array([one.lamp.data.energy for one in shining])
    strengths = energies * luminance(np.array(colours), transfer)
    names = tuple(one.name for one in shining)
    reference = rho if len(rho) else np.full((1, 81), 0.5)
    found = classes(np.array(spectra), strengths, reference, names=names)
    return Lamps(tuple(shining), np.array(colours), found, tuple(grouped(left_out, "lamp")))


def place(scene: bpy.types.Scene, lamps: Lamps, transfer: Transfer) -> None:
    """Give each lamp its twin, up to date; twins of lamps that are gone leave."""
    sun_lamp.remove(scene, (TWIN,))
    brightness = luminance(lamps.colours, transfer)
    kinds = lamps.classes.assignment.tolist()
    for one, kind, Y in zip(lamps.shining, kinds, brightness, strict=True):
        lamp, channel = one.lamp, 1 + kind
        twin = sun_lamp.new_lamp(scene, f"Skylight {lamp.name}", lamp.data, TWIN, channel)
        if hasattr(twin.data, "use_temperature"):
            twin.data.use_temperature = False
        _stand(twin, one)
        drive(twin.data, "energy", lamp.data, "energy", factor=light_probe.STRENGTH * float(Y))
        for path in ("hide_render", "hide_viewport"):
            drive(twin, path, lamp, path)
        spectrum = lamps.classes.spectra[kind]
        sun_lamp.set_cycles_colour(twin, balanced_rgb(spectrum, transfer), channel)


def in_other_colours(lamps: Lamps, transfer: Transfer) -> list[str]:
    """Names of the lamps whose own color is another than their spectrum's, by 2 % or more."""
    own = lamps.colours / luminance(lamps.colours, transfer)[:, None]
    kinds = lamps.classes.assignment.tolist()
    spectra = [balanced_rgb(lamps.classes.spectra[kind], transfer) for kind in kinds]
    off = np.abs(own - np.array(spectra)).max(axis=1) > NOTICED
    return [one.name for one, other in zip(lamps.shining, off, strict=True) if other]


def _stand(twin: bpy.types.Object, one: RenderedLamp) -> None:
    """Let a twin stand where its lamp is shown, and move with all that puts it there."""
    follow = twin.constraints.new("COPY_TRANSFORMS")
    follow.target = one.lamp
    if one.fixed:
        follow.enabled = False  # by it the lamp is known all the same
        twin.matrix_world = Matrix(one.matrix.tolist())
    for empty in reversed(one.through):
        carried = twin.constraints.new("CHILD_OF")
        carried.target = empty
        offset = Matrix.Translation(-empty.instance_collection.instance_offset)
        carried.inverse_matrix = offset


def _black_body(kelvin: float, transfer: Transfer) -> NDArray[np.float64]:
    """The colour of a Blackbody node, of luminance 1; white for 0."""
    if not kelvin:
        return np.ones(3)
    rgb = observer(transfer.space) @ lamp_spectrum(kelvin)
    return np.maximum(rgb / luminance(rgb, transfer), 1e-6)


def _colour(light: bpy.types.Light) -> NDArray[np.float64]:
    """With what colour a lamp's energy counts, its temperature's too."""
    colour = np.array(light.color, dtype=float)
    if getattr(light, "use_temperature", False):
        colour = colour * np.array(light.temperature_color, dtype=float)
    return np.maximum(colour, 1e-6) * 2.0 ** getattr(light, "exposure", 0.0)


def luminance(colours: NDArray[np.float64], transfer: Transfer) -> NDArray[np.float64]:
    """Return the luminance (k,) of colours (k, 3) in the working space."""
    return colours @ np.linalg.inv(rec709_to_working(transfer.space)).T @ LUMINANCE
