"""A clear sky with all its light: what was scattered once, twice, more often, and by the ground.

`simulate` puts `scattering` (once, without chance) and `photons` (the rest, by chance, with its
standard error) together over half the sky, which is its own mirror image in the sun's meridian,
and keeps the result on disk under a name made of all that went into it.
"""

from __future__ import annotations

import os
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bar import Bar
from ..choices import listed
from ..errors import InputError, parameter
from ..progress import Progress, aside, run
from ..spectra import cache
from ..spectra.grid import WAVELENGTHS
from ..spectra.sunlight import extraterrestrial_sunlight
from .atmosphere import Atmosphere, Medium, medium
from .phase_functions import haze_phase, rayleigh_phase
from .photons import ORDERS, follow
from .scattering import direction, scattered_once, sun_transmittance

LOWEST_SUN = -6.0
"""[degrees]. Civil twilight's end; below it, stars and lamps begin to count."""


@dataclass(frozen=True)
class Quality:
    """How finely to look: rows and columns of directions over half the sky, and ways in each."""

    once: tuple[int, int]
    """For light scattered once."""
    more: tuple[int, int]
    """For the rest, which is smoother."""
    ways: int
    shells: int


QUALITIES = {
    "preview": Quality(once=(48, 19), more=(16, 13), ways=96, shells=30),
    "reference": Quality(once=(96, 33), more=(32, 64), ways=1024, shells=50),
}
"""By name: under a second of processor time, and a minute with 2,048 directions.

Between the two, by the sun's elevation, in mean CIEDE2000 of the ColorChecker on faces of the open
sky, and of the dome itself, whose directions each have their noise: 0.05 and 1.1 from 20 degrees
on, 0.2 and 2 at 5 and at 0, 0.4 and 4 at -3, 1 and 12 at -6, where light finds its way by chance.
"""


@dataclass(frozen=True)
class SimulatedSky:
    """The radiance of a clear sky over the half on one side of the sun's meridian.

    Rows go up from the horizon (`row_elevations`), columns from the sun's azimuth to its opposite.
    ``once`` (2, rows, columns, 81): by air and by haze, without their phase functions, which change
    faster than any table; ``more`` (3, rows, columns, 81): scattered twice, more often, and all
    that touched the ground [W m^-2 sr^-1 nm^-1]; ``error`` (rows, columns, 81): the standard error
    of their sum; ``direct`` (81,): the sun itself, on a face towards it [W m^-2 nm^-1].
    """

    sun_elevation: float
    atmosphere: Atmosphere
    once: NDArray[np.float32]
    more: NDArray[np.float32]
    error: NDArray[np.float32]
    direct: NDArray[np.float64]

    def radiance(
        self, elevation: ArrayLike, from_sun: ArrayLike, order: str | None = None
    ) -> NDArray[np.float64]:
        """Return the radiance from directions of the sky, (..., 81) [W m^-2 sr^-1 nm^-1].

        ``elevation`` and azimuth ``from_sun`` [rad], (...); under the horizon the value just above
        it. ``order``: one of `photons.ORDERS` alone instead of their sum.
        """
        elevation, from_sun = np.asarray(elevation, float), np.abs(np.asarray(from_sun, float))
        shape = np.broadcast_shapes(elevation.shape, from_sun.shape)
        result = np.zeros((*shape, self.once.shape[-1]))
        if order in (None, "first"):
            air, haze = (_interpolate(table, elevation, from_sun) for table in self.once)
            sun = direction(np.radians(self.sun_elevation), 0.0)
            cosine = direction(elevation, from_sun) @ sun
            result += rayleigh_phase(cosine)[..., None] * air
            result += haze_phase(cosine, self.atmosphere.asymmetry)[..., None] * haze
        if order is None:
            result += _interpolate(self.more.sum(axis=0), elevation, from_sun)
        elif order != "first":
            result += _interpolate(self.more[ORDERS.index(order) - 1], elevation, from_sun)
        return result

    @property
    def ground(self) -> NDArray[np.float64]:
        """The reflectance of the ground, (81,)."""
        return np.broadcast_to(np.asarray(self.atmosphere.ground, float), WAVELENGTHS.shape)

    def seen_by(self, sensitivities: NDArray[np.float64]) -> SimulatedSky:
        """Return this sky with sensors (k, 81) in place of wavelengths; without its error."""
        once, more = (
            (table @ sensitivities.T).astype(np.float32) for table in (self.once, self.more)
        )
        error = np.full((*self.error.shape[:2], len(sensitivities)), np.nan, np.float32)
        direct = self.direct @ sensitivities.T
        return replace(self, once=once, more=more, error=error, direct=direct)

    def irradiance(self, order: str | None = None) -> NDArray[np.float64]:
        """Return the irradiance of the sky, without the sun, on level ground, (81,)."""
        # Finer than the tables, for the brightness around the sun.
        elevation, azimuth, share = nodes(96, 181)
        radiance = self.radiance(elevation[:, None], azimuth, order)
        return np.einsum("ea,eaw->w", share, radiance)

    def irradiance_error(self) -> NDArray[np.float64]:
        """Return the standard error of `irradiance`, (81,)."""
        share = nodes(*self.error.shape[:2])[2]
        return np.sqrt(np.einsum("ea,eaw->w", share**2, self.error.astype(float) ** 2))


