"""Lamps: the spectrum behind a name, a temperature, a file or a colour; lamps taken together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError, parameter
from ..spectra import illuminants
from ..spectra.chromaticity import uv
from ..spectra.grid import WAVELENGTHS, WEIGHTS
from ..spectra.light import read_light
from ..spectra.metamer import spectrum_with_colour
from ..spectra.reflectance import split_assignment
from ..spectra.sensitivities import cmfs, observer
from ..spectra.working_spaces import DEFAULT_SPACE
from .measures import delta_E

KELVIN = 800.0, 40000.0
"""Temperatures that a lamp can have."""

_FOUND = 0.1
"""CIEDE2000 up to which lamps count as of one spectrum, with nothing to say about it."""


def lamp_spectrum(lamp: str | float | ArrayLike, space: str = DEFAULT_SPACE) -> NDArray[np.float64]:
    """Return the spectrum of a lamp, (81,), of luminance 1; of a colour, with that very RGB.

    Parameters
    ----------
    lamp
        A CSV file, ``FILE.csv[:COLUMN]``; a name of colour-science's illuminants and light sources
        (``A``, ``FL11``, ``LED-B3``, ``HPS``; case does not matter); a black body's temperature
        [K], a number or as ``2700`` or ``2700K``; or RGB in ``space``, (3,). Of a colour the
        spectrum is that of the nearest black body or daylight, changed as little as makes the RGB
        right: white is D65. Negative RGB is cut off; a colour beyond the spectrum's own is paled.

    Raises
    ------
    InputError
        A name that is none of these, a temperature out of `KELVIN`, RGB that is not finite, black
        or not three numbers, a file that `spectra.light.read_light` refuses, or of many spectra
        without a column's name.
    """
    if isinstance(lamp, str):
        number = lamp.strip().removesuffix("K").removesuffix("k").strip()
        try:
            return lamp_spectrum(float(number), space)
        except ValueError:
            return _named(lamp)
    values = np.asarray(lamp, dtype=float)
    if values.ndim == 0:
        if not KELVIN[0] <= values <= KELVIN[1]:
            raise InputError(
                parameter("lamp"), f"{values:g} K", f"give {KELVIN[0]:g} to {KELVIN[1]:g}"
            )
        return _bright(black_body(float(values)))
    rgb = np.maximum(values, 0.0)
    if values.shape != (3,) or not np.isfinite(values).all() or not rgb.any():
        raise InputError(parameter("lamp"), f"{values.tolist()} is not a light", "give R, G and B")
    return _of_colour(rgb, observer(space))


def black_body(kelvin: float) -> NDArray[np.float64]:
    """Return Planck's spectrum at a temperature [K], (81,), relative; CODATA 2018's c2."""
    return WAVELENGTHS**-5.0 / np.expm1(1.438776877e7 / (WAVELENGTHS * kelvin)) * 1e14


@dataclass(frozen=True)
class Classes:
    """Lamps taken together: ``assignment`` (k,) to one of ``spectra`` (c, 81), of luminance 1.

    ``cost`` (k, 2): mean and largest CIEDE2000 that each lamp's light then has on the materials;
    ``line``: a sentence that says what is merged and what it costs, empty where nothing is.
    """

    assignment: NDArray[np.intp]
    spectra: NDArray[np.float64]
    cost: NDArray[np.float64]
    line: str


def classes(
    spectra: ArrayLike,
    strengths: ArrayLike,
    reflectances: ArrayLike,
    most: int = 2,
    names: Sequence[str] | None = None,
) -> Classes:
    """Take lamps together until there are at most so many spectra, with the least error.

    Parameters
    ----------
    spectra, strengths
        Of the lamps, (k, 81) of any size, and how much each counts, (k,), as its power times its
        luminance.
    reflectances
        Materials that are to look right, (m, 81).
    names
        Of the lamps, for the line.

    Those that are nearest go together first, and have the sum of their light for a spectrum: lamps
    of a class share not only the reflectances' colours but their own.
    """
    spectra = _bright(np.atleast_2d(np.asarray(spectra, dtype=float)))
    strengths = np.maximum(np.asarray(strengths, dtype=float), 1e-9)
    rho = np.vstack([np.atleast_2d(np.asarray(reflectances, dtype=float)), np.ones(81)])
    groups = [[k] for k in range(len(spectra))]

    def mixed(group: list[int]) -> NDArray[np.float64]:
        return _bright(strengths[group] @ spectra[group])

    known: dict[tuple[int, ...], float] = {}

    def price(group: list[int]) -> float:
        key = tuple(sorted(group))
        if key not in known:
            known[key] = float(strengths[group] @ _apart(mixed(group), spectra[group], rho)[:, 0])
        return known[key]

    def added(pair: tuple[int, int]) -> float:
        one, other = (groups[k] for k in pair)
        return price(one + other) - price(one) - price(other)

    while len(groups) > 1:
        i, j = best = min(combinations(range(len(groups)), 2), key=added)
        together = groups[i] + groups[j]
        if len(groups) <= most and added(best) > _FOUND * strengths[together].min():
            break
        groups[i] = together
        del groups[j]
    assignment = np.empty(len(spectra), np.intp)
    cost = np.zeros((len(spectra), 2))
    for k, group in enumerate(groups):
        assignment[group] = k
        cost[group] = _apart(mixed(group), spectra[group], rho)
    found = np.array([mixed(group) for group in groups]).reshape(-1, WAVELENGTHS.size)
    return Classes(assignment, found, cost, _line(groups, cost, names))


def _line(groups: list[list[int]], cost: NDArray, names: Sequence[str] | None) -> str:
    parts = []
    for group in groups:
        if cost[group, 0].max() > _FOUND:
            some = ", ".join(names[k] for k in group) if names else f"{len(group)} lamps"
            mean, worst = cost[group].max(axis=0)
            parts.append(
                f"{some} share one spectrum: ΔE {mean:.1f} in the mean, {worst:.1f} at worst"
            )
    return "; ".join(parts)


def _apart(one: NDArray, others: NDArray, rho: NDArray) -> NDArray[np.float64]:
    """Return mean and largest CIEDE2000 of materials under one light for others, (k, 2)."""
    S = observer()
    true = np.einsum("il,ml,kl->kmi", S, rho, others, optimize=True)
    off = delta_E((rho * one) @ S.T, true, (others @ S.T)[:, None])
    return np.stack([off.mean(axis=1), off.max(axis=1)], axis=1)


def _named(lamp: str) -> NDArray[np.float64]:
    path, column = split_assignment(lamp)
    if path.suffix.casefold() in (".csv", ".txt", ".tsv") or Path(lamp).exists():
        light = read_light(path)
        if column is None and len(light.names) == 1:
            return light.values[0]
        if column not in light.names:
            some = ", ".join(f"'{name}'" for name in light.names[:8])
            raise InputError(path, f"no column '{column or ''}'", f"name one of {some}")
        return light.values[light.names.index(column)]
    if (spectrum := illuminants.named(lamp)) is not None:
        return _bright(spectrum)
    raise InputError(
        parameter("lamp"),
        f"'{lamp}' is not a file, a temperature or a known lamp",
        "give a CSV, kelvin as 2700, or a name as A, D50, FL2, FL11, LED-B3, HP1",
    )


def _of_colour(rgb: NDArray, S: NDArray) -> NDArray[np.float64]:
    to_XYZ = (cmfs() * WEIGHTS) @ np.linalg.pinv(S)
    candidates = _whites()
    colours = uv(candidates @ (cmfs() * WEIGHTS).T)
    for pale in (0.0, 0.01, 0.03, 0.1, 0.3):
        wanted = (1.0 - pale) * rgb + pale * rgb.mean()
        nearest = np.argmin(np.sum((colours - uv(to_XYZ @ wanted)) ** 2, axis=1))
        if (found := spectrum_with_colour(candidates[nearest], wanted, S)) is not None:
            return found
    raise InputError(
        parameter("lamp"),
        f"{rgb.tolist()} is not a color of light",
        "choose a less saturated color",
    )


@cache
def _whites() -> NDArray[np.float64]:
    """Black bodies from 1000 to 10,000 K and CIE daylights from 4000 to 25,000 K, (k, 81)."""
    bodies = [black_body(1e6 / mired) for mired in np.linspace(100.0, 1000.0, 181)]
    days = illuminants.daylight([6504.0, *(1e6 / np.linspace(40.0, 250.0, 106))])
    return _bright(np.concatenate([bodies, days]))


def _bright(spectra: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return spectra (..., 81) of luminance 1, as `read_light` gives them."""
    return spectra / (spectra @ (cmfs()[1] * WEIGHTS))[..., None]
