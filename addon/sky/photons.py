"""Light of every order of scattering, by following random ways of light over the whole spectrum.

Ways are followed backwards, from the eye, and at every turn the sun is asked for its light (next
event estimation), so that each gives a share to every order. One way serves all 81 wavelengths:
where it turns is drawn for one of six wavelengths, `HEROES`, and its weight at every wavelength is
divided by the mean of the six densities that it could have been drawn from (the balance heuristic:
A. Wilkie et al. 2014, "Hero Wavelength Spectral Sampling", DOI 10.1111/cgf.12419). No weight can
then grow far over one, and colours, being ratios of one way's weights, come out less noisy than
radiances.

Polarisation is left out, as in all of this package: in the blue zenith of a clear sky that is an
error of a few per cent of the light scattered twice and more.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..spectra.grid import WAVELENGTHS
from .atmosphere import EARTH_RADIUS, Medium
from .path_lengths import columns_to_space, distances
from .phase_functions import draw_haze, draw_rayleigh, haze_density, haze_phase, rayleigh_phase
from .products import product
from .scattering import direction, transmittance

HEROES = np.searchsorted(WAVELENGTHS, [390.0, 430.0, 480.0, 540.0, 620.0, 720.0])
"""Indices of the wavelengths that turns are drawn for: evenly apart in the depth of air."""

ORDERS = ("first", "second", "higher", "ground")
"""What light is sorted into: scattered once, twice, more often, and all that touched the ground."""

SOUGHT = -6.0, -2.0
"""[degrees] of the suns whose light guided ways seek, whatever the sun is that shines.

Turns are weighed by the chance that any of them had (the balance heuristic again), so that ways are
the same for every low sun: what chance leaves out of a sky changes smoothly as the sun sinks.
"""

_TURNS = 100  # ways end by chance long before


def follow(
    matter: Medium,
    sun: NDArray[np.float64],
    directions: NDArray[np.float64],
    ways: int,
    random: np.random.Generator,
    last: int | None = None,
    guided: bool = False,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean radiance of random ways, and the mean square of what single ways brought.

    Parameters
    ----------
    matter
        The medium, of some fifty shells: time is proportional to their number.
    sun
        Unit vector towards the sun, (3,), or one for every way, (m ways, 3).
    directions
        Where to look, above the horizon, unit vectors (m, 3).
    ways
        How many for each direction; their first turns are spread evenly over the depth.
    last
        Scatterings after which ways end, without touching the ground; None: no end.
    guided
        Whether ways seek the light, which pays when the sun is low; of one sun for all ways.

    Returns
    -------
    Radiance per irradiance of the sun outside [1/sr], by `ORDERS`, (4, m, 81); and the mean square
    of the sum of all but the first order, (m, 81).
    """
    count = len(directions) * ways
    brought = np.zeros((count, len(ORDERS), WAVELENGTHS.size))
    spread = (np.arange(count) % ways + random.random(count)) / ways
    guide = _Guide(matter, sun) if guided else None
    way = _Ways(matter, sun, np.repeat(directions, ways, axis=0), random, guide)
    for turn in range(_TURNS):
        way.fly(spread if turn == 0 else random.random(len(way.index)), turn > 0)
        if last is not None:
            way.keep(~way.grounded)
        order = np.where(way.touched, 3, np.minimum(way.scatterings - 1, 2))
        brought[way.index, order] += way.sunlight()
        if last is not None and turn + 1 >= last:
            break
        way.turn()
        if turn > 0:
            way.thin_out()
        if not len(way.index):
            break
    brought = brought.reshape(len(directions), ways, len(ORDERS), -1)
    square = brought[:, :, 1:].sum(axis=2) ** 2
    return brought.mean(axis=1).transpose(1, 0, 2), square.mean(axis=1)


_OF_EACH = (
    *("index", "sun", "position", "direction", "weight", "odds", "hero"),
    *("columns", "scatterings", "touched", "grounded", "layer"),
)


