"""The light of a clear sky for single heights of the sun, and how few of them stand for all.

What a sky is, but for its turn, depends on the sun's elevation alone. All that the file will hold
is in units of the sky's own light on level ground, `Moment.level`, which changes by a factor of
hundreds in twilight; the rest changes slowly, and is mixed in straight lines between two moments.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, fields
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

EDGE = 0.27
"""[degrees]. The sun's disc is wholly under the horizon at less than -this, wholly over it at more;
between the two its light grows evenly."""

WITHIN = 0.3
"""CIEDE2000 between two key skies, against the sky computed for that height of the sun."""

MOST = 48
"""Key skies."""

LEAST = 0.05
"""[degrees] between two key skies."""


@dataclass(frozen=True, eq=False)
class Look:
    """What shows of a moment, in units of its level: what is mixed between two of them.

    The irradiance / pi of sky and ground on `FACES` (9, 3), and of the sun on a face towards it
    (3,); what surfaces (m) make of the sky's (m, 3, 3) and of the others (m, 3); ``tile`` as
    `tiles.directions` has it, in linear Rec.709. None where that light is not there.
    """

    sky: NDArray[np.float64]
    matrices: NDArray[np.float64]
    tile: NDArray[np.float32]
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


def mixed(one: Look, other: Look, share: float) -> Look:
    """Return the look between two: what is in only one of them fades, and keeps what it does."""

    def between(name: str) -> NDArray | None:
        a, b = getattr(one, name), getattr(other, name)
        if a is None and b is None:
            return None
        if a is None or b is None:
            there, part = (a, 1.0 - share) if b is None else (b, share)
            return there if name.startswith("of_") else part * there
        return (1.0 - share) * a + share * b

    return Look(**{field.name: between(field.name) for field in fields(Look)})


@dataclass(frozen=True)
class KeySkies:
    """The moments between which all others are mixed, by rising elevation, and what that leaves.

    ``levels``: (elevation, level) of all moments that were computed; ``error``: the largest
    CIEDE2000 of any surface on any face, and ``sky_error``: of the sky itself, in the mean over the
    dome, as far as was looked: halfway between two keys.
    """

    keys: list[Moment]
    levels: list[tuple[float, float]]
    error: float
    sky_error: float


def find(
    low: float,
    high: float,
    at: Callable[[float], Generator[Progress, None, Moment]],
    within: float = WITHIN,
) -> Generator[Progress, None, KeySkies]:
    """Find the fewest moments, by halving, that stand for all from a lowest elevation to a highest.

    ``at`` computes one of an elevation [degrees].
    """
    known: dict[float, Moment] = {}
    marks = sorted({low, high, *(e for e in (-EDGE, EDGE) if low < e < high)})
    parts = [pair for pair in pairwise(marks) if pair != (-EDGE, EDGE)]
    keys, errors, sky_errors = set(marks), [0.0], [0.0]

    def computed(elevation: float, done: float) -> Generator[Progress, None, Moment]:
        if elevation not in known:
            step = Progress(done, f"sun at {elevation:.1f}°, {len(keys)} key skies")
            known[elevation] = yield from mapped(at(elevation), lambda _: step)
        return known[elevation]

    for mark in marks:
        yield from computed(mark, 0.0)
    while parts:
        first, last = parts.pop(0)
        middle = 0.5 * (first + last)
        left = sum(b - a for a, b in [(first, last), *parts])
        done = 0.9 * max(1.0 - left / max(high - low, 1e-9), 0.0)
        true = yield from computed(middle, done)
        level = _between_levels(known, middle)
        look = mixed(known[first].look, known[last].look, 0.5)
        surface, sky = _errors(look, level / true.level, true)
        too_far = max(surface, sky) > within and last - first > 2.0 * LEAST and len(keys) < MOST
        if too_far:
            keys.add(middle)
            parts += [(first, middle), (middle, last)]
        else:
            errors.append(surface)
            sky_errors.append(sky)
    levels = [(e, known[e].level) for e in sorted(known)]
    return KeySkies([known[e] for e in sorted(keys)], levels, max(errors), max(sky_errors))


def _errors(look: Look, factor: float, true: Moment) -> tuple[float, float]:
    """CIEDE2000 of a mixed look, so many times the true moment's level: of surfaces at most, and of
    the sky in the mean."""
    space = true.plan.lights.transfer.space
    surface = delta_E(factor * colours(look, true.elevation), true.colours, true.white, space)
    white = np.ones(3) * float(LUMINANCE @ true.white[0, 0])
    sky = delta_E(factor * look.tile, true.look.tile, white)
    rows, _ = tiles.directions(true.elevation)
    weights = np.cos(rows) * np.gradient(rows)
    return float(surface.max()), float(weights @ sky.mean(axis=1) / weights.sum())


def _between_levels(known: dict[float, Moment], at: float) -> float:
    """The level at an elevation by those around it, its own aside."""
    from ...sky.sun_course import hermite

    x = np.array(sorted(e for e in known if e != at))
    y = np.log([known[e].level for e in x.tolist()])
    slope = slopes(x, y)
    k = int(np.searchsorted(x, at)) - 1
    width = x[k + 1] - x[k]
    s = np.array((at - x[k]) / width)
    found = hermite(s, y[k], y[k + 1], slope[k] * width, slope[k + 1] * width)
    return float(np.exp(found))


def slopes(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the slopes (n,) of a smooth curve at its samples: of parabolas through three."""
    return np.gradient(y, x, edge_order=2 if len(x) > 2 else 1)
