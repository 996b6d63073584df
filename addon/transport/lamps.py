"""Lamps and the sun: their light on places, and rays of theirs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from . import directions
from .beams import Columns
from .hits import Space


@dataclass
class Direct:
    """A lamp or the sun, whose light is cast with shadows.

    ``spectrum`` (16,): irradiance / pi on a face that looks at it, at a distance of 1 where it is
    not endlessly far.
    """

    place: NDArray[np.float64] | None
    """(3,); None for one that is endlessly far."""
    direction: NDArray[np.float64]
    """(3,): towards the far one; else the axis that it shines along."""
    spectrum: NDArray[np.float32]
    cone: tuple[float, float] = (-1.0, -1.0)
    """Cosines from the axis where a spot's light ends, and where it is whole."""
    area: NDArray[np.float64] | None = None
    """(2, 3): the half sides of one that is flat, which shines by the cosine to one side."""
    radius: float = 0.0
    """Of a ball."""
    but: Columns | None = None
    """Where light of a far one is left out."""

    def seen_from(self, origin: NDArray[np.float64]) -> Direct:
        """Return the same lamp where places are relative to an origin (3,)."""
        return self if self.place is None else replace(self, place=self.place - origin)


def shine(
    space: Space,
    lamp: Direct,
    starts: NDArray[np.float32],
    normals: NDArray[np.float32],
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """Return the irradiance / pi (n, 16) of a lamp on points (n, 3), by one shadow ray each."""
    result = np.zeros((len(starts), len(lamp.spectrum)), np.float32)
    if lamp.place is None:
        ways = np.broadcast_to(np.asarray(lamp.direction, np.float32), starts.shape)
        far, strength = None, np.ones(len(starts), np.float32)
        if lamp.but is not None:
            strength[lamp.but.holds(starts)] = 0.0
    else:
        place = np.broadcast_to(lamp.place, starts.shape)
        if lamp.area is not None:
            place = place + (rng.random((len(starts), 2)) * 2.0 - 1.0) @ lamp.area
        to = place - starts
        far = np.linalg.norm(to, axis=1)
        ways = (to / np.maximum(far, 1e-9)[:, None]).astype(np.float32)
        strength = 1.0 / np.maximum(far, max(lamp.radius, 1e-6)) ** 2
        axis = -(ways @ np.asarray(lamp.direction, np.float32))
        if lamp.area is not None:
            strength *= np.maximum(axis, 0.0)
        elif lamp.cone[1] > -1.0:
            end, whole = lamp.cone
            t = np.clip((axis - end) / max(whole - end, 1e-6), 0.0, 1.0)
            strength *= t * t * (3.0 - 2.0 * t)
    strength = strength * np.einsum("nk,nk->n", ways, normals)
    lit = np.flatnonzero(strength > 0.0)
    if not len(lit):
        return result
    ways = np.ascontiguousarray(ways[lit])
    rows, odd, passed = space.trace(starts[lit], ways, None if far is None else far[lit])
    seen = (rows >= space.sky) & (rows < space.lost)
    light = np.where(seen, strength[lit], 0.0).astype(np.float32)[:, None] * lamp.spectrum
    if len(odd):
        light[odd] *= np.array(space.filters)[passed]
    result[lit] = light
    return result


def sent(
    lamp: Direct, rays: int, rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """Return rays of a lamp that is near: their starts and directions (n, 3), and of how much flux
    each is [its strength times area]."""
    assert lamp.place is not None
    z = 1.0 - (np.arange(rays) + 0.5) / rays * (1.0 - lamp.cone[0])
    turn = np.arange(rays) * np.pi * (3.0 - 5.0**0.5)
    root = np.sqrt(1.0 - z * z)
    pattern = np.stack([root * np.cos(turn), root * np.sin(turn), z], axis=1)
    ways = directions.about(np.asarray(lamp.direction)[None], pattern.astype(np.float32))[0]
    starts = np.repeat(lamp.place[None], rays, axis=0)
    if lamp.area is not None:
        starts = starts + (rng.random((rays, 2)) * 2.0 - 1.0) @ lamp.area
    flux = 2.0 * np.pi * (1.0 - lamp.cone[0]) / rays
    return starts.astype(np.float32), np.ascontiguousarray(ways, np.float32), flux