def simulate(
    sun_elevation: float,
    atmosphere: Atmosphere | None = None,
    *,
    orders: int | None = None,
    quality: str | Quality = "preview",
    seed: int = 0,
    progress: bool = False,
    cached: bool = True,
) -> SimulatedSky:
    """Return a clear sky, from the cache where it has been simulated before.

    Parameters
    ----------
    sun_elevation
        [degrees], `LOWEST_SUN` to 90.
    atmosphere
        `Atmosphere` with its defaults where None; `PAPER` for that of the paper.
    orders
        Light scattered more often is left out, and from 1 on up also what touched the ground;
        None: all there is.
    quality
        A name from `QUALITIES`, or one's own.
    seed
        The same seed gives the same sky, however many processors there are.
    progress
        Whether to draw a bar on stderr.

    Raises
    ------
    InputError
        Elevation, orders, quality or seed out of range.
    """
    bar = Bar()

    def show(step: Progress) -> None:
        if progress:
            bar.show(step.line, step.done)

    try:
        steps = simulating(
            sun_elevation, atmosphere, orders=orders, quality=quality, seed=seed, cached=cached
        )
        return run(steps, show)
    finally:
        bar.close()


def simulating(
    sun_elevation: float,
    atmosphere: Atmosphere | None = None,
    *,
    orders: int | None = None,
    quality: str | Quality = "preview",
    seed: int = 0,
    cached: bool = True,
) -> Generator[Progress, None, SimulatedSky]:
    """Do as `simulate` does, yielding several times a second how far it is."""
    if not LOWEST_SUN <= sun_elevation <= 90.0:
        raise InputError(
            parameter("sun_elevation"), f"{sun_elevation:g}°", f"give {LOWEST_SUN:g} to 90"
        )
    if orders is not None and orders < 1:
        raise InputError(parameter("orders"), f"{orders}", "give 1 or more, or all")
    if seed < 0:
        raise InputError(parameter("seed"), f"{seed}", "give 0 or more")
    if isinstance(quality, str):
        if quality not in QUALITIES:
            raise InputError(parameter("quality"), f"'{quality}'", f"choose {listed(QUALITIES)}")
        quality = QUALITIES[quality]
    atmosphere = atmosphere or Atmosphere()
    content = {
        "sun": float(sun_elevation),
        "atmosphere": asdict(atmosphere),
        "orders": orders,
        "quality": asdict(quality),
        "seed": seed,
        "sunlight": extraterrestrial_sunlight(),
    }
    code = (Path(__file__).parent, Path(cache.__file__).parent)
    path = cache.place("sky", content, *code) if cached else None
    arrays = cache.load(path)
    if arrays is None:
        arrays = yield from _simulating(sun_elevation, atmosphere, orders, quality, seed)
        cache.save(path, arrays)
    return SimulatedSky(sun_elevation, atmosphere, **arrays)


PAPER = Atmosphere(haze=0.0, ozone=0.0, water=0.0, oxygen=False, dispersion=False, ground=0.0)
"""The air of the paper, for ``simulate(…, PAPER, orders=2)``.

We take its assumptions to be: light scattered three times or more counts for nothing (``orders``);
only molecules of air scatter and nothing absorbs (``haze``, ``ozone``, ``water``, ``oxygen``,
``ground``); they scatter in exact proportion to λ^-4 (``dispersion``). Each can be lifted alone.
"""


def _simulating(
    sun_elevation: float,
    atmosphere: Atmosphere,
    orders: int | None,
    quality: Quality,
    seed: int,
) -> Generator[Progress, None, dict[str, NDArray]]:
    sunlight = extraterrestrial_sunlight()
    sun = direction(np.radians(sun_elevation), 0.0)
    once = yield from aside(
        Progress(0.0, "sky"), scattered_once, medium(atmosphere), sun, _views(*quality.once)
    )
    once = once * sunlight
    more = np.zeros((3, *quality.more, WAVELENGTHS.size), np.float32)
    error = np.zeros((*quality.more, WAVELENGTHS.size), np.float32)
    if orders != 1:
        matter = medium(atmosphere, quality.shells)
        mean, variance = yield from _follow_all(
            matter, sun, _views(*quality.more), quality.ways, seed, orders
        )
        more[...] = (mean * sunlight).reshape(more.shape)
        error[...] = (np.sqrt(variance) * sunlight).reshape(error.shape)
    return {
        "once": once.reshape(2, *quality.once, WAVELENGTHS.size).astype(np.float32),
        "more": more,
        "error": error,
        "direct": sun_transmittance(sun_elevation, atmosphere) * sunlight,
    }