class _Ways:
    """Many ways of light at once; arrays over those still under way, (p, ...).

    ``weight`` (p, 81): what would come back from here per radiance; ``odds`` (p, k): how likely
    each hero was to draw this way, relative to the mean of all; where ways are guided, each hero
    with each of the guide's suns.
    """

    def __init__(
        self,
        matter: Medium,
        sun: NDArray,
        direction: NDArray,
        random: np.random.Generator,
        guide: _Guide | None,
    ) -> None:
        count = len(direction)
        self.guide = guide
        self.sun = np.broadcast_to(sun, (count, 3))
        self.matter, self.random, self.direction = matter, random, direction
        self.index = np.arange(count)
        self.position = np.tile([0.0, 0.0, EARTH_RADIUS], (count, 1))
        self.weight = np.ones((count, WAVELENGTHS.size))
        kinds = HEROES.size * (1 if guide is None else len(guide.suns))
        self.odds = np.ones((count, kinds))
        self.hero = random.integers(kinds, size=count)
        self.columns = np.zeros((count, 5))
        self.scatterings = np.zeros(count, dtype=int)
        self.touched = np.zeros(count, dtype=bool)
        self.grounded = np.zeros(count, dtype=bool)
        self.layer = np.zeros(count, dtype=int)
        # A ray's segments: down through the shells, (nothing under its lowest point,) and up.
        self.density = np.concatenate([matter.density[::-1], np.zeros((1, 5)), matter.density])
        self.scattering = matter.scattering[:2]
        self.heroes = np.repeat(self.scattering[:, HEROES], kinds // HEROES.size, axis=1)

    def keep(self, chosen: NDArray[np.bool_]) -> None:
        """Let only some go on."""
        if chosen.all():
            return
        for name in _OF_EACH:
            setattr(self, name, getattr(self, name)[chosen])

    def fly(self, chance: NDArray[np.float64], seek: bool) -> None:
        """Go straight on to the next turn, in the air or on the ground.

        ``seek``: preferably where the sun shines, if there is a guide.
        """
        radius = np.linalg.norm(self.position, axis=1)
        start = np.einsum("pk,pk->p", self.position, self.direction)
        lowest = np.sqrt(np.maximum(radius**2 - start**2, 0.0))
        reach = distances(self.matter, lowest)
        grounding = (start < 0) & (lowest < EARTH_RADIUS)
        end = np.where(grounding, -reach[:, 0], reach[:, -1])
        marks = np.concatenate([-reach[:, ::-1], reach], axis=1)
        marks = np.clip(marks, start[:, None], end[:, None])
        lengths = np.diff(marks)
        # Optical depth for the hero that decides, and the place where it reaches the drawn one.
        mine = self.heroes[:, self.hero].T
        steps = lengths * product(mine, self.density[:, :2].T)
        if seek and self.guide is not None:
            segment, share = self._guided(
                self.guide, lengths, steps, marks, start, grounding, chance
            )
        else:
            segment, share = self._unguided(lengths, steps, grounding, chance)
        rows = np.arange(len(segment))
        place = marks[rows, segment] + share * lengths[rows, segment]
        place = np.where(self.grounded, end, place)
        passed = product(np.clip(place[:, None] - marks[:, :-1], 0.0, lengths), self.density)
        self.position = self.position + (place - start)[:, None] * self.direction
        self.columns += passed
        self.layer = segment
        self.weight *= np.exp(-product(passed[:, :3], self.matter.extinction))
        self.odds *= np.exp(-(passed[:, :2] @ self.heroes))
        self.scatterings += ~self.grounded
        self.touched |= self.grounded

    def _unguided(
        self, lengths: NDArray, steps: NDArray, grounding: NDArray, chance: NDArray
    ) -> tuple[NDArray, NDArray]:
        """Choose by chance where to turn, as light would, but never leave the atmosphere.

        Returns the segment and the share of it that is passed, (p,) each.
        """
        depth = np.cumsum(steps, axis=1)
        passing = np.where(grounding, 0.0, np.exp(-depth[:, -1]))
        drawn = -np.log1p(-chance * (1.0 - passing))
        self.grounded = (drawn >= depth[:, -1]) & grounding
        rows = np.arange(len(drawn))
        segment = np.minimum((depth < drawn[:, None]).sum(axis=1), depth.shape[1] - 1)
        before = depth[rows, segment] - steps[rows, segment]
        share = (drawn - before) / np.maximum(steps[rows, segment], 1e-300)
        leaving = -np.expm1(-product(lengths, self.density[:, :2] @ self.heroes))
        self.odds /= np.where(grounding[:, None], 1.0, np.maximum(leaving, 1e-300))
        return segment, np.clip(share, 0.0, 1.0)

    def _guided(
        self,
        guide: _Guide,
        lengths: NDArray,
        steps: NDArray,
        marks: NDArray,
        start: NDArray,
        grounding: NDArray,
        chance: NDArray,
    ) -> tuple[NDArray, NDArray]:
        """Choose as `_unguided`, with every segment counting for more the more sun it has."""
        middle = 0.5 * (marks[:, 1:] + marks[:, :-1])
        lowest = np.einsum("pk,pk->p", self.position, self.position) - start**2
        radius = np.sqrt(np.maximum(lowest[:, None] + middle**2, 1.0))
        height = (self.position @ guide.suns.T)[:, :, None]
        toward = (self.direction @ guide.suns.T)[:, :, None]
        height = (height + (middle - start[:, None])[:, None] * toward) / radius[:, None]
        worth = guide.worth(height)
        # Of turning within each segment, and (last) on the ground, for every hero, then every sun.
        count = len(guide.suns)
        heroes = self.heroes[:, ::count].T
        passed = lengths[:, None, :] * (heroes @ -self.density[:, :2].T)
        np.exp(np.cumsum(passed, axis=2, out=passed), out=passed)
        stopped = np.empty_like(passed)
        np.subtract(1.0, passed[:, :, 0], out=stopped[:, :, 0])
        np.subtract(passed[:, :, :-1], passed[:, :, 1:], out=stopped[:, :, 1:])
        down = np.where(grounding, guide.floor, 0.0)
        total = np.matmul(stopped, worth.transpose(0, 2, 1))
        total += (down[:, None] * passed[:, :, -1])[..., None]
        total = total.reshape(len(start), -1)
        rows = np.arange(len(start))
        hero, sought = np.divmod(self.hero, count)
        sums = np.cumsum(stopped[rows, hero] * worth[rows, sought], axis=1)
        drawn = chance * total[rows, self.hero]
        self.grounded = (drawn >= sums[:, -1]) & grounding
        segment = np.minimum((sums <= drawn[:, None]).sum(axis=1), sums.shape[1] - 1)
        step = steps[rows, segment]
        within = -np.log1p(self.random.random(len(rows)) * np.expm1(-step))
        factor = np.where(self.grounded[:, None], down[:, None], worth[rows, :, segment])
        self.odds *= np.tile(factor, HEROES.size) / np.maximum(total, 1e-300)
        return segment, np.clip(within / np.maximum(step, 1e-300), 0.0, 1.0)

    def sunlight(self) -> NDArray[np.float64]:
        """Return what the sun sends back along each way from the turn that it is at, (p, 81)."""
        radius = np.linalg.norm(self.position, axis=1)
        height = np.einsum("pk,pk->p", self.position, self.sun) / radius
        to_sun = columns_to_space(self.matter, np.maximum(radius, EARTH_RADIUS), height)
        to_sun[:, 3:] += self.columns[:, 3:]  # bands count on the whole way
        light = self.weight * transmittance(self.matter, to_sun)
        air, haze = self._densities()
        cosine = np.einsum("pk,pk->p", self.direction, self.sun)
        turned = (air * rayleigh_phase(cosine))[:, None] * self.scattering[0]
        turned += (haze * haze_phase(cosine, self.matter.asymmetry))[:, None] * self.scattering[1]
        odds = self.odds * (np.stack([air, haze], axis=1) @ self.heroes)
        ground = self.matter.ground * (np.maximum(height, 0.0) / np.pi)[:, None]
        turned = np.where(self.grounded[:, None], ground, turned)
        odds = np.where(self.grounded[:, None], self.odds, odds)
        return light * turned / odds.mean(axis=1, keepdims=True)

    def turn(self) -> None:
        """Draw the direction to go on in."""
        count = len(self.index)
        air, haze = self._densities()
        mine = self.heroes[:, self.hero] * [air, haze]
        by_haze = self.random.random(count) * mine.sum(axis=0) < mine[1]
        chance = self.random.random(count)
        asymmetry = self.matter.asymmetry
        cosine = np.where(by_haze, draw_haze(chance, asymmetry), draw_rayleigh(chance))
        up = self.position / np.linalg.norm(self.position, axis=1, keepdims=True)
        around = 2.0 * np.pi * self.random.random(count)
        scattered = _around(self.direction, cosine, around)
        reflected = _around(up, np.sqrt(chance), around)
        phase = rayleigh_phase(cosine)
        turned = (air * phase)[:, None] * self.scattering[0]
        turned += (haze * haze_phase(cosine, asymmetry))[:, None] * self.scattering[1]
        odds = (air * phase)[:, None] * self.heroes[0]
        odds += (haze * haze_density(cosine, asymmetry))[:, None] * self.heroes[1]
        ground = self.grounded[:, None]
        self.direction = np.where(ground, reflected, scattered)
        self.weight *= np.where(ground, self.matter.ground, turned)
        self.odds *= np.where(ground, 1.0, odds)
        mean = self.odds.mean(axis=1, keepdims=True)
        self.weight /= mean
        self.odds /= mean
        # Rounding must not leave a way under the ground that it starts from.
        self.position = np.where(ground, up * (EARTH_RADIUS + 1e-3), self.position)

    def thin_out(self) -> None:
        """End ways that bring little, by chance, and let the others stand for them."""
        survival = np.clip(self.weight.max(axis=1), 0.05, 0.95)
        alive = self.random.random(survival.size) < survival
        self.weight /= survival[:, None]
        self.keep(alive)

    def _densities(self) -> NDArray[np.float64]:
        """Return the densities of air and haze where the ways are, (2, p)."""
        return self.density[self.layer, :2].T


class _Guide:
    """How much sun there is, by shell and height of the sun: where ways had better turn."""

    floor = 0.01
    """Worth of a turn in the shadow, from where a way may still find light."""

    def __init__(self, matter: Medium, sun: NDArray) -> None:
        longitude = np.arctan2(sun[1], sun[0])
        self.suns = direction(np.radians(SOUGHT), longitude)
        self.heights = np.linspace(-0.3, 0.3, 121)
        middle = EARTH_RADIUS + 0.5 * (matter.edges[1:] + matter.edges[:-1])
        columns = columns_to_space(matter, middle[:, None], self.heights)
        table = self.floor + transmittance(matter, columns)[..., HEROES].mean(axis=-1)
        nothing = np.zeros((1, self.heights.size))
        self.table = np.concatenate([table[::-1], nothing, table])  # by segment of a ray

    def worth(self, height: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the worth of turns in every segment (p, n, s), by the sine of the sun's height."""
        step = self.heights[1] - self.heights[0]
        place = (height - self.heights[0]) / step + 0.5
        place = np.clip(place, 0, self.heights.size - 1).astype(np.intp)
        return self.table[np.arange(len(self.table)), place]


def _around(axis: NDArray, cosine: NDArray, angle: NDArray) -> NDArray[np.float64]:
    """Return unit vectors at an angle's ``cosine`` from ``axis``, turned around it by ``angle``."""
    # T. Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    x, y, z = axis.T
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    first = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=1)
    second = np.stack([b, sign + y * y * a, -y], axis=1)
    sine = np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
    return (
        cosine[:, None] * axis
        + (sine * np.cos(angle))[:, None] * first
        + (sine * np.sin(angle))[:, None] * second
    )
