"""Light of every bounce through a day: baked for few moments, between which others are mixed.

The rays between surfaces are cast once; for each moment light goes round along them anew. What is
kept of a moment is light over the sky's level, as of key skies (`moments`), which varies mildly. It
depends on where the sun stands, not on how high alone, so its keys lie along the course, in time.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, aside, mapped
from ...sky.sun_course import SAMPLES, Course
from ...spectra.cielab import XYZ_to_Lab, delta_E_2000
from ..bake import camera_share, colours, session
from ..bake.collected import Shading
from ..bake.light import SceneLight
from .curves import SEAM
from .moments import WITHIN

MOST = 64
"""Moments that light is baked for."""

ENOUGH = 4000
"""Patches by which the light between two moments is judged."""

BIG = 100e6
"""[bytes] of a file that are worth a line."""

At = Callable[[float], Generator[Progress, None, tuple[SceneLight, float]]]
"""What finds the light of a moment, 0 to 1 along the course, and the sky's level as played."""


@dataclass(frozen=True, eq=False)
class KeyLights:
    """The light of moments, and what mixtures of them leave.

    ``at`` (k,): when, from 0 to 1 along the course; ``values``: what objects have at each, over the
    sky's level; ``levels`` (k,): that; ``steady``: what does not follow the sky, None where nothing
    does not; ``error`` and ``most``: CIEDE2000 halfway between two moments, the largest mean over
    what is seen, and the largest that 95 % of it keep to.
    """

    at: list[float]
    values: list[colours.Values]
    levels: list[float]
    steady: colours.Values | None
    error: float
    most: float

    @property
    def brightest(self) -> tuple[int, float]:
        """The number of the moment with the highest level, and that level."""
        k = int(np.argmax(self.levels))
        return k, self.levels[k]

    @property
    def size(self) -> int:
        """The bytes that they take in a file."""
        points = sum(len(each) for _, own in self.values[0] for each in own.values())
        return points * 12 * len(self.at)


def marks(course: Course, low: float, frames: int) -> list[tuple[float, float]]:
    """Return the parts of a course, each smooth, in which there is light: from where to where.

    Their ends are where the sun rises or sets (`curves`), and where skies end at ``low`` [degrees].
    """
    x = np.linspace(0.0, 1.0, SAMPLES)
    height = course.elevation.at(x)
    ends = {0.0, 1.0}
    for edge in (low, 0.0, SEAM):
        above = height - edge
        k = np.flatnonzero(above[:-1] * above[1:] < 0.0)
        ends |= set((x[k] - above[k] * (x[k + 1] - x[k]) / (above[k + 1] - above[k])).tolist())
    parts = [(a, b) for a, b in pairwise(sorted(ends)) if b - a > 0.5 / frames]
    middles = course.elevation.at(np.array([0.5 * (a + b) for a, b in parts]))
    lit = [part for part, middle in zip(parts, middles.tolist(), strict=True) if middle > low]
    return lit or [(0.0, 1.0)]


def finding(
    objects: Sequence[bpy.types.Object],
    at: At,
    parts: Sequence[tuple[float, float]],
    frames: int,
    within: float = WITHIN,
) -> Generator[Progress, None, KeyLights]:
    """Find the fewest moments, by halving, whose light stands for that of all; nothing of the file
    changes. ``objects``: baked, as they stand; ``parts`` of the course, as `marks` has them.
    """
    keys: dict[float, colours.Values] = {}
    looks: dict[float, _Look] = {}
    levels: dict[float, float] = {}
    errors, most = [0.0], [0.0]
    light, _ = yield from at(parts[0][0])
    lit, _ = yield from session.recalling(objects, light)
    steady = yield from _steady(lit, light)
    judge = yield from aside(Progress(0.0, "baked light"), _Judge.of, lit)
    total = sum(b - a for a, b in parts)
    left = list(parts)

    def step() -> Progress:
        done = 1.0 - sum(b - a for a, b in left) / total
        return Progress(0.99 * done, f"baked light of {len(keys) + 1} moments")

    def gone_round(x: float) -> Generator[Progress, None, Shading]:
        light, level = yield from mapped(at(x), lambda p: replace(step(), waits=p.waits))
        shading = yield from session.going_round(lit, light.of_sky, step())
        looks[x], levels[x] = judge.look(lit, light, level), level
        return shading

    def keep(x: float, shading: Shading) -> Generator[Progress, None, None]:
        told = step()
        work = session.lighting(lit, shading)
        values = yield from mapped(work, lambda p: replace(told, waits=p.waits))
        scale = np.float32(1.0 / levels[x])
        keys[x] = [(name, {k: _over(v, scale) for k, v in own.items()}) for name, own in values]

    for x in sorted({x for part in parts for x in part}):
        yield from keep(x, (yield from gone_round(x)))
    while left:
        first, last = left[0]
        middle = 0.5 * (first + last)
        if last - first <= 1.0 / max(frames - 1, 1):
            left.pop(0)  # no frame shows what lies between
            continue
        shading = yield from gone_round(middle)
        mean, ninety_fifth = judge.error(looks[first], looks[last], 0.5, looks[middle])
        left.pop(0)
        if mean > within and len(keys) < MOST:
            yield from keep(middle, shading)
            left += [(first, middle), (middle, last)]
        else:
            errors.append(mean)
            most.append(ninety_fifth)
            del looks[middle]
    ordered = sorted(keys)
    return KeyLights(
        ordered,
        [keys[x] for x in ordered],
        [levels[x] for x in ordered],
        steady,
        max(errors),
        max(most),
    )