def _follow_all(
    matter: Medium,
    sun: NDArray,
    views: NDArray,
    ways: int,
    seed: int,
    last: int | None,
) -> Generator[Progress, None, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Follow the ways of all directions on all processors.

    Returns the means, (3, m, 81), without the first order, and their sum's variance, (m, 81).
    """
    together = max(1, 2048 // ways)  # directions: more ways than that leave the processor's cache

    share = _guided_share(float(sun[2]))

    def part(first: int) -> tuple[NDArray, NDArray]:
        mean, variance = np.zeros(()), np.zeros(())
        for guided, weight in ((False, 1.0 - share), (True, share)):
            if weight:
                # A stream of its own for each part: who works on it when does not matter.
                stream = np.random.SeedSequence([seed, first, 1] if guided else [seed, first])
                random = np.random.Generator(np.random.PCG64(stream))
                several = views[first : first + together]
                found, square = follow(matter, sun, several, ways, random, last, guided)
                found = found[1:]
                spread = np.maximum(square - found.sum(axis=0) ** 2, 0.0)
                mean, variance = mean + weight * found, variance + weight**2 * spread
        return mean, variance / max(ways - 1, 1)

    starts = range(0, len(views), together)
    workers = os.cpu_count() or 1
    done: list[tuple[NDArray, NDArray]] = []
    with ThreadPoolExecutor(workers) as pool:
        for k in range(0, len(starts), workers):
            step = Progress(len(done) / len(starts), "sky")
            done += yield from aside(step, list, pool.map(part, starts[k : k + workers]))
            yield step
    means, variances = zip(*done, strict=True)
    return np.concatenate(means, axis=1), np.concatenate(variances)


GUIDED_UNDER, UNGUIDED_OVER = 0.03, 0.06
"""Sines of the sun's elevation under which most air is in shadow, and ways seek the light, and over
which they do not; between the two both kinds of ways are followed, so that their noise changes
gradually and a film of a rising sun does not flicker."""


def _guided_share(height: float) -> float:
    """What guided ways count for, from 0 to 1, under a sun of this sine of elevation."""
    s = min(max((UNGUIDED_OVER - height) / (UNGUIDED_OVER - GUIDED_UNDER), 0.0), 1.0)
    return s * s * (3.0 - 2.0 * s)


def row_elevations(rows: int) -> NDArray[np.float64]:
    """Return where a table's rows look, (rows,) [rad]: closer together near the horizon."""
    return np.pi / 2 * ((np.arange(rows) + 0.5) / rows) ** 2


def nodes(rows: int, columns: int) -> tuple[NDArray, NDArray, NDArray]:
    """Return elevations, azimuths and what each pair counts in an irradiance (rows, columns)."""
    place = (np.arange(rows) + 0.5) / rows
    elevation = row_elevations(rows)
    height = np.sin(elevation) * np.cos(elevation) * np.pi * place / rows
    width = np.full(columns, 2 * np.pi / (columns - 1))  # both halves of the sky
    width[[0, -1]] /= 2
    return elevation, np.linspace(0.0, np.pi, columns), height[:, None] * width


def _views(rows: int, columns: int) -> NDArray[np.float64]:
    """Return a table's directions with the sun over +x, (rows columns, 3)."""
    elevation, azimuth, _ = nodes(rows, columns)
    return direction(elevation[:, None], azimuth).reshape(-1, 3)


def _interpolate(table: NDArray, elevation: NDArray, from_sun: NDArray) -> NDArray[np.float64]:
    """Read a table (rows, columns, k) between its nodes, (..., k).

    Of a grid, elevations (m, 1) and azimuths (n,), its rows are read first and then its columns.
    """
    rows, columns = table.shape[:2]
    place = np.sqrt(np.clip(elevation / (np.pi / 2), 0.0, 1.0))
    row = np.clip(place * rows - 0.5, 0.0, rows - 1.000001)[..., None]
    column = np.clip(from_sun / np.pi * (columns - 1), 0.0, columns - 1.000001)[..., None]
    i, j = row[..., 0].astype(int), column[..., 0].astype(int)
    v, u = row - i[..., None], column - j[..., None]
    if elevation.ndim == 2 and elevation.shape[1] == 1 and from_sun.ndim == 1:
        level = (1 - v) * table[i[:, 0]] + v * table[i[:, 0] + 1]
        return (1 - u) * level.take(j, axis=1) + u * level.take(j + 1, axis=1)
    lower = (1 - u) * table[i, j] + u * table[i, j + 1]
    upper = (1 - u) * table[i + 1, j] + u * table[i + 1, j + 1]
    return (1 - v) * lower + v * upper
