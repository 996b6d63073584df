"""Which channels of an OpenEXR file are spectra of light, and at which wavelengths.

A. Fichet, R. Pacanowski and A. Wilkie 2021, *An OpenEXR Layout for Spectral Images*, Journal of
Computer Graphics Techniques 10(3), https://jcgt.org/published/0010/03/01/. A channel of light is
called ``S0.550,0nm``, S1 to S3 are its polarisation, ``T.550,0nm`` is a reflectance. Numbers have a
decimal comma, wavelengths or frequencies any prefix of the SI.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..spectra.grid import WAVELENGTHS
from .exr_header import Channel, Part
from .exr_layers import shown

_NUMBER = r"(\d+(?:[.,]\d*)?(?:[eE][+-]?\d+)?)"
_UNIT = r"(Y|Z|E|P|T|G|M|k|h|da|d|c|m|u|µ|μ|n|p)?(m|Hz)"
_CHANNEL = re.compile(rf"(?:(.+)\.)?(S[0-3]|T)\.(?:{_NUMBER}{_UNIT}\.)?{_NUMBER}{_UNIT}")
_SAMPLE = re.compile(rf"\s*{_NUMBER}{_UNIT}\s*:\s*([-+]?{_NUMBER[1:-1]})\s*")

_PREFIXES = {
    **{"Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1},
    **{"d": -1, "c": -2, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9, "p": -12},
}
"""Powers of ten."""

_LIGHT_SPEED = 299792458.0  # [m/s]

_POSSIBLE = 1.0, 1e6  # [nm]

_SHARP = 10.0
"""Condition number over which sensitivities overlap too much to be told apart."""


@dataclass(frozen=True)
class SpectralLayout:
    """Spectra of light in a part of a file.

    ``channels`` and their ``wavelengths`` (n,) [nm], ascending, as many as the grid needs;
    ``sharpen`` (n, n): from what channels hold to radiance at these; ``absolute``: whether that is
    [W m^-2 sr^-1 nm^-1]; ``notes``: a sentence on each thing that is not used.
    """

    part: Part
    channels: tuple[Channel, ...]
    wavelengths: NDArray[np.float64]
    sharpen: NDArray[np.float64]
    absolute: bool
    notes: tuple[str, ...]


def find_spectra(parts: list[Part], place: object) -> SpectralLayout | None:
    """Return the spectra of light that a file holds; None where no channel is called so.

    Of several layers or parts that with the most of them. Raises `InputError` for a file of
    reflectances or of polarisation alone, and for two channels of one wavelength.
    """
    layers: dict[tuple[int, str, str], list[tuple[float, Channel]]] = {}
    for number, part in enumerate(parts):
        for channel in part.channels if not part.deep else ():
            found = _CHANNEL.fullmatch(channel.name)
            if not found or not channel.kind or channel.sampling != (1, 1):
                continue
            wavelength = _nanometers(*found.group(6, 7, 8))
            if _POSSIBLE[0] < wavelength < _POSSIBLE[1]:
                key = number, found[1] or "", found[2]
                layers.setdefault(key, []).append((wavelength, channel))
    light = [key for key in layers if key[2] == "S0"]
    kinds = {key[2] for key in layers}
    if not kinds:
        return None
    if not light and "T" in kinds:
        cure = "use a spectral picture of light, whose channels begin with S0"
        raise InputError(place, "holds reflectances (channels T), not light", cure)
    if not light:
        cure = "save the radiance too, as channels S0"
        raise InputError(place, "holds the polarisation of light alone (channels S1 to S3)", cure)
    best = max(light, key=lambda key: (len(layers[key]), -key[0]))
    samples = sorted(layers[best], key=lambda sample: sample[0])
    for (one, first), (other, second) in pairwise(samples):
        if other - one < 1e-3:
            names = shown([first.name, second.name])
            raise InputError(place, f"has two channels of one wavelength: {names}", "keep one")
    samples = _visible(samples)
    wavelengths = np.array([wavelength for wavelength, _ in samples])
    channels = tuple(channel for _, channel in samples)
    part = parts[best[0]]
    notes = []
    if kinds & {"S1", "S2", "S3"}:
        notes.append("its polarisation (channels S1 to S3) is not used")
    if "T" in kinds:
        notes.append("its reflectances (channels T) are not light: not used")
    sharpen, told = _sharpening(channels, wavelengths, part.attributes)
    notes += [told] if told else []
    absolute, size = _units(part.attributes)
    return SpectralLayout(part, channels, wavelengths, sharpen, absolute, (*notes, *size))


def _nanometers(number: str, prefix: str | None, unit: str) -> float:
    value = float(number.replace(",", ".")) * 10.0 ** _PREFIXES.get(prefix or "", 0)
    if unit == "Hz":
        value = _LIGHT_SPEED / value if value > 0.0 else np.inf
    return value * 1e9


def _visible(samples: list[tuple[float, Channel]]) -> list[tuple[float, Channel]]:
    """Leave out what lies beyond the grid and the next sample on either side."""
    nodes = np.array([wavelength for wavelength, _ in samples])
    first = max(int(np.searchsorted(nodes, WAVELENGTHS[0], side="right")) - 1, 0)
    last = int(np.searchsorted(nodes, WAVELENGTHS[-1]))
    return samples[first : last + 1] or samples


def _units(attributes: Mapping[str, Any]) -> tuple[bool, list[str]]:
    """Return whether the light's units are known, and what else the header says of its size."""
    units = str(attributes.get("emissiveUnits", "")).replace(" ", "")
    absolute = re.fullmatch(r"W\.?m\^?-2\.?sr\^?-1(\.?nm\^?-1)?", units) is not None
    told = []
    if not absolute:
        said = f"are {shown([units])}" if units else "are not said"
        told.append(f"the units of its light {said}: how bright it is cannot be told")
    exposure = attributes.get("EV", attributes.get("exposureCompensation"))
    if isinstance(exposure, int | float) and exposure:
        told.append(f"its header asks for {exposure:+g} EV of exposure: light stays as it is")
    for name in ("lensTransmission", "cameraResponse"):
        if attributes.get(name):
            told.append(f"its header tells the {name}, which is taken to be undone already")
    return absolute, told


