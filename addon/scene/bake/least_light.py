"""The least light that keeps a whole picture to a tolerance, by what is predicted of it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from ...choices import BAKED, OPEN
from .sounding import Sounding

MOST = 4096
"""Rays from a point: no bake has more."""

LEAST = 0.5
"""Of the tolerance, is left for light where matrices alone need more."""

AT_MOST = {OPEN: 1.25, BAKED: 1.5}
"""By which factor light is off at most in 19 of 20 random scenes, of what is predicted."""


@dataclass(frozen=True)
class LeastLight:
    """Which ``light`` is enough, `OPEN` or `BAKED`, and from how many ``rays`` a point.

    ``expected`` and, in 19 of 20 scenes, at most ``bound`` are the mean CIEDE2000 of the picture,
    that of the materials' matrices included; ``bounces`` and ``open_sky`` are those without bounced
    light and under the open sky. ``coarse``: whether a bake's first patches do.
    """

    light: str
    rays: int
    coarse: bool
    expected: float
    bound: float
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
    enough = (level for level in levels if AT_MOST[level[0]] * level[3] <= allowed)
    light, rays, coarse, error = next(enough, levels[-1])
    factor = AT_MOST[light]
    expected, bound = math.hypot(found.models, error), math.hypot(found.models, factor * error)
    return LeastLight(light, rays, coarse, expected, bound, found.bounces, found.open_sky)


def _levels(found: Sounding) -> list[tuple[str, int, bool, float]]:
    """Light, rays, whether first patches do, and error, from the cheapest on."""
    levels = [(OPEN, 0, True, found.open_sky)]
    counts = sorted(found.noise)
    noise = dict(found.noise)
    while counts[-1] < MOST:
        # Light of more rays falls on as it fell.
        more, last = 4 * counts[-1], noise[counts[-1]]
        noise[more] = last * min(last / max(noise[counts[-2]], 1e-9), 1.0)
        counts.append(more)
    first = counts[1]
    levels.append((BAKED, first, True, math.hypot(noise[first], found.patches)))
    levels += [(BAKED, count, False, noise[count]) for count in counts[2:]]
    return levels
