"""What the command `evaluate` writes: figures, tables and a summary ready for JSON."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..sky.atmosphere import Atmosphere
from ..sky.simulation import PAPER
from ..spectra.bases import basis, restoration
from ..spectra.grid import WAVELENGTHS
from ..spectra.light import Light
from ..spectra.sensitivities import observer
from ..whole_files import writing
from . import charts
from .day import FACE_NAMES, Day, simulate_day
from .evaluation import TODAY, Errors, evaluate

AIRS: dict[str, dict[str, Any]] = {
    "the paper's assumptions": {"atmosphere": PAPER, "orders": 2},
    "full atmosphere": {"atmosphere": Atmosphere()},
}
"""The skies to test the paper under, its own and one with all in it, as settings of `simulate`."""

HIGH_SUN = 30.0
"""[degrees]. Over it the paper's "high sun"."""


def report_day(
    out: Path,
    place: tuple[str, float, float, str],
    materials: tuple[Sequence[str], NDArray[np.float64]],
    bases: Sequence[str],
    *,
    step: int = 30,
    progress: bool = False,
) -> dict[str, Any]:
    """Evaluate a clear day as the paper does, under its own sky and a full one, into a folder.

    ``place``: date, latitude, longitude and zone as in `sun_position`; ``materials``: names and
    reflectances (m, 81), of which the first is Figure 2's. Writes figure1, figure2 and a table for
    each sky, as PNG, SVG and CSV, and returns the summary.
    """
    names, rho = materials
    out.mkdir(parents=True, exist_ok=True)
    files = figure1(out, bases)
    days: dict[str, tuple[Day, list[Errors]]] = {}
    skies = {}
    for air, settings in AIRS.items():
        day = simulate_day(*place, step=step, progress=progress, **settings)
        elevations = np.repeat(day.elevations, len(FACE_NAMES))
        errors = evaluate(
            day.light.reshape(-1, WAVELENGTHS.size), rho, bases, sun_elevation=elevations
        )
        days[air] = day, errors
        stem = out / ("table_paper" if settings["atmosphere"] is PAPER else "table_full")
        files += charts.table(stem, names, _shown(errors), f"Mean relative error. Sky: {air}")
        files.append(_write_table(stem.with_suffix(".csv"), day, names, errors))
        skies[air] = {
            "hours": day.hours.tolist(),
            "sun_elevations": day.elevations.tolist(),
            "methods": [method.summary() for method in errors],
            "claims": claims(day, errors, rho),
        }
    files += charts.error_over_day(out / "figure2", days)
    files.append(_write_figure2(out / "figure2.csv", days))
    return {"skies": skies, "files": [str(path) for path in files]}


def figure1(out: Path, bases: Sequence[str]) -> list[Path]:
    """Draw and write the bases as the spectra that they give to red, green and blue."""
    S = observer()
    functions = {name: restoration(basis(name, S), S) for name in bases}
    if "atmosphere" in bases:
        low = basis("atmosphere", S, sun_elevation=0.0)
        functions["atmosphere, sun at 0°"] = restoration(low, S)
    header = ["wavelength_nm", *(f"{name} s_{c}" for name in functions for c in "rgb")]
    rows = np.column_stack([WAVELENGTHS, *functions.values()])
    return [
        *charts.basis_functions(out / "figure1", functions),
        write_csv(out / "figure1.csv", header, rows.tolist()),
    ]