def _sharpening(
    channels: tuple[Channel, ...], wavelengths: NDArray[np.float64], attributes: Mapping[str, Any]
) -> tuple[NDArray[np.float64], str]:
    """Return the matrix (n, n) from means under channels' sensitivities to radiance, and a note."""
    count = wavelengths.size
    plain = np.eye(count)
    curves = [_curve(attributes.get(channel.name)) for channel in channels]
    if all(curve is None for curve in curves):
        return plain, ""
    means = plain.copy()
    for k, curve in enumerate(curves):
        if curve is None:
            continue
        fine = np.arange(curve[0][0], curve[0][-1] + 0.5)
        weight = np.interp(fine, *curve)
        if weight.sum() > 0.0:
            hats = np.array([np.interp(fine, wavelengths, one) for one in plain])
            means[k] = hats @ weight / weight.sum()
    if not np.linalg.cond(means) < _SHARP:
        return plain, "its channels' sensitivities overlap too much to be told apart: not used"
    return np.linalg.inv(means), ""


def _curve(text: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Read ``400nm:0.1;410nm:0.5;…`` as wavelengths [nm], ascending, and values."""
    found: dict[float, float] = {}
    for part in str(text or "").split(";"):
        if sample := _SAMPLE.fullmatch(part):
            found[_nanometers(*sample.group(1, 2, 3))] = float(sample[4].replace(",", "."))
    nodes = np.array(sorted(found))
    if len(nodes) < 2 or not np.isfinite(nodes).all() or nodes[-1] - nodes[0] > 1e4:
        return None
    return nodes, np.maximum([found[node] for node in nodes.tolist()], 0.0)
