"""Every method's error under given light: the bases, today's way, and the limit of any 3x3.

Light is known here as a spectrum, so the true colour of a material under it is known too. A method
sees only the light's three numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..choices import BASES
from ..errors import InputError, parameter
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import LUMINANCE
from ..transfer.measures import delta_E, relative_error
from .methods import BEST, METHODS, TODAY, Method, Sky, estimate, true_colours, with_basis


@dataclass(frozen=True)
class Errors:
    """One method's errors, of each material under each light: ``delta_E``, ``relative`` (k, m).

    Relative errors are those of linear Rec.709; both measures as in `measures`.
    """

    method: str
    delta_E: NDArray[np.float64]
    relative: NDArray[np.float64]

    def summary(self) -> dict[str, Any]:
        """Return mean, 95th percentile and maximum of both measures, ready for JSON."""
        return {
            "method": self.method,
            "delta_E": _statistics(self.delta_E),
            "relative_error": _statistics(self.relative),
        }


def evaluate(
    lights: ArrayLike,
    reflectances: ArrayLike,
    bases: Sequence[str] = tuple(BASES),
    *,
    sun_elevation: ArrayLike | None = None,
    camera: str | None = None,
) -> list[Errors]:
    """Return the errors of every method over all lights and materials.

    Today's way comes first, then the bases, then the best 3x3. `atmosphere` is there as far as it
    can be told more: nothing, each light's own colour, each light's sun elevation, both.

    Parameters
    ----------
    lights
        Spectra, (k, 81). Only their shapes count: each is brought to the same luminance.
    reflectances
        (m, 81) on the grid.
    bases
        Names that `bases.basis` understands.
    sun_elevation
        [degrees], of all lights or of each, (k,).
    camera
        What takes the light's three numbers: as `sensitivities.camera`; the observer where None.

    Raises
    ------
    InputError
        As `transfer` does; elevations that are neither one nor k; light without luminance.
    """
    lights = of_one_luminance(lights)
    # Each light is a sky of its own: what a method is told, it is told of that light.
    elevations = one_each(sun_elevation, len(lights))
    skies = [Sky(light[None], e, camera) for light, e in zip(lights, elevations, strict=True)]
    methods = [METHODS[name] for name in TODAY]
    for basis in bases:
        methods.append(with_basis(basis))
        if basis == "atmosphere":
            methods.append(with_basis(basis, "colour"))
            if sun_elevation is not None:
                methods.append(with_basis(basis, "elevation"))
                methods.append(with_basis(basis, "colour", "elevation"))
    methods.append(METHODS[BEST])
    return list(errors_of(methods, skies, np.atleast_2d(reflectances).astype(float)))


def errors_of(
    methods: Iterable[Method], skies: list[Sky], rho: NDArray[np.float64]
) -> Iterator[Errors]:
    """Yield each method's errors over the lights of all skies and reflectances (m, 81)."""
    lights = np.concatenate([sky.lights for sky in skies])
    white = (lights @ observer().T)[:, None]
    true = true_colours(lights, rho)
    for method in methods:
        colours = estimate(method, skies, rho)
        errors = delta_E(colours, true, white), relative_error(colours, true)
        yield Errors(method.name, *errors)


def of_one_luminance(lights: ArrayLike) -> NDArray[np.float64]:
    """Return spectra (k, 81), each over its luminance. Raises `InputError` where one has none."""
    lights = np.atleast_2d(np.asarray(lights, dtype=float))
    luminance = lights @ observer().T @ LUMINANCE
    if np.any(luminance <= 0):
        raise InputError("daylight", "a spectrum holds no light", "leave it out")
    return lights / luminance[:, None]


def one_each(sun_elevation: ArrayLike | None, count: int) -> list[float] | list[None]:
    """Return an elevation for each of ``count`` lights, from one for all or from as many.

    Raises `InputError` for another number of them.
    """
    if sun_elevation is None:
        return [None] * count
    elevations = np.ravel(np.asarray(sun_elevation, dtype=float))
    if elevations.size not in (1, count):
        raise InputError(
            parameter("sun_elevation"),
            f"{elevations.size} elevations for {count} spectra",
            "give one for all or one for each",
        )
    return np.broadcast_to(elevations, count).tolist()


def _statistics(values: NDArray[np.float64]) -> dict[str, float]:
    return {
        "mean": float(values.mean()),
        "p95": float(np.percentile(values, 95)),
        "max": float(values.max()),
    }