def _over(values: NDArray[np.float32], scale: np.float32) -> NDArray[np.float32]:
    return values[:, :3] * scale


def _steady(
    lit: session.Session, light: SceneLight
) -> Generator[Progress, None, colours.Values | None]:
    """What objects have of lamps, and of what shines by itself: whatever the sky does."""
    lamps = light.of_lamps
    if not lamps.lamps and not lamps.matter(lit.materials).emission.any():
        return None
    at = Progress(0.0, "light of lamps")
    shading = yield from session.going_round(lit, lamps, at)
    work = session.lighting(lit, shading)
    return (yield from mapped(work, lambda p: replace(at, waits=p.waits)))


@dataclass(frozen=True, eq=False)
class _Look:
    """What some patches show of a moment over its level, XYZ (n, 3): all but direct light, that,
    and white."""

    light: NDArray[np.float64]
    direct: NDArray[np.float64]
    white: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Judge:
    """Some patches (n,), and how much each counts, (2, n): by area, and in the camera's picture."""

    patches: NDArray[np.int64]
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, lit: session.Session) -> _Judge:
        """Of what is baked; without a camera by area alone."""
        space = lit.radiosity.space
        rows = [camera_share.weights(space, None)]
        eye = camera_share.Eye.of(bpy.context.scene, lit.origin)
        if eye is not None and (seen := camera_share.weights(space, eye)).any():
            rows.append(seen)
        weights = np.array(rows)
        patches = np.flatnonzero(weights[-1] > 0.0)
        patches = patches[:: -(-len(patches) // ENOUGH) or 1]
        return cls(patches, weights[:, patches])

    def look(self, lit: session.Session, light: SceneLight, level: float) -> _Look:
        """What the patches show of the light that has just gone round."""
        found, some = lit.radiosity, self.patches
        to_XYZ = light.to_XYZ.T / level
        rho, direct = found.rho[some], found.direct[some]
        return _Look(
            (rho * (found.E[some] - direct)) @ to_XYZ,
            (rho * direct) @ to_XYZ,
            found.E[some] @ to_XYZ,
        )

    def error(self, one: _Look, other: _Look, share: float, true: _Look) -> tuple[float, float]:
        """CIEDE2000 of a mixture, beside the true direct light: its mean, and what 95 % keep to."""
        lit = true.white[:, 1] > 0.0
        if not lit.any():
            return 0.0, 0.0
        mixed = (1.0 - share) * one.light + share * other.light + true.direct
        white = true.white[lit]
        off = delta_E_2000(
            XYZ_to_Lab(mixed[lit], white), XYZ_to_Lab((true.light + true.direct)[lit], white)
        )
        order = np.argsort(off)
        found = []
        for weight in self.weights[:, lit]:
            if not weight.sum() > 0.0:
                continue
            reached = np.cumsum(weight[order]) / weight.sum()
            at = min(int(np.searchsorted(reached, 0.95)), len(off) - 1)
            found.append((float(np.average(off, weights=weight)), float(off[order][at])))
        return max(each[0] for each in found), max(each[1] for each in found)
