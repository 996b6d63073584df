"""Where the faces stand that ways to hold light are tried on: in the open, or in a street.

The street is endless, so what its strips of ground and wall send one another is known in closed
form, and all bounces are one system of linear equations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from ..sky.irradiance import exact_irradiance, fit_coefficients
from ..sky.lat_long import directions, solid_angles
from ..sky.light import FACES

_FINER = 2
"""How much finer than the sky's pixels are the rays that walls stop."""

_STRIPS = 20
"""Of the ground and of each wall: 40 change what has bounced by under 0.3 %."""


@dataclass(frozen=True)
class SkyPicture:
    """A lat-long sky (h, 2 h, 3), without the sun's disc."""

    rgb: NDArray[np.float64]

    @cached_property
    def polynomials(self) -> tuple[NDArray[np.float64], ...]:
        """Coefficients of its irradiance for each degree, fitted once."""
        return fit_coefficients(self.rgb).of_degrees

    @cached_property
    def fine(self) -> NDArray[np.float64]:
        """The same with finer pixels, for rays."""
        return self.rgb.repeat(_FINER, axis=0).repeat(_FINER, axis=1)


@dataclass(frozen=True)
class Neighbours:
    """Who lights faces (k) beside the sky: m strips, themselves a `Place`, that lie around them.

    ``between`` (m, m): the strips' view factors of one another, in closed form; ``all_bounces``
    (k, m): from the strips' direct irradiance to what the faces get by any number of bounces;
    ``by_rays``: the same from so many rays for each face and strip.
    """

    strips: Place
    between: NDArray[np.float64]
    all_bounces: NDArray[np.float64]
    by_rays: Callable[[int], NDArray[np.float64]]


@dataclass(frozen=True)
class Place:
    """Where faces stand: ``normals`` (k, 3), and whether they ``see`` (k, ...) directions (..., 3).

    Where no walls are, ``sees`` is None; where nothing sends light back, ``neighbours``.
    """

    normals: NDArray[np.float64]
    sees: Callable[[NDArray[np.float64]], NDArray[np.bool_]] | None = None
    neighbours: Neighbours | None = None

    def irradiance(self, sky: SkyPicture) -> NDArray[np.float64]:
        """Return the true irradiance / pi (k, 3), every bounce in it."""
        direct = self.direct(sky)
        if self.neighbours is None:
            return direct
        return direct + self.neighbours.all_bounces @ self.neighbours.strips.direct(sky)

    def direct(self, sky: SkyPicture) -> NDArray[np.float64]:
        """Return what of it comes from the sky (k, 3).

        Without walls in closed form, between walls by adding up all that is seen.
        """
        if self.sees is None:
            return exact_irradiance(sky.rgb, self.normals)
        return self.transfer(len(sky.fine)) @ sky.fine.reshape(-1, 3)

    def transfer(self, height: int) -> NDArray[np.float64]:
        """Return what each pixel of a sky of so many rows counts on each face, (k, pixels)."""
        to = directions(height, 2 * height)
        cosine = np.maximum(np.einsum("kd,hwd->khw", self.normals, to), 0.0)
        cosine *= solid_angles(height, 2 * height)[:, None] / np.pi
        if self.sees is not None:
            cosine *= self.sees(to)
        return cosine.reshape(len(self.normals), -1)


def street(height: float = 1.0, reflectance: float = 0.0) -> Place:
    """Return 15 faces in an endless street, as wide as 1, with flat grey walls and ground.

    Five across the ground that look up, five up each wall that look over the street. It runs 30°
    off the x axis, so that neither it nor the sky's own lines are favoured. ``reflectance`` of the
    ground and both walls, 0 to under 1.
    """
    faces = _faces(height, np.linspace(0.1, 0.9, 5))
    if reflectance == 0.0:
        return _seeing(height, *faces)
    strips = _faces(height, (np.arange(_STRIPS) + 0.5) / _STRIPS)

    def all_bounces(factors: Callable[..., NDArray]) -> NDArray[np.float64]:
        between = reflectance * factors(height, *strips)
        return reflectance * factors(height, *faces) @ np.linalg.inv(np.eye(len(between)) - between)

    def by_rays(rays: int) -> NDArray[np.float64]:
        return all_bounces(partial(_shares_of_rays, rays=rays))

    neighbours = Neighbours(
        _seeing(height, *strips),
        _view_factors(height, *strips),
        all_bounces(_view_factors),
        by_rays,
    )
    return _seeing(height, *faces, neighbours)


