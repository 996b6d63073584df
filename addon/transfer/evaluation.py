"""Every method's error under given light: the bases, today's way, and the limit of any 3x3.

Light is known here as a spectrum, so the true colour of a material under it is known too. A method
sees only the light's three numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..spectra.grid import resample
from ..spectra.sensitivities import observer
from ..spectra.working_spaces import DEFAULT_SPACE, rec709_to_working
from .matrices import transfer
from .measures import delta_E, relative_error
from .prediction import rgb_albedo

TODAY = {f"RGB × RGB in {space.split()[-1]}": space for space in (DEFAULT_SPACE, "Linear Rec.2020")}
"""Today's way by the space that it multiplies in: two marks to beat."""

BEST = "best 3x3"
"""The other mark: for each material the one matrix that least squares finds for this very light."""


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


def colorchecker() -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return names and reflectances (24, 81) of the ColorChecker, patch 1 first.

    The BabelColor average of 30 charts, from colour-science.
    """
    from colour.characterisation import SDS_COLOURCHECKERS

    patches = SDS_COLOURCHECKERS["BabelColor Average"]
    values = np.stack([resample(sd.wavelengths, sd.values) for sd in patches.values()])
    return tuple(patches), np.clip(values, 0.0, 1.0)


def evaluate(
    lights: ArrayLike,
    reflectances: ArrayLike,
    bases: Sequence[str] = ("rayleigh", "daylight", "atmosphere"),
    *,
    sun_elevation: ArrayLike | None = None,
    camera: str | None = None,
) -> list[Errors]:
    """Return the errors of every method over all lights and materials.

    Today's way comes first, then the bases, then the best 3x3. `atmosphere` is there as far as it
    can be told more: nothing, each light's own colour, each light's sun elevation.

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
    S = observer()
    lights = np.atleast_2d(lights).astype(float)
    luminance = (lights @ S.T) @ _LUMINANCE
    if np.any(luminance <= 0):
        raise InputError("daylight", "a spectrum holds no light", "leave it out")
    lights = lights / luminance[:, None]
    rho = np.atleast_2d(reflectances)
    white = lights @ S.T
    true = np.einsum("il,ml,kl->kmi", S, rho, lights, optimize=True)
    seen = lights @ transfer(camera=camera).S_in.T

    def errors(method: str, estimate: NDArray) -> Errors:
        return Errors(
            method,
            delta_E(estimate, true, white[:, None]),
            relative_error(estimate, true),
        )

    result = []
    for method, space in TODAY.items():
        to_space = rec709_to_working(space).T
        product = rgb_albedo(rho, space) * (white @ to_space)[:, None]
        result.append(errors(method, product @ np.linalg.inv(to_space)))
    for basis in bases:
        M = transfer(basis, camera=camera).matrices(rho)
        kind, _, file = basis.partition(" ")
        short = f"{kind} {Path(file).name}" if file else basis
        result.append(errors(short, np.einsum("mij,kj->kmi", M, seen)))
        if basis != "atmosphere":
            continue
        told: list[tuple[str, Any]] = [("colour known", [{"sky_rgb": rgb} for rgb in seen])]
        if sun_elevation is not None:
            elevations = _one_each(sun_elevation, len(lights))
            told.append(("elevation known", [{"sun_elevation": float(e)} for e in elevations]))
        for what, each in told:
            matrices = np.stack(
                [transfer(basis, camera=camera, **known).matrices(rho) for known in each]
            )
            result.append(errors(f"{basis}, {what}", np.einsum("kmij,kj->kmi", matrices, seen)))
    fitted, *_ = np.linalg.lstsq(seen, true.reshape(len(seen), -1), rcond=None)
    result.append(errors(BEST, (seen @ fitted).reshape(true.shape)))
    return result


def _one_each(sun_elevation: ArrayLike, count: int) -> NDArray[np.float64]:
    elevations = np.ravel(np.asarray(sun_elevation, dtype=float))
    if elevations.size not in (1, count):
        raise InputError(
            "--sun-elevation",
            f"{elevations.size} elevations for {count} spectra",
            "give one for all or one for each",
        )
    return np.broadcast_to(elevations, count)


def _statistics(values: NDArray[np.float64]) -> dict[str, float]:
    return {
        "mean": float(values.mean()),
        "p95": float(np.percentile(values, 95)),
        "max": float(values.max()),
    }


_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
