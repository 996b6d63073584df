"""The light of a clear sky for single heights of the sun, and how few of them stand for all.

What a sky is, but for its turn, depends on the sun's elevation alone. All that the file will hold
is in units of the sky's own light on level ground, `Moment.level`, which changes by a factor of
hundreds in twilight; the rest changes slowly. Numbers follow `curves` through all moments that were
computed; pictures of the sky, which take more room, are kept of few and mixed two by two.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, fields
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....node_groups import day_sky
from ...progress import Progress, mapped
from ...sky.clear_sky import SCALE, Sky
from ...sky.light import FACES
from ...sky.polynomial import evaluate_polynomial
from ...spectra.colorchecker import colorchecker
from ...spectra.sensitivities import observer
from ...spectra.working_spaces import LUMINANCE, rec709_to_working
from ...transfer.measures import delta_E
from ...transfer.prefilter import balanced_rgb
from ..plan import Plan
from . import tiles
from .curves import SEAM, between, neighbours, slopes

WITHIN = 0.3
"""CIEDE2000 between moments, against the sky computed for that height of the sun."""

MARKS = 0.0, SEAM, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0
"""[degrees] of moments that are always computed, if the sun comes so high or low: the lower it
stands, the faster all changes. That they are the same for all days, simulated skies are reused."""

MOST = 96
"""Moments."""

LEAST = 0.05
"""[degrees] between two moments."""


@dataclass(frozen=True, eq=False)
class Look:
    """What shows of a moment, in units of its level: what is mixed between two of them.

    The irradiance / pi of sky and ground on `FACES` (9, 3), and of the sun on a face towards it
    (3,); what surfaces (m) make of the sky's (m, 3, 3) and of the others (m, 3); ``tile`` as
    `tiles.directions` has it, in linear Rec.709. None where that light is not there.
    """

    sky: NDArray[np.float64]
    matrices: NDArray[np.float64]
    tile: NDArray[np.float32] | None
    ground: NDArray[np.float64] | None
    of_ground: NDArray[np.float64] | None
    sun: NDArray[np.float64] | None
    of_sun: NDArray[np.float64] | None


@dataclass(frozen=True, eq=False)
class Moment:
    """The light of one elevation [degrees] of the sun.

    ``level``: the luminance of a white, level face under the sky alone; ``disc`` and ``below``
    (3,): the working-space RGB radiance of the sun's disc and of the ground, over the level;
    ``brightest``: the sky's largest number; ``even`` (3,): by what the sun's RGB is divided, and
    what surfaces make of it multiplied, so that the sun is gray: a low sun's blue passes through 0.
    Ones without a sun.
    """

    elevation: float
    level: float
    look: Look
    plan: Plan
    disc: NDArray[np.float64]
    below: NDArray[np.float64]
    brightest: float
    even: NDArray[np.float64]

    @classmethod
    def of(cls, elevation: float, sky: Sky, plan: Plan) -> Moment:
        """Bring a simulated sky and what was planned under it together."""
        lights, transfer = plan.lights, plan.lights.transfer
        seen = sky.seen_by(observer() * SCALE)
        rows, columns = tiles.directions(elevation)
        level = float(LUMINANCE @ seen.irradiance()) / np.pi
        to_working = rec709_to_working(transfer.space)
        sine = max(np.sin(np.radians(elevation)), 0.0)
        whole = (sky.irradiance() + sky.direct * sine) * sky.ground / np.pi
        below = to_working @ (observer() * SCALE @ whole)
        disc = np.zeros(3)
        if elevation > 0.0:
            disc = to_working @ (observer() * SCALE @ sky.direct) / day_sky.SOLID_ANGLE
        rho = np.concatenate([colorchecker()[1], *[[one.given.values] for one in plan.materials]])
        made = lights.reflected(rho)
        ground = sun = None
        even = np.ones(3)
        if lights.ground is not None:
            ground = evaluate_polynomial(lights.ground.coefficients, FACES) / level
        if lights.sun is not None:
            rgb = balanced_rgb(lights.sun.spectrum, transfer)
            even = rgb / rgb.mean()
            sun = rgb / even / level
            made["Sun"] = made["Sun"] * even
        look = Look(
            evaluate_polynomial(lights.coefficients, FACES) / level,
            transfer.matrices(rho),
            seen.radiance(rows[:, None], columns).astype(np.float32) / np.float32(level),
            ground,
            made.get("Ground"),
            sun,
            made.get("Sun"),
        )
        brightest = float(lights.light.sky.max())
        return cls(elevation, level, look, plan, disc / level, below / level, brightest, even)

    @property
    def colours(self) -> NDArray[np.float64]:
        """What surfaces show on `FACES`, (9, m, 3), over the level."""
        return colours(self.look, self.elevation)

    @property
    def white(self) -> NDArray[np.float64]:
        """What a perfect diffuser shows on `FACES`, (9, 1, 3), over the level."""
        look = self.look
        white = look.sky @ self.plan.lights.transfer.to_working.T
        if look.ground is not None:
            white = white + look.ground
        if look.sun is not None:
            white = white + _cosines(self.elevation) * look.sun
        return white[:, None]


def colours(look: Look, elevation: float) -> NDArray[np.float64]:
    """Return what surfaces show of a light on `FACES`, (9, m, 3), the sun at an elevation [degrees]
    over +x."""
    shown = np.einsum("mij,fj->fmi", look.matrices, look.sky)
    if look.ground is not None and look.of_ground is not None:
        shown = shown + look.ground[:, None] * look.of_ground
    if look.sun is not None and look.of_sun is not None:
        shown = shown + (_cosines(elevation) * look.sun)[:, None] * look.of_sun
    return shown


def _cosines(elevation: float) -> NDArray[np.float64]:
    height = np.radians(elevation)
    towards = np.array([np.cos(height), 0.0, np.sin(height)])
    return np.maximum(FACES @ towards, 0.0)[:, None]


def look_between(looks: dict[float, Look], elevation: float) -> Look:
    """Return the look of an elevation [degrees] by those around it: without a picture of the sky.

    Of light that is missing around it there is none; what materials make of it is as nearby.
    """
    heights = np.array(sorted(looks))
    heights = heights[neighbours(heights, elevation)]
    found: dict[str, NDArray | None] = {"tile": None}
    for name in [field.name for field in fields(Look) if field.name != "tile"]:
        numbers = {h: getattr(looks[h], name) for h in heights.tolist()}
        there = [h for h in numbers if numbers[h] is not None]
        if not there:
            found[name] = None
            continue
        for h in [h for h in numbers if numbers[h] is None]:
            nearest = numbers[min(there, key=lambda other: abs(other - h))]
            numbers[h] = nearest if name.startswith("of_") else np.zeros_like(nearest)
        found[name] = between(heights, np.array(list(numbers.values())), elevation)
    return Look(**found)  # type: ignore[arg-type]


def levels_of(moments: dict[float, float]) -> tuple[NDArray, NDArray, NDArray]:
    """Return elevations, levels and how these rise, of levels by elevation."""
    x = np.array(sorted(moments))
    level = np.array([moments[e] for e in x.tolist()])
    return x, level, slopes(x, np.log(level)) * level


@dataclass(frozen=True)
class KeySkies:
    """The moments that all others follow from, by rising elevation, and what that leaves.

    ``keys``: those whose pictures are kept; ``places`` (n,): of each moment among these, whole at a
    key and between two by the share of the upper one that fits best; ``error``: the largest
    CIEDE2000 of any surface on any face, and ``sky_error``: of the sky itself, in the mean over the
    dome: at each moment by those around it.
    """

    moments: list[Moment]
    keys: list[Moment]
    places: NDArray[np.float64]
    error: float
    sky_error: float

    @property
    def levels(self) -> list[tuple[float, float]]:
        """Elevation and level of all moments."""
        return [(moment.elevation, moment.level) for moment in self.moments]


def find(
    low: float,
    high: float,
    at: Callable[[float], Generator[Progress, None, Moment]],
    within: float = WITHIN,
) -> Generator[Progress, None, KeySkies]:
    """Find the moments, by halving, that stand for all from a lowest elevation to a highest.

    ``at`` computes one of an elevation [degrees]. An interval is halved until the moment in its
    middle follows from all others.
    """
    known: dict[float, Moment] = {}
    marks = sorted({low, high, *(e for e in MARKS if low < e < high)})
    parts = [(a, b) for a, b in pairwise(marks) if b - a > 1.01 * SEAM]
    errors = [0.0]

    def compute(elevations: list[float], done: float) -> Generator[Progress, None, None]:
        for k, elevation in enumerate(elevations):
            share = done + (0.9 - done) * 0.5 * k / len(elevations)
            step = Progress(share, f"sun at {elevation:.1f}°, {len(known)} moments")
            known[elevation] = yield from mapped(at(elevation), partial(_instead, step))

    yield from compute(marks, 0.0)
    while parts:
        done = 0.9 * (1.0 - sum(b - a for a, b in parts) / max(high - low, 1e-9))
        yield from compute([0.5 * (a + b) for a, b in parts], max(done, 0.3))
        halved = []
        for first, last in parts:
            middle = 0.5 * (first + last)
            error = _surface_error(known, middle)
            sky = _fitting(known[first], known[last], known[middle])[1]
            if max(error, sky) > within and last - first > 2.0 * LEAST and len(known) < MOST:
                halved += [(first, middle), (middle, last)]
            else:
                errors.append(error)
        parts = halved
    moments = [known[e] for e in sorted(known)]
    kept, places, sky_error = _thinned(moments, within)
    return KeySkies(moments, [moments[k] for k in kept], places, max(errors), sky_error)


def _instead(step: Progress, _: Progress) -> Progress:
    return step


def _surface_error(known: dict[float, Moment], elevation: float) -> float:
    """CIEDE2000 at most of what surfaces show at a known moment, by the others around it."""
    true = known[elevation]
    others = {e: moment for e, moment in known.items() if e != elevation}
    look = look_between({e: moment.look for e, moment in others.items()}, elevation)
    x, level, rise = levels_of({e: moment.level for e, moment in others.items()})
    factor = float(between(x, level, elevation, rise)) / true.level
    shown = factor * colours(look, elevation)
    space = true.plan.lights.transfer.space
    return float(delta_E(shown, true.colours, true.white, space).max())


def _fitting(one: Moment, other: Moment, true: Moment) -> tuple[float, float]:
    """By which share of the other's picture a moment's follows best from two, and the CIEDE2000
    that is left of the sky in the mean."""
    a, b, c = (np.asarray(each.look.tile, float)[::2, ::2] for each in (one, other, true))
    rows, _ = tiles.directions(true.elevation)
    area = (np.cos(rows) * np.gradient(rows))[::2]
    weight = (area[:, None] / np.maximum(c @ LUMINANCE, 1e-9) ** 2)[..., None]
    share = (weight * (c - a) * (b - a)).sum() / max((weight * (b - a) ** 2).sum(), 1e-300)
    share = min(max(float(share), 0.0), 1.0)
    white = np.ones(3) * float(LUMINANCE @ true.white[0, 0])
    apart = delta_E(a + share * (b - a), c, white).mean(axis=1)
    return share, float(area @ apart / area.sum())


def _thinned(moments: list[Moment], within: float) -> tuple[list[int], NDArray[np.float64], float]:
    """Find the fewest moments from whose pictures all others' follow: which, the places of all
    among them, and the largest error of the sky."""
    kept, places, worst = [0], np.zeros(len(moments)), 0.0
    while kept[-1] < len(moments) - 1:
        first = kept[-1]
        last, inside = first + 1, {}
        while last + 1 < len(moments):
            found = {
                k: _fitting(moments[first], moments[last + 1], moments[k])
                for k in range(first + 1, last + 1)
            }
            if max(error for _, error in found.values()) > within:
                break
            last, inside = last + 1, found
        for k, (share, error) in inside.items():
            places[k] = len(kept) - 1 + share
            worst = max(worst, error)
        places[last] = len(kept)
        kept.append(last)
    return kept, places, worst