_TURN = np.radians(30.0)
_ACROSS = np.array([-np.sin(_TURN), np.cos(_TURN), 0.0])
_UP = np.array([0.0, 0.0, 1.0])


def _faces(height: float, along: NDArray) -> tuple[NDArray, NDArray]:
    """Return places and normals (3 n, 2), across and up, at parts (n) of ground and each wall."""
    side, up = along - 0.5, along * height
    at = [np.stack([side, 0 * side], 1), *(np.stack([s + 0 * up, up], 1) for s in (-0.5, 0.5))]
    normals = np.repeat([[0.0, 1.0], [1.0, 0.0], [-1.0, 0.0]], len(along), axis=0)
    return np.concatenate(at), normals


def _seeing(
    height: float, at: NDArray, normals: NDArray, neighbours: Neighbours | None = None
) -> Place:
    def sees(to: NDArray[np.float64]) -> NDArray[np.bool_]:
        over = to @ _ACROSS
        # The wall ahead, as far away as this, is passed where the ray has risen above it.
        ahead = 0.5 - at[:, 0].reshape(-1, *[1] * over.ndim) * np.sign(over)
        missing = height - at[:, 1].reshape(-1, *[1] * over.ndim)
        return (to[..., 2] > 0) & (to[..., 2] * ahead >= missing * np.abs(over))

    return Place(normals @ np.stack([_ACROSS, _UP]), sees, neighbours)


def _view_factors(height: float, at: NDArray, normals: NDArray) -> NDArray[np.float64]:
    """Return the view factors (k, m) of the strips from places (k, 2), in closed form.

    Of an endless strip it is half the difference of its edges' sines, taken from the normal.
    """
    edges = np.linspace(0.0, 1.0, _STRIPS + 1)
    ends = _faces(height, edges)[0].reshape(3, _STRIPS + 1, 2)
    to = ends[None] - at[:, None, None]
    tangents = np.stack([normals[:, 1], -normals[:, 0]], 1)
    along = np.einsum("ksed,kd->kse", to, tangents)
    sines = along / np.maximum(np.linalg.norm(to, axis=-1), 1e-12)
    factors = np.abs(np.diff(sines, axis=2)) / 2.0
    own = np.einsum("ksed,kd->kse", to, normals).max(axis=2) < 1e-9  # the side that it lies in
    return np.where(own[..., None], 0.0, factors).reshape(len(at), -1)


def _shares_of_rays(height: float, at: NDArray, normals: NDArray, rays: int) -> NDArray[np.float64]:
    """Return the shares (k, m) of cosine-weighted rays from places (k, 2) that hit each strip."""
    rng = np.random.default_rng(1)
    # In the cross-section the sine to the normal is even, as `_view_factors` has it.
    sine = 2.0 * (np.arange(rays) + rng.random((len(at), rays))) / rays - 1.0
    tangents = np.stack([normals[:, 1], -normals[:, 0]], 1)
    to = sine[..., None] * tangents[:, None] + np.sqrt(1 - sine**2)[..., None] * normals[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        ground = np.where(to[..., 1] < 0, -at[:, None, 1] / to[..., 1], np.inf)
        wall = np.where(
            to[..., 0] != 0, (0.5 * np.sign(to[..., 0]) - at[:, None, 0]) / to[..., 0], np.inf
        )
    wall = np.where(wall > 1e-9, wall, np.inf)
    first = np.minimum(ground, wall)
    hit = at[:, None] + np.where(np.isfinite(first), first, 0.0)[..., None] * to
    on_ground = ground < wall
    side = np.where(on_ground, 0, np.where(to[..., 0] < 0, 1, 2))
    part = np.where(on_ground, hit[..., 0] + 0.5, hit[..., 1] / max(height, 1e-9))
    strip = side * _STRIPS + np.clip((part * _STRIPS).astype(int), 0, _STRIPS - 1)
    seen = np.isfinite(first) & (part <= 1.0)
    shares = np.zeros((len(at), 3 * _STRIPS))
    np.add.at(shares, (np.nonzero(seen)[0], strip[seen]), 1.0 / rays)
    return shares


PLACES = {"open": Place(FACES), "street": street(reflectance=0.4)}
"""Under the whole sky, and between light grey walls as high as the street is wide."""
