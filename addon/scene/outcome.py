"""What came of a use case, to be reported by whoever called it."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..sky.light import SkyLight
from ..transfer.assignment import ESTIMATED
from .materials.record import Result


@dataclass(frozen=True)
class Outcome:
    """What came of a use case.

    ``light``: the World's sky, None where no material asked for it; ``results``: a material each;
    ``skipped``: why materials were left out, a line each; ``lines``: what else to read.
    """

    light: SkyLight | None = None
    results: list[Result] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Everything:
    """What came of making a whole scene spectral: results, and (name, reason) of those left."""

    results: list[Result]
    left: list[tuple[str, str]]

    @property
    def estimated(self) -> int:
        """How many have a reflectance that nobody measured."""
        return sum(result.reflectance == ESTIMATED for result in self.results)

    @property
    def line(self) -> str:
        """How many of which, in one sentence."""
        count = f"{len(self.results)} material(s) spectral, {self.estimated} of them estimated"
        return f"{count}; {len(self.left)} left alone" if self.left else count
