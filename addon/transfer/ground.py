"""Light from below: sky and sun that some ground, or a wall, has reflected before.

Its spectrum is no sky's but a sky's times the reflectance ``rho_g`` of what it came from. So its
matrix is ``M(rho_g rho)``, not the product of two matrices. Where all of it comes from one ground
under one sky its spectrum is one, and three numbers a material do: see `prefilter`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import GROUNDS, listed
from ..errors import InputError, parameter
from ..sky.direct_sun import SunLight
from ..sky.irradiance import exact_irradiance, running_sums, spread
from ..sky.light import SkyLight
from ..sky.polynomial import exponents, monomials
from ..spectra.daylight_locus import LIMIT, locus_distance
from ..spectra.grid import WEIGHTS
from ..spectra.metamer import spectrum_with_colour
from ..spectra.sensitivities import cmfs
from .matrices import Transfer
from .prefilter import balanced_rgb

CHOICES = tuple(name for name in GROUNDS if name != "auto")
"""The panorama's own lower half, an endless level ground of one reflectance, or darkness."""

GREY = 0.2
"""Reflectance of a modelled ground that nobody named: what the add-on's own skies have."""

DEGREE = 2
"""Of the polynomial of the panorama's lower half: 2 % of the light at worst, where walls reach far
under the horizon 7 %. A third degree holds nothing more, as half a sphere has none."""


@dataclass(frozen=True)
class GroundLight:
    """Light from below.

    ``spectrum`` (81,): irradiance / pi of a face that looks down, in units of the HDRI before it
    was balanced, for `prefilter.prefiltered`; ``coefficients`` ((d + 1)^2, 3): irradiance / pi
    of the scene by a face's normal, as `sky.polynomial` has it, to multiply the prefiltered
    reflectance by; ``line``: a sentence that says what it is.
    """

    choice: str
    spectrum: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    line: str


def split(rgb: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return a panorama (h, w, 3) with all under the horizon black, and with all over it black.

    A middle row, of an odd number, is half of either.
    """
    rgb = np.asarray(rgb, np.float32)
    height = len(rgb)
    over = np.clip(height / 2 - np.arange(height), 0.0, 1.0)[:, None, None].astype(np.float32)
    return rgb * over, rgb * (1.0 - over)


def ground_light(
    choice: str,
    light: SkyLight,
    mapping: Transfer,
    sun: SunLight | None = None,
    reflectance: ArrayLike = GREY,
) -> GroundLight:
    """Return the light from below for one of `CHOICES`; the sky's is then that of `split`'s first.

    Parameters
    ----------
    light
        What `sky.light.analyse` found in the HDRI.
    mapping
        That of the materials: what made the HDRI's numbers, its white and its basis.
    sun
        What `direct_sun.restored_sun` made of ``light.sun``; it lights the ground too.
    reflectance
        Of the modelled ground, one number or (81,).

    Raises
    ------
    InputError
        For another choice.
    """
    if choice not in CHOICES:
        raise InputError(
            parameter("ground"), f"'{choice}' is not a ground", f"choose {listed(CHOICES)}"
        )
    upper, lower = split(light.sky)
    below = running_sums(lower)  # which are most of the work, and serve three times
    seen = exact_irradiance(below, [[0.0, 0.0, -1.0]])[0]
    if choice == "none" or (choice == "hdri" and not seen.any()):
        line = "no light comes from below" + (": the HDRI is black there" * (choice == "hdri"))
        return GroundLight("none", np.zeros(WEIGHTS.size), np.zeros((1, 3)), line)
    V = cmfs()[1] * WEIGHTS
    white = np.ones(3) if mapping.white is None else mapping.white
    lit = mapping.restoration @ (exact_irradiance(upper, [[0.0, 0.0, 1.0]])[0] * white)
    if sun is not None and light.sun is not None:
        lit = lit + sun.spectrum * max(float(light.sun.direction[2]), 0.0)
    lit = np.maximum(lit, 1e-6 * lit.max())  # a restored spectrum may dip under 0 at its ends
    if choice == "modelled":
        spectrum = lit * np.asarray(reflectance, dtype=float)
        # What a face sees of an evenly bright plane under it: (1 - z) / 2 of its radiance.
        shape = [{(0, 0, 0): 0.5, (0, 0, 1): -0.5}.get(each, 0.0) for each in exponents(1)]
        coefficients = np.outer(shape, balanced_rgb(spectrum, mapping))
        line = (
            f"light from below: level ground that reflects {100 * V @ spectrum / (V @ lit):.0f} %"
        )
        return GroundLight(choice, spectrum, coefficients, line)
    line = "light from below: the HDRI's own ground"
    grey = light.spectrum is None and _is_grey(seen, light, mapping)
    # Of a grey ground its light is skylight and sunlight: the sky's own basis knows that best.
    spectrum = mapping.restoration @ (seen * white) if grey else None
    if light.spectrum is not None:
        spectrum = np.maximum(light.spectrum.below, 0.0)
    if spectrum is None or spectrum.min() < 0.0:
        spectrum = spectrum_with_colour(lit, seen * white, mapping.S_in)
    if spectrum is None:
        spectrum = lit * (V @ mapping.restoration @ (seen * white) / (V @ lit))
        line += ", treated as gray: no light has its color"
    # Into the scene's space, and of the size that the prefiltered reflectance is relative to.
    shown = mapping.to_working @ seen
    size = balanced_rgb(spectrum, mapping) / np.where(shown == 0, 1.0, shown)
    normals = spread(1000)
    terms, target = monomials(normals, DEGREE), exact_irradiance(below, normals)
    coefficients = np.linalg.lstsq(terms, target, rcond=None)[0] @ mapping.to_working.T * size
    return GroundLight(choice, spectrum, coefficients, line)


def is_grey(light: SkyLight, mapping: Transfer) -> bool:
    """Return whether the light of an HDRI's lower half has the colour of a sky's or a sun's.

    Then it needs no spectrum of its own: the material's matrix for skylight serves it.
    """
    return _is_grey(exact_irradiance(split(light.sky)[1], [[0.0, 0.0, -1.0]])[0], light, mapping)


def _is_grey(seen: NDArray[np.float64], light: SkyLight, mapping: Transfer) -> bool:
    """Return the same for the lower half's RGB irradiance (3,) from below."""
    white = np.ones(3) if mapping.white is None else mapping.white
    away = locus_distance(seen * white, mapping.S_in, light.sun_elevation(), direct_sun=True)
    return bool(away <= LIMIT)
