"""Bases: three functions of wavelength whose mixtures are the skylight that is expected."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import BASES, listed
from ..errors import InputError, parameter
from .ensemble import shipped
from .grid import WAVELENGTHS
from .illuminants import daylight_components
from .light import read_light
from .sensitivities import observer
from .sunlight import extraterrestrial_sunlight

MEASURED = "'measured FILE.csv'"
"""How the basis of a file of spectra is chosen beside `choices.BASES`."""

REFERENCE_WAVELENGTH = 550.0
"""lambda0 [nm]. It scales the basis functions to one size; the matrices do not depend on it."""


def rayleigh() -> NDArray[np.float64]:
    """Return sunlight scattered by air never, once and twice, (3, 81).

    ``s_i = s (lambda0 / lambda)^(4 i)``, i = 0, 1, 2 [W m^-2 nm^-1]: T. Tachi, "Full-Spectral
    Image-Based Lighting with Skylight".
    """
    scattering = (REFERENCE_WAVELENGTH / WAVELENGTHS) ** 4
    return extraterrestrial_sunlight() * scattering ** np.arange(3)[:, None]


def daylight() -> NDArray[np.float64]:
    """Return the CIE daylight functions S0, S1, S2, (3, 81), relative.

    Judd, MacAdam and Wyszecki 1964 (DOI 10.1364/JOSA.54.001031), from colour-science.
    """
    return daylight_components()


def measured(path: str | Path) -> NDArray[np.float64]:
    """Return the three principal components of the spectra in a CSV file, (3, 81), relative.

    Each spectrum counts alike, whatever its size; no mean is taken off, so that the basis holds
    their mean too. S. Tominaga's way with skies. It fits its own site: elsewhere check it with the
    command `evaluate`. Raises `InputError` as `read_light` does, and for fewer than three
    spectra that differ.
    """
    spectra = read_light(path).values
    _, sizes, components = np.linalg.svd(spectra, full_matrices=False)
    # Copies of one spectrum leave rounding alone for the further components.
    if sizes.size < 3 or sizes[2] < 1e-6 * sizes[0]:
        raise InputError(
            path, "holds fewer than three spectra that differ", "give spectra of various skies"
        )
    return components[:3]


def atmosphere(
    S_in: NDArray[np.float64] | None = None,
    *,
    sun_elevation: float | None = None,
    sky_rgb: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return the basis that fits our simulated skies best, (3, 81), for this sun and this colour.

    The Wiener estimate of `spectra.ensemble`. ``sun_elevation`` [degrees] and the colours
    ``sky_rgb`` (3,) or (k, 3) say which skies are to be expected; without the elevation they are
    skies by day. By day the basis leans towards `rayleigh`, where haze, cloud and ozone are a
    guess. ``S_in`` (3, 81) is what made the HDRI's numbers and those of ``sky_rgb``, the standard
    observer in Linear Rec.709 where None; unlike the other bases this one depends on it.
    Raises `InputError` for an elevation that is none.
    """
    if S_in is None:
        S_in = observer()
    if sun_elevation is not None and not -90.0 <= sun_elevation <= 90.0:
        raise InputError(
            parameter("sun_elevation"), f"{sun_elevation:g}°", "give -90 to 90 degrees"
        )
    paper = restoration(rayleigh(), S_in)
    expected = shipped().restoration(S_in, sun_elevation, sky_rgb)
    if sun_elevation is None:
        coloured = sky_rgb is not None and np.any(np.asarray(sky_rgb) > 0)
        lean = _LEAN_BY_COLOUR if coloured else _LEAN
    else:
        start, softness = _DAY
        lean = _LEAN / (1.0 + np.exp((start - sun_elevation) / softness))
    return (expected + lean * (paper - expected)).T


def restoration(B: NDArray[np.float64], S_in: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``B^T A^-1`` (n, 3) for a basis B (3, n) and sensitivities S_in (3, n)."""
    # Rows of one size: the result depends on the span of B alone, its rounding on the sizes. (Of
    # lengths, the squares of tiny rows would be lost.)
    B = B / np.abs(B).max(axis=1, keepdims=True)
    A = S_in @ B.T
    return np.linalg.solve(A.T, B).T


def fitted(
    B: NDArray[np.float64],
    S_in: NDArray[np.float64],
    members: NDArray[np.float64],
    share: float,
) -> NDArray[np.float64]:
    """Return the basis (3, 81) that fits light which is known, and else an expected one B (3, 81).

    ``members`` (m, 81): the spectra that there are, each times the root of how much it counts. By
    least squares over these its matrices are the best 3x3 of every reflectance at once, for the
    error of each row of a matrix is linear in the reflectance. Where members tell less than three
    numbers of a spectrum can, as those of an even sky do, the expected basis tells the rest: it
    counts as much as this ``share`` of them, one of `SHARES`.
    """
    expected = restoration(B, S_in)
    seen = members @ S_in.T
    little = share * np.sum(seen**2) / 3.0
    moment = seen.T @ seen + little * np.eye(3)
    return np.linalg.solve(moment, seen.T @ members + little * expected.T)


SHARES = 1e-5, 1e-4, 1e-3, 1e-2
"""How much an expected basis counts beside known light: the first as an error of a third of a per
cent, the others where that leaves matrices that no light needs."""

_LEAN, _LEAN_BY_COLOUR = 0.5, 0.3
"""How much of the paper's basis is in `atmosphere` by day, and where the colour alone is known,
which has already told much: enough that no set of skies that we have, those without ozone among
them, is much worse off than with the paper's (see the tests)."""

_DAY = 9.0, 1.0
"""Elevation [degrees] over which it is day, and how softly that begins: under it ozone makes the
paper's basis wrong, over it little."""


def basis(
    name: str,
    S_in: NDArray[np.float64],
    *,
    sun_elevation: float | None = None,
    sky_rgb: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return a basis (3, 81) by its name: one of `choices.BASES`, or ``measured FILE.csv``.

    The further arguments are those of `atmosphere`, the only one that they change. Raises
    `InputError` for any other name, and as `measured` and `atmosphere` do.
    """
    if name == "atmosphere":
        return atmosphere(S_in, sun_elevation=sun_elevation, sky_rgb=sky_rgb)
    if name in BASES:
        return globals()[name]()  # each is a function of this module, see `choices`
    if found := re.fullmatch(r"measured[ :=]\s*(.+)", name):
        return measured(found[1])
    raise InputError(
        parameter("basis"), f"'{name}' is not a basis", f"choose {listed([*BASES, MEASURED])}"
    )
