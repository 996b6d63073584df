"""Our simulated sky beside the peers': tables and a picture.

python -m spectral_skylight.tests.peers.skies FOLDER
"""

from __future__ import annotations

import csv
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spectral_skylight.addon.evaluation.evaluation import evaluate
from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight
from spectral_skylight.tests.peers import differences
from spectral_skylight.tests.peers.conditions import (
    CONDITIONS,
    GROUND,
    SUN_ELEVATIONS,
    Condition,
    away_from_sun,
    directions,
)
from spectral_skylight.tests.peers.peer import ask
from spectral_skylight.tests.peers.pictures import draw_skies

QUALITY = Quality(once=(48, 19), more=(16, 13), ways=256, shells=30)
"""Some seconds a sky. Two seeds differ by 0.002 to 0.003 in mean u'v', 1.5 to 2.5 % in shape, 4 %
in luminance scatter and CIEDE2000 0.15 to 0.25: small beside what the peers differ by."""

BANDS = np.arange(410.0, 691.0, 20.0)
"""Middles [nm] of the bands in which shapes are compared: where all peers have data, and so broad
that Fraunhofer lines, which none of them resolves, even out."""


BESIDE = ("mitsuba T=2", "radiance d=0.115")
"""The peers' own skies that are set beside one another: of about the same haze, 0.10."""


@dataclass(frozen=True)
class Row:
    """One peer's sky beside another at one sun elevation. Means and worst over its directions.

    ``beside``: ours with the air that is in the peer's (alike), with all that is in ours by default
    (full), or another peer's.
    """

    peer: str
    beside: str
    sun_elevation: float
    duv_mean: float
    duv_max: float
    shape_mean: float
    shape_max: float
    luminance_ratio: float
    luminance_scatter: float
    delta_E_mean: float
    delta_E_p95: float


@dataclass(frozen=True)
class Error:
    """A method's mean and 95th percentile of CIEDE2000 under one sky: theirs or ours."""

    peer: str
    sky: str
    sun_elevation: float
    method: str
    delta_E_mean: float
    delta_E_p95: float


def theirs(condition: Condition) -> NDArray[np.float64]:
    """Return a peer's radiance on our grid, (suns, 64, 81), from where it has data.

    Twenty bands become 81 as their ratio to sunlight, which is smooth. Where data end, the last
    ratio to sunlight is held: above 720 nm that counts for less than 0.1 % of a colour.
    """
    request = {
        "sun_elevations": SUN_ELEVATIONS,
        "directions": directions().tolist(),
        "wavelengths": WAVELENGTHS[WAVELENGTHS <= 720.0].tolist(),
        "ground": GROUND,
        **condition.settings,
    }
    answer = ask(condition.script, request)
    at = answer["wavelengths"]
    sun = extraterrestrial_sunlight()
    own_sun = in_bands(sun, at) if at.size == 20 else np.interp(at, WAVELENGTHS, sun)
    ratio = answer["radiance"] / own_sun
    held = np.clip(WAVELENGTHS, at[0], at[-1])
    smooth = [np.interp(held, at, values) for values in ratio.reshape(-1, at.size)]
    return (np.array(smooth) * sun).reshape(*ratio.shape[:2], WAVELENGTHS.size)


def ours(sun_elevation: float, air: Atmosphere) -> NDArray[np.float64]:
    """Return our radiance in the same directions, (64, 81)."""
    return simulate(sun_elevation, air, quality=QUALITY).radiance(*directions())


def in_bands(spectra: NDArray, middles: NDArray = BANDS) -> NDArray[np.float64]:
    """Return the means of spectra (..., 81) over bands 20 nm wide, (..., b)."""
    within = np.abs(WAVELENGTHS - np.asarray(middles)[:, None]) <= 10.0
    weights = within * np.where(np.abs(WAVELENGTHS - middles[:, None]) == 10.0, 0.5, 1.0)
    return spectra @ (weights / weights.sum(axis=1, keepdims=True)).T


def compare() -> tuple[list[Row], list[Error]]:
    """Return all comparisons; needs the peers' environment."""
    rows, errors, skies = [], [], {}
    for condition in CONDITIONS:
        skies[condition.name] = theirs(condition)
        for sun, spectra in zip(SUN_ELEVATIONS, skies[condition.name], strict=True):
            seen = away_from_sun(sun)
            errors += _errors(condition.name, "theirs", sun, spectra[seen])
            for name, air in (("ours alike", condition.air), ("ours full", condition.full)):
                own = ours(sun, air)[seen]
                rows.append(_row(condition.name, name, sun, own, spectra[seen]))
                errors += _errors(condition.name, name, sun, own)
    one, other = BESIDE
    for sun, *pair in zip(SUN_ELEVATIONS, skies[other], skies[one], strict=True):
        rows.append(_row(one, other, sun, *(spectra[away_from_sun(sun)] for spectra in pair)))
    return rows, errors


def _row(peer: str, beside: str, sun: float, own: NDArray, other: NDArray) -> Row:
    duv = differences.chromaticity(own, other)
    shape = differences.shape(in_bands(own), in_bands(other))
    delta_E = differences.surface_colours(own, other)
    return Row(
        peer,
        beside,
        sun,
        float(duv.mean()),
        float(duv.max()),
        float(shape.mean()),
        float(shape.max()),
        *differences.luminance(own, other),
        float(delta_E.mean()),
        float(np.percentile(delta_E, 95)),
    )


def _errors(peer: str, sky: str, sun: float, spectra: NDArray) -> list[Error]:
    _, rho = colorchecker()
    found = [one.summary() for one in evaluate(spectra, rho, ("rayleigh",))]
    return [
        Error(peer, sky, sun, one["method"], one["delta_E"]["mean"], one["delta_E"]["p95"])
        for one in found
    ]


def write(path: Path, records: list) -> None:
    """Write dataclasses as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, asdict(records[0]))
        table.writeheader()
        for record in records:
            values = asdict(record).items()
            table.writerow({k: f"{v:.4g}" if isinstance(v, float) else v for k, v in values})


def main(folder: Path) -> None:
    """Write skies.csv, methods.csv and skies.png; print the first."""
    folder.mkdir(parents=True, exist_ok=True)
    rows, errors = compare()
    write(folder / "skies.csv", rows)
    write(folder / "methods.csv", errors)
    print((folder / "skies.csv").read_text())
    spectra = {
        condition.name: {
            "theirs": in_bands(theirs(condition)).mean(axis=1),
            "ours alike": _means(condition.air),
            "ours full": _means(condition.full),
        }
        for condition in CONDITIONS
    }
    draw_skies(folder / "skies.png", BANDS, spectra, rows)


def _means(air: Atmosphere) -> NDArray[np.float64]:
    return np.stack([in_bands(ours(sun, air)).mean(axis=0) for sun in SUN_ELEVATIONS])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
