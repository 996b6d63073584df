"""What the command `chart` writes: picture, tables and a summary ready for JSON."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .chart import AIRS, FullSky, Row, front, whole
from .chart_picture import draw
from .charts import in_words
from .day import FACE_NAMES
from .evaluation import Errors
from .light_methods import LIGHT_METHODS
from .methods import METHODS
from .one_light import GLASSES, GROUNDS, LAMPS
from .report import write_csv

_TODAY = "RGB × RGB in Rec.709"
_IN_EEVEE = {
    "Diffuse": ("Eevee's own world light", _TODAY),
    "Principled": ("Eevee's own world light", _TODAY),
    "irradiance texture": ("texture 64 × 32", _TODAY),
    **{
        f"Skylight Surface{light}": ("degree 6", "atmosphere, colour and elevation known")
        for light in ("", ", sun", ", baked", ", dome")
    },
}
"""Which light and which shading a material in Eevee amounts to."""


def report_chart(
    out: Path,
    rows: Sequence[Row],
    skies: list[FullSky],
    rho: NDArray[np.float64],
    costs: Mapping[str, Mapping[str, float]],
    blender: str | None = None,
    measured: str = "",
) -> dict[str, Any]:
    """Write chart.png, chart.svg and chart.csv into a folder, and return the summary.

    ``costs``: of materials in Eevee by name, ``ratio`` to Diffuse first, then what else was
    measured; written as eevee.csv, with the error of light and shading together. Empty where there
    was no Blender. ``measured``: in which measured light materials were compared, empty for none.
    """
    out.mkdir(parents=True, exist_ok=True)
    records = [row.record() for row in rows]
    fronts = {
        kind: [row.name for row in front([row for row in rows if row.kind == kind])]
        for kind in dict.fromkeys(row.kind for row in rows)
    }
    for record in records:
        record["on_front"] = record["method"] in fronts[record["kind"]]
    files = [write_csv(out / "chart.csv", list(records[0]), [[*r.values()] for r in records])]
    strip, eevee = {}, []
    for name, cost in costs.items():
        errors = _in_eevee(name, skies, rho)
        strip[name] = cost["ratio"], _remark(name, errors)
        statistics = errors.summary()["delta_E"] if errors else {}
        eevee.append(
            {"material": name, **cost}
            | {f"{s}_delta_E": statistics.get(s) for s in ("mean", "p95", "max")}
        )
    if eevee:
        table = [["" if cell is None else cell for cell in r.values()] for r in eevee]
        files.append(write_csv(out / "eevee.csv", list(eevee[0]), table))
    made = {"date": date.today().isoformat(), **machine(), "blender": blender}
    files += draw(out / "chart", rows, strip, _caption(skies, rho, made, measured))
    return {
        "made": made,
        "measured": measured,
        "sun_elevations": sorted({one.sky.sun_elevation for one in skies}),
        "materials": len(rho),
        "methods": records,
        "fronts": fronts,
        "eevee": eevee,
        "files": [str(path) for path in files],
    }


def machine() -> dict[str, Any]:
    """Return what the figures were measured on: processor, cores, system and versions."""
    processor = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        lines = information.read_text(encoding="utf-8", errors="replace").splitlines()
        names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
        processor = next(names, processor)
    return {
        "processor": processor,
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "colour-science": version("colour-science"),
    }


def _in_eevee(name: str, skies: list[FullSky], rho: NDArray[np.float64]) -> Errors | None:
    if name not in _IN_EEVEE:
        return None
    light, method = _IN_EEVEE[name]
    return whole(LIGHT_METHODS[light], METHODS[method], skies, rho)


def _remark(name: str, errors: Errors | None) -> str:
    if errors is None:
        return "Does not show the sky"
    light, method = _IN_EEVEE[name]
    shading = method if method == _TODAY else f"3x3 {method}"
    return in_words(f"{light}, {shading}: mean color error {errors.delta_E.mean():.2g}")


def _caption(
    skies: list[FullSky], rho: NDArray[np.float64], made: Mapping[str, Any], measured: str
) -> list[str]:
    elevations = sorted(
        {one.sky.sun_elevation for one in skies if one.sky.sun_elevation is not None}
    )
    suns = ", ".join(f"{elevation:g}" for elevation in elevations)
    blender = f", Blender {made['blender']}" if made["blender"] else ""
    return [
        f"Compared with full spectra under {len(skies)} simulated skies (sun at {suns}°; "
        f"{' and '.join(AIRS)} air) without the sun's disc, for {len(FACE_NAMES)} faces and "
        f"{len(rho)} materials. Left: the light is exact{measured and f', {measured}'}. Right: the "
        "materials are exact.",
        "Below: light with one spectrum. The names tell what is known of it. Ground: "
        f"{', '.join(GROUNDS)}. Glass: {in_words(', '.join(GLASSES))}. Lamps: {', '.join(LAMPS)}. "
        "The time of live suns includes their sum, not their shadows.",
        "Own white and prefiltered RGB use the spectrum of the light on level ground. The basis "
        "atmosphere is made from skies of the same simulation with other air. Its name tells "
        "what is known of the sky.",
        f"{made['date']}, {made['processor']}, {made['cores']} cores, {made['system']}, "
        f"Python {made['python']}, NumPy {made['numpy']}{blender}",
    ]
