"""Accuracy against speed: every method measured alike, as rows of one table.

Where materials are compared the light is exact, and where ways to hold the light are compared the
materials are: each row shows its own error alone, over skies, faces and materials.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm import tqdm

from ..sky.atmosphere import Atmosphere
from ..sky.clear_sky import picture
from ..sky.simulation import simulate
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import LUMINANCE
from ..transfer.measures import delta_E, relative_error
from .day import ROWS, face_weights
from .evaluation import Errors, errors_of, of_one_luminance
from .light_methods import LIGHT_METHODS, LightMethod
from .light_places import PLACES, SkyPicture
from .methods import METHODS, Method, Sky, true_colours, with_basis
from .one_light import cases, ways
from .speed import nanoseconds

ELEVATIONS = (-4.0, 0.0, 5.0, 15.0, 30.0, 60.0)
"""Of the sun [degrees], unless others are asked for."""

AIRS = {
    "clear": Atmosphere(),
    "hazy": Atmosphere(haze=0.3, ozone=380.0, water=30.0, ground=0.1),
}
"""The air of the skies: each elevation under each."""

_MANY = 2048
"""Materials that set-up is timed with."""


@dataclass(frozen=True)
class Row:
    """What was found of one method.

    ``kind``: "material", "light" (in the open), "walls" (light in a street), or materials in light
    of one spectrum: "sun", "ground", "glass" or "lamp". ``told``: as
    `methods.Method` has it. ``nanoseconds`` a pixel, least and median; ``setup`` [s] of one more
    material, or of one more sky; ``state_bytes``, ``pixel_bytes``: what a material (or the World)
    and a pixel hold, as float32.
    """

    kind: str
    name: str
    family: str
    told: tuple[str, ...]
    errors: Errors
    nanoseconds: tuple[float, float]
    setup: float
    state_bytes: int
    pixel_bytes: int

    @property
    def is_limit(self) -> bool:
        """Whether it was fitted to the truth, and so is not to be had."""
        return "truth" in self.told

    @property
    def needs_more(self) -> bool:
        """Whether a colour alone, as an HDRI has it, is not enough for it."""
        return self.kind == "material" and ("spectrum" in self.told or self.pixel_bytes > 12)

    def record(self) -> dict[str, Any]:
        """Return all figures by name, ready for CSV and JSON; times in ns and µs."""
        errors = self.errors.summary()
        return {
            "kind": self.kind,
            "method": self.name,
            "family": self.family,
            "told": " and ".join(self.told),
            **{f"{s}_delta_E": value for s, value in errors["delta_E"].items()},
            **{f"{s}_relative_error": value for s, value in errors["relative_error"].items()},
            "ns_per_pixel": self.nanoseconds[0],
            "median_ns_per_pixel": self.nanoseconds[1],
            "setup_us": 1e6 * self.setup,
            "state_bytes": self.state_bytes,
            "pixel_bytes": self.pixel_bytes,
        }


@dataclass(frozen=True)
class FullSky:
    """A simulated sky: spectra of its light on `FACES`, and its picture, without the sun's disc.

    Of such size that level ground gets luminance 1. ``sun`` (81,): what the disc gives that ground.
    """

    sky: Sky
    dome: SkyPicture
    sun: NDArray[np.float64]


def full_skies(elevations: Iterable[float], progress: bool = False) -> list[FullSky]:
    """Simulate a sky for each of `AIRS` at each sun elevation [degrees], as `simulate` does."""
    weights, result = face_weights(), []
    wanted = [(elevation, air) for elevation in elevations for air in AIRS.values()]
    for elevation, air in tqdm(wanted, desc="skies", disable=not progress):
        # Sun in the south-south-west: no two sides of a building are alike.
        simulated = simulate(elevation, air)
        spectral = picture(simulated, ROWS, 200.0).astype(float)
        lights = weights @ spectral.reshape(-1, spectral.shape[-1])
        size = LUMINANCE @ observer() @ lights[0]
        dome = SkyPicture(spectral @ observer().T / size)
        sun = simulated.direct * max(np.sin(np.radians(elevation)), 0.0) / size
        result.append(FullSky(Sky(lights / size, elevation), dome, sun))
    return result


def measured_skies(spectra: ArrayLike, sun_elevation: float | None = None) -> list[Sky]:
    """Return measured light (k, 81) as skies of one spectrum each, of one luminance.

    Raises `InputError` as `of_one_luminance` does.
    """
    return [Sky(light[None], sun_elevation) for light in of_one_luminance(spectra)]


def rows(
    skies: list[FullSky],
    rho: NDArray[np.float64],
    *,
    rounds: int = 15,
    methods: Mapping[str, Method] = METHODS,
    light_methods: Mapping[str, LightMethod] = LIGHT_METHODS,
    measured: list[Sky] | None = None,
    progress: bool = False,
) -> list[Row]:
    """Return a row for each method, over all skies and reflectances rho (m, 81).

    ``measured``: what ways to shade materials are compared in instead of the skies' own light;
    those that need the sun's elevation are left out where it has none.
    """
    compared = [one.sky for one in skies] if measured is None else measured
    if any(sky.sun_elevation is None for sky in compared):
        methods = {n: method for n, method in methods.items() if "elevation" not in method.told}
    known = cases((one.sky, one.sun) for one in skies)
    total = len(methods) + len(light_methods) + 1 + sum(len(ways(kind)) for kind in known)
    with tqdm(total=total, disable=not progress) as bar:
        result = []
        for some in (
            material_rows("material", compared, rho, methods, rounds),
            light_rows("light", skies, rho, light_methods, rounds),
            light_rows("walls", skies, rho, light_methods, rounds),
            *(material_rows(kind, some, rho, ways(kind), rounds) for kind, some in known.items()),
        ):
            for row in some:
                result.append(row)
                bar.set_description(row.kind)
                bar.update()
    return result


def material_rows(
    kind: str,
    known: list[Sky],
    rho: NDArray[np.float64],
    methods: Mapping[str, Method],
    rounds: int,
) -> Iterator[Row]:
    """Yield the rows of ways to shade materials: pixels of one, as a draw call has them."""
    ready = {name: method.prepare(known[0], rho[:1]) for name, method in methods.items()}
    rng = np.random.default_rng(0)
    tasks = {
        name: (one.shade, one.state[0], rng.uniform(0.1, 1.0, (len(one.channels), 64)))
        for name, one in ready.items()
    }
    speed = nanoseconds(tasks, rounds)
    for (name, method), errors in zip(
        methods.items(), errors_of(methods.values(), known, rho), strict=True
    ):
        yield Row(
            kind,
            name,
            method.family,
            method.told,
            errors,
            speed[name],
            _setup(method, known[0], rho),
            4 * ready[name].state[0].size,
            4 * len(ready[name].channels),
        )


def light_rows(
    kind: str,
    skies: list[FullSky],
    rho: NDArray[np.float64],
    methods: Mapping[str, LightMethod],
    rounds: int,
) -> Iterator[Row]:
    """Yield the rows of ways to hold light: "light" in the open, or "walls".

    Those that know walls are tried between them, beside degree 4 that does not: what walls mean.
    """
    place = PLACES["street" if kind == "walls" else "open"]
    chosen = {
        name if method.knows_walls == (kind == "walls") else f"{name}, walls ignored": method
        for name, method in methods.items()
        if method.knows_walls == (kind == "walls") or (kind, name) == ("walls", "degree 4")
    }
    first = {name: method.prepare(skies[0].dome, place) for name, method in chosen.items()}
    tasks = {name: (one.shade, one.state, one.pixels) for name, one in first.items()}
    speed = nanoseconds(tasks, rounds)
    # The same matrices on both sides: hardly anything of the light's error is theirs.
    exact = [with_basis("atmosphere", "elevation").prepare(one.sky, rho) for one in skies]
    for name, method in chosen.items():
        start = time.perf_counter()
        method.prepare(SkyPicture(skies[0].dome.rgb), place)  # a new one, of which nothing is kept
        setup = time.perf_counter() - start
        held = [method.prepare(one.dome, place) for one in skies]
        parts = []
        for one, light, matrices in zip(skies, held, exact, strict=True):
            white = place.irradiance(one.dome).T
            seen = light.shade(light.state, light.pixels)
            colours = (np.moveaxis(matrices.state @ each, -1, 0) for each in (seen, white))
            parts.append((*colours, white.T))
        yield Row(
            kind,
            name,
            "light",
            (),
            _errors(name, parts),
            speed[name],
            setup,
            4 * first[name].state.size,
            4 * len(first[name].pixels),
        )


def whole(
    light: LightMethod, method: Method, skies: list[FullSky], rho: NDArray[np.float64]
) -> Errors:
    """Return the errors of light and material together, in the open, against full spectra.

    ``method`` is one whose channels are mixtures of RGB.
    """
    parts = []
    for one in skies:
        held = light.prepare(one.dome, PLACES["open"])
        prepared = method.prepare(one.sky, rho)
        to_channels = prepared.channels @ np.linalg.pinv(observer())
        pixels = to_channels @ held.shade(held.state, held.pixels)
        colours = prepared.to_rec709 @ prepared.shade(prepared.state, pixels)
        white = one.sky.lights @ observer().T
        parts.append((np.moveaxis(colours, -1, 0), true_colours(one.sky.lights, rho), white))
    return _errors(f"{light.name}; {method.name}", parts)


def front(some: Iterable[Row]) -> list[Row]:
    """Return those that none beats in both mean error and speed, fastest first; no limits.

    To be faster is to take less than four fifths: closer calls are the clock's.
    """
    best: list[Row] = []
    for row in sorted(some, key=lambda row: (row.errors.delta_E.mean(), row.nanoseconds[0])):
        if row.is_limit:
            continue
        if not best or row.nanoseconds[0] < 0.8 * best[-1].nanoseconds[0]:
            best.append(row)
    return best[::-1]


def _errors(name: str, parts: list[tuple[NDArray, NDArray, NDArray]]) -> Errors:
    """Join estimated and true colours (k, m, 3) and whites (k, 3) of several skies."""
    seen, true, white = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Errors(name, delta_E(seen, true, white[:, None]), relative_error(seen, true))


def _setup(method: Method, sky: Sky, rho: NDArray[np.float64]) -> float:
    """Return the time [s] that one of many materials takes to make ready, the sky's share apart."""
    many = np.resize(rho, (_MANY, rho.shape[1]))
    best = {}
    for count in (1, _MANY):
        times = []
        for _ in range(3):
            start = time.perf_counter()
            method.prepare(sky, many[:count])
            times.append(time.perf_counter() - start)
        best[count] = min(times)
    return max(best[_MANY] - best[1], 0.0) / (_MANY - 1)
