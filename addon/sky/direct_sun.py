"""The sun's own light: its spectrum through the air, and its energy where a picture clipped it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, parameter
from ..spectra.bases import rayleigh, restoration
from ..spectra.chromaticity import uv
from ..spectra.grid import WEIGHTS
from ..spectra.metamer import spectrum_with_colour
from ..spectra.sensitivities import cmfs, observer
from ..spectra.sunlight import extraterrestrial_sunlight
from .atmosphere import Atmosphere
from .least_squares import least_squares
from .light import SkyLight
from .scattering import sun_transmittance
from .sun import Sun

FOREIGN = 0.015
"""Distance in u'v' over which a sun's colour is none that sunlight has at its elevation: twice what
photographed suns that are not clipped leave (see the tests)."""

_HAZE, _OZONE, _ANGSTROM = (0.1, 0.7), (320.0, 60.0), (1.2, 0.45)
"""What the air holds when nothing is known, mean and standard deviation, haze log-normal, as
`daylight_ensemble.draw_atmosphere` has it."""

_COLOUR, _SKY_COLOUR = 0.002, 0.01
"""Standard deviations in u'v' of a sun's colour in an HDRI, and of a sky's: clouds whiten it."""

_EQUAL, _WEAK = 0.95, 3.0
"""A sun whose channels are so equal is white by clipping where the sky lets it be so many times
stronger at least. A veiled sun keeps its colour, however weak."""


@dataclass(frozen=True)
class SunLight:
    """The light of the sun, as strong as it really was, in the HDRI's units.

    ``spectrum`` (81,): irradiance / pi of a face that looks at the sun, so that
    ``S_in @ spectrum`` is ``rgb`` (3,) (before the HDRI was balanced, where it was); ``clipped``:
    whether the energy is an estimate; ``line``: a sentence that says what was found or guessed.
    """

    spectrum: NDArray[np.float64]
    rgb: NDArray[np.float64]
    clipped: bool
    line: str


def direct_sunlight(
    elevation: float, rgb: ArrayLike | None = None, S_in: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return the spectrum of the sun's disc as seen through the air, (81,) [W m^-2 nm^-1].

    Extraterrestrial sunlight times the transmittance of `scattering.sun_transmittance`.

    Parameters
    ----------
    elevation
        [degrees] of the sun over the horizon, up to 90. Under the horizon, where refraction still
        shows it, as on the horizon.
    rgb
        The sun's colour as ``S_in`` (3, 81) sees it, (3,); its size does not count. Haze, its
        Ångström exponent and ozone are then those that are likeliest to make it. A colour that no
        sunlight of this elevation has gives the nearest likely one. Without it: air as it mostly
        is.

    Raises
    ------
    InputError
        An elevation that is none.
    """
    return _sunlight(elevation, _air_of_sun(elevation, rgb, S_in))