def claims(day: Day, errors: Sequence[Errors], rho: NDArray[np.float64]) -> dict[str, Any]:
    """Return the figures that the paper's claims are about, for its own basis.

    Largest relative error of the first material on a face that looks up from 12:00 to 16:00 (the
    paper: under 0.01); mean errors by high and by low sun and by horizontal and vertical faces
    (smaller in the first of each); how often smaller than RGB × RGB in Rec.709 the mean error of
    each material is, over materials whose reflectance depends on wavelength (10 to 100 times).
    """
    by_name = {method.method: charts.by_face(method) for method in errors}
    if "rayleigh" not in by_name:
        return {}
    ours, today = by_name["rayleigh"], by_name[next(iter(TODAY))]
    afternoon = (day.hours >= 12.0) & (day.hours <= 16.0)
    high = day.elevations > HIGH_SUN
    # White, greys and black: there RGB × RGB is right too.
    coloured = np.ptp(rho, axis=1) > 0.1
    gain = today.mean(axis=(0, 1))[coloured] / ours.mean(axis=(0, 1))[coloured]

    def mean(values: NDArray[np.float64]) -> float | None:
        return float(values.mean()) if values.size else None

    return {
        "first_material_up_12_to_16_max": float(ours[afternoon, 0, 0].max(initial=0.0)),
        "mean_high_sun": mean(ours[high]),
        "mean_low_sun": mean(ours[~high]),
        "mean_face_up": mean(ours[:, 0]),
        "mean_faces_vertical": mean(ours[:, 5:]),
        "times_smaller_than_rgb": {
            "least": float(gain.min(initial=np.inf)),
            "median": float(np.median(gain)),
            "most": float(gain.max(initial=0.0)),
        }
        if gain.size
        else None,
    }


def report_light(
    out: Path,
    light: Light,
    rho: NDArray[np.float64],
    bases: Sequence[str],
    **known: Any,
) -> dict[str, Any]:
    """Evaluate measured light into a folder: a figure, a CSV of all methods, and the summary.

    ``known``: elevations and camera as `evaluate` has them.
    """
    out.mkdir(parents=True, exist_ok=True)
    errors = evaluate(light.values, rho, bases, **known)
    summaries = [method.summary() for method in errors]
    header = ["method", *(f"{m} {s}" for m in _MEASURES for s in ("mean", "p95", "max"))]
    rows = [
        [summary["method"], *(summary[m][s] for m in _MEASURES for s in ("mean", "p95", "max"))]
        for summary in summaries
    ]
    title = f"{light.path.stem}: {len(light.values)} spectra, {len(rho)} materials"
    files = [
        *charts.distribution(out / "daylight", errors, title),
        write_csv(out / "daylight.csv", header, rows),
    ]
    return {
        "daylight": str(light.path),
        "spectra": len(light.values),
        "materials": len(rho),
        "methods": summaries,
        "files": [str(path) for path in files],
    }


_MEASURES = ("delta_E", "relative_error")


def _shown(errors: Sequence[Errors]) -> list[Errors]:
    """Return the methods that a page has room for: today's way, the paper's, and the best told."""
    last = [e for e in errors if e.method.startswith("atmosphere")][-1:]
    return [e for e in errors if e.method in (next(iter(TODAY)), "rayleigh")] + last


def _write_table(path: Path, day: Day, names: Sequence[str], errors: Sequence[Errors]) -> Path:
    header = [
        "hour",
        "sun_elevation",
        "face",
        "material",
        *(f"{e.method}: {measure}" for e in errors for measure in _MEASURES),
    ]
    values = np.stack([part for e in errors for part in (e.delta_E, e.relative)], axis=-1).reshape(
        len(day.hours), len(FACE_NAMES), len(names), -1
    )
    rows = (
        [f"{day.hours[t]:.4g}", f"{day.elevations[t]:.3f}", face, name, *values[t, f, m]]
        for t in range(len(day.hours))
        for f, face in enumerate(FACE_NAMES)
        for m, name in enumerate(names)
    )
    return write_csv(path, header, rows)


def _write_figure2(path: Path, days: dict[str, tuple[Day, list[Errors]]]) -> Path:
    header, rows = ["sky", "hour", "sun_elevation"], []
    for air, (day, errors) in days.items():
        header[3:] = [method.method for method in errors]
        first = np.stack([charts.by_face(method)[:, 0, 0] for method in errors], axis=-1)
        for hour, elevation, values in zip(day.hours, day.elevations, first, strict=True):
            rows.append([air, f"{hour:.4g}", f"{elevation:.3f}", *values])
    return write_csv(path, header, rows)


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[Any]]) -> Path:
    """Write a table, floats to six digits, and return its path."""
    with (
        writing(path) as part,
        part.open("w", newline="", encoding="utf-8", errors="backslashreplace") as handle,
    ):
        writer = csv.writer(handle)
        writer.writerow(header)
        for row in rows:
            writer.writerow([f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row])
    return path
