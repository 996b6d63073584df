"""Light of one spectrum, of sun, ground, glazing or lamp, as further rows of the chart.

What such a light is the HDRI tells in part: the sun's colour and place, the ground's colour, or
which ground or glass it is. Ways to shade with it are `methods.Method`s that look at a `Known` sky.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..sky.direct_sun import direct_sunlight
from ..spectra.grid import WAVELENGTHS
from ..spectra.metamer import spectrum_with_colour
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import LUMINANCE
from ..transfer.lamps import lamp_spectrum
from ..transfer.matrices import transfer
from ..transfer.prefilter import light_rgb, prefiltered
from .methods import METHODS, Method, Prepared, Sky, product

GROUNDS = {
    # Rough shapes: grass green with a steep rise after 700 nm, the others rising towards red.
    "grass": ([380, 500, 550, 600, 670, 690, 740, 780], [3, 4, 9, 6, 4, 6, 40, 45]),
    "soil": ([380, 550, 780], [8, 18, 32]),
    "brick": ([380, 530, 580, 620, 780], [5, 8, 20, 28, 36]),
    "concrete": ([380, 500, 780], [22, 30, 34]),
}
"""Reflectances [%] at wavelengths [nm] of what lies below."""

GLASSES = {
    # 6 mm tinted in the mass, roughly: green by iron, bronze by selenium, and an evenly grey one.
    "green": ([380, 450, 520, 600, 700, 780], [66, 77, 80, 73, 57, 48]),
    "bronze": ([380, 450, 500, 570, 650, 780], [34, 45, 47, 53, 62, 66]),
    "grey": ([380, 450, 550, 650, 780], [40, 43, 43, 41, 46]),
}
"""Transmittances [%] at wavelengths [nm], after M. Rubin 1985, DOI 10.1016/0165-1633(85)90052-8."""

LAMPS = ("A", "FL11", "LED-B3", "HP1")
"""A bulb, a three-band tube, a white LED and a street lamp."""


@dataclass(frozen=True)
class Known(Sky):
    """A light (1, 81), and what is known of it.

    ``sky_rgb`` (3,), ``sun_rgb`` (3,): RGB of the sky's and the sun's light on level ground;
    ``by`` (81,): the reflectance or transmittance of what sent it here; ``lamp``: its name.
    """

    sky_rgb: NDArray[np.float64] | None = None
    sun_rgb: NDArray[np.float64] | None = None
    by: NDArray[np.float64] | None = None
    lamp: str = ""


def cases(skies: Iterable[tuple[Sky, NDArray[np.float64]]]) -> dict[str, list[Sky]]:
    """Return lights by kind: "sun", "ground", "glass" and "lamp".

    ``skies``: skies whose first light is that on level ground, and the sun's (81,) on the same;
    where there is no sun, sky alone lights the ground.
    """
    S = observer()
    found: dict[str, list[Sky]] = {"sun": [], "ground": [], "glass": []}
    for sky, sun in skies:
        shade = sky.lights[0]
        seen = {"sky_rgb": S @ shade, "sun_rgb": S @ sun}
        if sun.any():
            found["sun"].append(Known(_even(sun), sky.sun_elevation, **seen))
        for kind, some in (("ground", GROUNDS), ("glass", GLASSES)):
            for at, percent in some.values():
                by = np.interp(WAVELENGTHS, at, percent) / 100.0
                light = _even((shade + sun) * by)
                found[kind].append(Known(light, sky.sun_elevation, by=by, **seen))
    found["lamp"] = [Known(_even(lamp_spectrum(name)), lamp=name) for name in LAMPS]
    return {kind: lights for kind, lights in found.items() if lights}


def ways(kind: str) -> Mapping[str, Method]:
    """Return the ways to shade with a kind of light, by name: today's, a sky's matrix, and ours."""
    today = METHODS["RGB × RGB in Rec.709"]
    ours = {"as skylight": Method("as skylight", "3x3", _as_sky, ("colour",))}
    for name, (family, spectrum) in _SPECTRA[kind].items():
        ours[name] = Method(name, family, _with_spectrum(spectrum), ("colour",))
    return {today.name: today, **ours}


def _even(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a light as (1, 81) of luminance 1, as the skies' are."""
    return (light / (observer() @ light @ LUMINANCE))[None]


def _as_sky(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
    """The matrix that the sky's light has, for all light: one matrix a material."""
    assert isinstance(sky, Known)
    mapping = transfer("atmosphere", sun_elevation=sky.sun_elevation, sky_rgb=sky.sky_rgb)
    return Prepared(mapping.S_in, mapping.matrices(rho))


def _with_spectrum(spectrum: Callable[[Known], NDArray[np.float64]]) -> Callable:
    """Three numbers a material, from what the light's spectrum is believed to be."""

    def prepare(sky: Sky, rho: NDArray[np.float64]) -> Prepared:
        assert isinstance(sky, Known)
        believed = spectrum(sky)
        # Of colours out of gamut, as low suns and sodium have them, pixels keep their sign.
        to_pixel = light_rgb(believed) / (observer() @ believed)
        return Prepared(observer(), (prefiltered(rho, believed) * to_pixel)[:, :, None], product)

    return prepare


def _rgb(sky: Known) -> NDArray[np.float64]:
    return observer() @ sky.lights[0]


def _of_sun(sky: Known) -> NDArray[np.float64]:
    return _sun(sky, _rgb(sky))


def _sun(sky: Known, rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sun's spectrum, with this very colour, as `direct_sun.restored_sun` makes it."""
    assert sky.sun_elevation is not None
    likely = direct_sunlight(sky.sun_elevation, rgb)
    exact = spectrum_with_colour(likely, rgb, observer())
    return likely if exact is None else exact


def _on_ground(sky: Known) -> NDArray[np.float64]:
    """What sky and sun give level ground, by their RGB."""
    assert sky.sky_rgb is not None and sky.sun_rgb is not None
    mapping = transfer("atmosphere", sun_elevation=sky.sun_elevation, sky_rgb=sky.sky_rgb)
    lit = np.maximum(mapping.restoration @ sky.sky_rgb, 1e-6)
    return lit + _sun(sky, sky.sun_rgb) if sky.sun_rgb.any() else lit


def _of_hdris_ground(sky: Known) -> NDArray[np.float64]:
    lit = _on_ground(sky)
    found = spectrum_with_colour(lit, _rgb(sky), observer())
    return lit if found is None else found


def _of_known(sky: Known) -> NDArray[np.float64]:
    assert sky.by is not None
    return _on_ground(sky) * sky.by


_SPECTRA: dict[str, dict[str, tuple[str, Callable[[Known], NDArray[np.float64]]]]] = {
    "sun": {"prefiltered, colour + place known": ("prefiltered", _of_sun)},
    "ground": {
        "prefiltered, its colour known": ("prefiltered", _of_hdris_ground),
        "prefiltered, ground known": ("prefiltered", _of_known),
    },
    "glass": {"prefiltered, glass known": ("prefiltered", _of_known)},
    "lamp": {
        "prefiltered, its colour known": (
            "prefiltered",
            lambda sky: lamp_spectrum(_rgb(sky)),
        ),
        "prefiltered, spectrum known": (
            "prefiltered",
            lambda sky: lamp_spectrum(sky.lamp),
        ),
    },
}