def restored_sun(
    sun: Sun,
    light: SkyLight,
    S_in: NDArray[np.float64] | None = None,
    white: ArrayLike | None = None,
    clipped: bool | None = None,
) -> SunLight:
    """Return the spectrum and energy that a sun really had.

    A sun whose spectrum is known has that. One that was not clipped keeps its RGB, and the spectrum
    has exactly that colour. A clipped one keeps its direction alone: the sky's colour tells the
    haze, and haze and elevation tell the sun's colour and how much stronger than the clear sky's
    its light is.

    Parameters
    ----------
    sun, light
        What `light.analyse` found; ``light.faces[0]`` is the sky's light on level ground.
    S_in
        What made the HDRI's numbers, (3, 81); the standard observer in Linear Rec.709 where None.
    white
        RGB of neutral light before the HDRI was balanced, (3,); None where it was not.
    clipped
        Whether the HDRI clipped the sun, where someone knows. Else where `Sun.clipped` says so,
        and where a sun is white and much weaker than its sky asks for: that is what clipping makes
        of a sun within a pixel or two.
    """
    S_in = observer() if S_in is None else S_in
    balance = np.ones(3) if white is None else np.asarray(white, dtype=float)
    if light.spectrum is not None and light.spectrum.sun is not None:
        own = light.spectrum.sun
        line = f"the sun at {sun.elevation:.0f}° has its own spectrum"
        return SunLight(own, S_in @ own / balance, False, line)
    seen = sun.irradiance * balance
    haze, times = _expected(sun.elevation, seen, light.faces[0] * balance, S_in)
    if clipped is None:
        equal = sun.irradiance.min() > _EQUAL * sun.irradiance.max()
        clipped = sun.clipped or bool(equal and times[0] > _WEAK)
    if clipped:
        spectrum = _sunlight(sun.elevation, Atmosphere(haze=haze, ozone=_OZONE[0]))
        spectrum *= times[1] * _luminance(seen, S_in) / _luminance(S_in @ spectrum, S_in)
        line = (
            f"the HDRI clips the sun at {sun.elevation:.0f}°: estimated at {times[1]:.3g} times "
            f"its value (likely {times[0]:.3g} to {times[2]:.3g}), from clear air with the haze "
            f"of this sky's color ({haze:.2f})"
        )
        return SunLight(spectrum, S_in @ spectrum / balance, True, line)
    spectrum = direct_sunlight(sun.elevation, seen, S_in)
    away = float(np.linalg.norm(_uv(S_in @ spectrum, S_in) - _uv(seen, S_in)))
    exact = spectrum_with_colour(spectrum, seen, S_in)
    if exact is None:
        exact = spectrum * (_luminance(seen, S_in) / _luminance(S_in @ spectrum, S_in))
    line = f"the sun at {sun.elevation:.0f}° is as strong as the HDRI shows it"
    if not away <= FOREIGN:
        line += f", but its color is not one of sunlight (off by {away:.3f} in u'v')"
    return SunLight(exact, S_in @ exact / balance, False, line)


def _expected(
    elevation: float, seen: NDArray, sky: NDArray, S_in: NDArray
) -> tuple[float, tuple[float, float, float]]:
    """Return the likely haze, and how many times stronger than seen a clear sky's sun is.

    Three quantiles, 10, 50 and 90 %, of what this sky's colour leaves likely; never under 1.
    """
    haze = np.geomspace(0.01, _HAZES[-1], 89)
    clear = np.stack([_clear_sky(elevation, each) for each in haze])
    likely = np.exp(-0.5 * (np.log(haze / _HAZE[0]) / _HAZE[1]) ** 2)
    colour = _uv(sky, S_in)
    if np.isfinite(colour).all():
        likely *= np.exp(-0.5 * (((uv(clear) - colour) / _SKY_COLOUR) ** 2).sum(axis=1))
    direct = np.stack([_sunlight(elevation, Atmosphere(haze=float(each))) for each in haze])
    strength = direct @ (cmfs()[1] * WEIGHTS) / clear[:, 1] * _luminance(sky, S_in)
    times = strength / _luminance(seen, S_in)
    # What is seen has at least come through.
    if (likely * (times >= 1.0)).any():
        likely *= times >= 1.0
    share = np.cumsum(likely) / likely.sum()
    middle = float(np.interp(0.5, share, haze))
    most, median, least = np.maximum(np.interp([0.1, 0.5, 0.9], share, times), 1.0)
    return middle, (float(least), float(median), float(most))


def _sunlight(elevation: float, air: Atmosphere) -> NDArray[np.float64]:
    if not -90.0 <= elevation <= 90.0:
        raise InputError(parameter("sun_elevation"), f"{elevation:g}°", "give -90 to 90 degrees")
    return sun_transmittance(max(elevation, 0.0), air) * extraterrestrial_sunlight()


