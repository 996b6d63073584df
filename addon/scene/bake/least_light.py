"""The least light that keeps a whole picture to a tolerance, by what is predicted of it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from ...choices import BAKED, OPEN
from ...transport.probed import FINEST
from .sounding import Sounding

MOST = 4096
"""Rays from a point: no bake has more."""

LEAST = 0.5
"""Of the tolerance, is left for light where matrices alone need more."""

AT_MOST = {OPEN: 1.1, BAKED: 1.25}
"""By which factor light is off at most in 19 of 20 random scenes, of what is predicted, …"""

FURTHER = 2.0
"""… from more rays than all points cast, of which the prediction knows how noise falls alone, …"""

PATCHES = 2.0
"""… and between few patches, which are fewer in the prediction."""


@dataclass(frozen=True)
class LeastLight:
    """Which ``light`` is enough, `OPEN` or `BAKED`, and from how many ``rays`` a point.

    ``expected`` and, in 19 of 20 scenes, at most ``bound`` are the mean CIEDE2000 of the picture,
    of which materials' matrices alone make ``models``; ``bounces`` and ``open_sky`` are those
    without bounced light and under the open sky. ``coarse``: whether a bake's first patches do.
    """

    light: str
    rays: int
    coarse: bool
    expected: float
    bound: float
    models: float
    bounces: float
    open_sky: float

    @property
    def line(self) -> str:
        """All of it in words."""
        expected, bound = max(self.expected, 0.01), max(self.bound, 0.01)
        off = f"expected ΔE {expected:.2g}, at most {bound:.2g} in 19 of 20"
        if self.light == OPEN:
            return f"open sky: {off}"
        less = f"without bounces ΔE {self.bounces:.2g}, under the open sky {self.open_sky:.2g}"
        return f"all bounces, {self.rays} rays: {off}; {less}"

    def plain(self) -> dict[str, Any]:
        """Return it as plain data that JSON holds."""
        return asdict(self)


def least_light(found: Sounding, tolerance: float) -> LeastLight:
    """Choose the cheapest light whose bound keeps to a tolerance [CIEDE2000]; where none does, all
    bounces from `MOST` rays.

    What light and what matrices are off by is independent, the one in brightness most of all, the
    other in hue: both together are the root of their squares' sum.
    """
    allowed = max(math.sqrt(max(tolerance**2 - found.models**2, 0.0)), LEAST * tolerance)
    levels = _levels(found)
    level = next((each for each in levels if each.bound <= allowed), levels[-1])
    expected, bound = (math.hypot(found.models, each) for each in (level.error, level.bound))
    return LeastLight(
        level.light,
        level.rays,
        level.coarse,
        expected,
        bound,
        found.models,
        found.bounces,
        found.open_sky,
    )


@dataclass(frozen=True)
class _Level:
    light: str
    rays: int
    coarse: bool
    error: float
    bound: float


def _levels(found: Sounding) -> list[_Level]:
    """What light there is, from the cheapest on."""
    levels = [_Level(OPEN, 0, True, found.open_sky, AT_MOST[OPEN] * found.open_sky)]
    for rays, noise in _noise(found).items():
        error, most = noise, (AT_MOST[BAKED] if rays < FINEST else FURTHER) * noise
        together = math.hypot(error, found.patches), math.hypot(most, PATCHES * found.patches)
        levels.append(_Level(BAKED, rays, True, *together))
        levels.append(_Level(BAKED, rays, False, error, most))
    # Finer patches cost more than the rays of a first light, which are cast in any case.
    return levels[:2] + levels[3:]


def _noise(found: Sounding) -> dict[int, float]:
    """What each count of rays is off by, up to `MOST`: light of more rays falls on as it fell."""
    noise = dict(sorted(found.noise.items()))
    before, last = list(noise.values())[-2:]
    ratio = min(last / max(before, 1e-9), 1.0)
    rays = max(noise)
    while rays < MOST:
        rays, last = 4 * rays, last * ratio
        noise[rays] = last
    return noise
