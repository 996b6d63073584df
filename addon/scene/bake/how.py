"""How much a bake does: how finely it divides, and how many rays its points cast."""

from __future__ import annotations

from dataclasses import dataclass, replace

from . import passes
from .least_light import LeastLight

FIRST = 64
"""Rays from points for a first light, where users say how many at last."""


@dataclass(frozen=True)
class How:
    """How to bake: see `scene_bake.bake`; ``first_only``: no more than a first light.

    ``least``: the light that is enough; None where all that can be had is wanted.
    """

    rays: int | None
    tolerance: float
    slow: bool
    first_only: bool = False
    error: float | None = None
    least: LeastLight | None = None

    def passes(self, points: int) -> list[int]:
        """Return how many rays so many points cast in each pass."""
        if self.rays is not None:
            return [FIRST, self.rays]
        ends = passes.rays_of(points, self.slow)
        if self.least is None:
            return ends
        enough = next((k for k, end in enumerate(ends) if end >= self.least.rays), len(ends))
        return ends[: max(enough, 0 if self.coarse else 1) + 1]

    @property
    def coarse(self) -> bool:
        """Whether light that goes round between the first patches is enough."""
        return self.least is not None and self.least.coarse

    def said(self, rays: int) -> LeastLight | None:
        """Return the light that was enough, with so many rays as were cast for it."""
        return None if self.least is None else replace(self.least, rays=rays)

    @property
    def sure(self) -> float:
        """By which part a pass may change the light of a point that is done."""
        return max(passes.SURE, passes.PER_DELTA_E * (self.error or 0.0))