def _air_of_sun(elevation: float, rgb: ArrayLike | None, S_in: NDArray | None) -> Atmosphere:
    """Return the likeliest air (maximum a posteriori) for a sun of this colour."""
    S_in = observer() if S_in is None else S_in
    target = None if rgb is None else _uv(np.asarray(rgb, dtype=float), S_in)
    middle = np.array([np.log(_HAZE[0]), _OZONE[0], _ANGSTROM[0]])
    if target is None or not np.isfinite(target).all():
        return Atmosphere(haze=_HAZE[0], ozone=_OZONE[0], angstrom=_ANGSTROM[0])
    spread = np.array([_HAZE[1], _OZONE[1], _ANGSTROM[1]])

    def air(away: NDArray) -> Atmosphere:
        haze, ozone, angstrom = middle + away * spread
        return Atmosphere(
            haze=float(np.exp(haze)), ozone=float(max(ozone, 0.0)), angstrom=float(angstrom)
        )

    def unlikely(away: NDArray) -> NDArray:
        missed = _uv(S_in @ _sunlight(elevation, air(away)), S_in) - target
        return np.concatenate([missed / _COLOUR, away])

    # Haze 0.003 to 0.8, ozone to 640 Dobson units, no exponent that would make the sun bluer.
    low, high = np.array([[-5.0, -5.3, -2.6], [3.0, 5.3, 2.6]])
    return air(least_squares(unlikely, np.zeros(3), low, high))


def _clear_sky(elevation: float, haze: float) -> NDArray[np.float64]:
    """Return XYZ (3,) of a clear sky's irradiance on level ground, as `cmfs` and W m^-2 make it."""
    at_haze = np.log(np.array(_HAZES) + _SOFT[0])
    at_elevation = np.log(np.array(_ELEVATIONS) + _SOFT[1])
    table = np.log(_SKIES)
    haze, elevation = np.log(haze + _SOFT[0]), np.log(np.clip(elevation, 0.0, 90.0) + _SOFT[1])
    rows = [[np.interp(haze, at_haze, row[:, c]) for row in table] for c in range(3)]
    whole = float(cmfs()[1] * WEIGHTS @ extraterrestrial_sunlight())
    return whole / 1000.0 * np.exp([np.interp(elevation, at_elevation, row) for row in rows])


def _luminance(rgb: NDArray, S_in: NDArray) -> float:
    """Return Y of what S_in sees; colours that a camera never sees may have less than none."""
    return max(float(_XYZ(rgb, S_in)[1]), 1e-9 * float(np.sum(rgb)))


def _uv(rgb: NDArray, S_in: NDArray) -> NDArray[np.float64]:
    """Return u'v' (2,) of what S_in sees, NaN for colours that have none."""
    XYZ = _XYZ(rgb, S_in)
    return uv(XYZ) if XYZ @ [1.0, 15.0, 3.0] > 0 else np.full(2, np.nan)


def _XYZ(rgb: NDArray, S_in: NDArray) -> NDArray[np.float64]:
    """Return XYZ (3,) of what S_in sees, a camera's numbers as the paper's basis develops them."""
    return (cmfs() * WEIGHTS) @ (restoration(rayleigh(), S_in) @ rgb)


_SOFT = 0.02, 2.0
"""Added to haze and elevation [degrees] before their logarithms are taken."""
_ELEVATIONS = (0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 90.0)
_HAZES = (0.0, 0.03, 0.1, 0.2, 0.4, 0.8)
_TABLE = """
6.89/7.35/10.4 6.82/7.21/10.3 6.4/6.77/9.83 5.95/6.3/9.38 5.38/5.7/8.62 4.61/4.89/7.55
13.3/14.5/22.1 14.5/15.6/22 15.1/16/21.4 14.3/15/20.2 13.1/13.7/18.5 11.3/11.9/16.2
21.7/23.5/40.6 25.8/27.7/42.3 31/33/43.7 32.5/34.2/42.1 31.5/32.8/39 27.3/28.3/33.7
30.9/32.7/63 39.3/41.7/69.7 53.8/57.1/79.8 64.3/67.9/84.1 71.8/75.2/83.8 66.2/68.6/72.6
40.4/41.8/87.2 54.7/57.1/102 82.9/87.1/130 112/118/156 148/155/181 163/170/176
49.6/50.6/110 69.2/71.4/133 111/115/181 162/169/237 239/251/314 321/336/374
57.4/58.4/129 79.8/82/156 129/134/216 193/201/292 301/315/414 455/476/570
"""
_SKIES: NDArray[np.float64] = np.array(
    [[cell.split("/") for cell in row.split()] for row in _TABLE.split("\n")[1:-1]], float
)
"""XYZ of clear skies' irradiance on level ground by elevation (rows) and haze, in thousandths of
the sun's Y outside the air: means of `simulation.simulate`, all orders, else its default air."""
