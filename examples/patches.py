"""The 24 patches in figures: rendered against reference, ours and today's way."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from geometry import CHECKER_CAMERA
from reference import pixel_means

from spectral_skylight.addon.sky.light import SkyLight
from spectral_skylight.addon.transfer.measures import delta_E, relative_error
from spectral_skylight.addon.transfer.prediction import Prediction


@dataclass(frozen=True)
class Truth:
    """A reference (h, w, 3), white surfaces in its light, and a picture's CIEDE2000 (h, w) to it.

    ``noise``: the figures of the reference's own, where it has some.
    """

    picture: np.ndarray
    white: np.ndarray
    error: Callable[[np.ndarray], np.ndarray]
    noise: dict[str, float] = field(default_factory=dict)


INSIDE = 0.35
"""Cosine to the camera from which a pixel is well inside its sphere: the edges are anti-aliased."""


def measure(
    names: tuple[str, ...],
    prediction: Prediction,
    surfaces: tuple[np.ndarray, np.ndarray],
    images: dict[str, np.ndarray],
    truth: Truth | None,
) -> list[dict]:
    """Return one record a patch: means over its pixels of colours and of errors.

    ``surfaces``: patch and normal of every ray; ``images``: rendered, ``rgb`` and ``spectral``;
    ``truth``: the reference's pictures, None under a photographed sky.
    """
    surface, normals = surfaces
    rows = []
    for k, name in enumerate(names):
        pixels = pixel_means((surface == k) & (normals @ CHECKER_CAMERA.back > INSIDE)) == 1
        row = {
            "patch": name,
            "rendered_rgb": images["spectral"][pixels].mean(axis=0).tolist(),
            "today_rgb": images["rgb"][pixels].mean(axis=0).tolist(),
            "predicted_delta_E": {
                "spectral": float(prediction.matrix[k]),
                "today": float(prediction.rgb[k]),
            }
            if prediction.known
            else None,
            "out_of_gamut": bool(prediction.out_of_gamut[k]),
        }
        if truth is not None:
            true, white = truth.picture[pixels], truth.white[pixels]
            row["reference_rgb"] = true.mean(axis=0).tolist()
            row["out_of_gamut"] = bool((true < 0).any())
            for way, kind in (("spectral", "spectral"), ("today", "rgb")):
                image = images[kind][pixels]
                row[f"delta_E_{way}"] = float(delta_E(image, true, white).mean())
                row[f"relative_error_{way}"] = float(relative_error(image, true).mean())
        rows.append(row)
    return rows


def write_report(
    out: Path, rows: list[dict], light: SkyLight, sky: str, building: dict[str, dict]
) -> list[str]:
    """Write ``report.json`` and ``report.txt``; return the sentences that sum them up.

    ``building``: mean, 95th percentile and worst CIEDE2000 of its pictures, where there is a truth.
    """
    measured = "delta_E_spectral" in rows[0]
    if not measured and rows[0]["predicted_delta_E"] is None:
        return _write_unknown(out, rows, light, sky)
    inside = [row for row in rows if not row["out_of_gamut"]]
    outside = [row["patch"] for row in rows if row["out_of_gamut"]]
    means = _means(rows, measured)
    ratio = means["delta_E_today"] / means["delta_E_spectral"]
    summary = [
        f"{'Mean' if measured else 'Predicted mean'} CIEDE2000 over 24 patches: "
        f"today {means['delta_E_today']:.2f}, spectral {means['delta_E_spectral']:.2f}, "
        f"{ratio:.1f} times less"
    ]
    if outside:
        means_inside = _means(inside, measured)
        summary.append(
            f"Out of gamut, negative components clamped by Blender: {', '.join(outside)}. "
            f"Without: {means_inside['delta_E_today']:.2f} and "
            f"{means_inside['delta_E_spectral']:.2f}, "
            f"{means_inside['delta_E_today'] / means_inside['delta_E_spectral']:.1f} times less"
        )
    report = {
        "sky": light.report(),
        "patches": rows,
        "out_of_gamut": outside,
        "means": means,
        "mean_ratio": ratio,
        "building": building,
    }
    table = [_header(measured), *(_line(row, measured) for row in rows)]
    lines = [f"Sky: {sky}", light.caption, "", *table, "", *summary]
    (out / "report.json").write_text(json.dumps(report, indent=1), encoding="utf-8")
    (out / "report.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return summary


def _write_unknown(out: Path, rows: list[dict], light: SkyLight, sky: str) -> list[str]:
    """The report of a sky that no error can be predicted of."""
    summary = ["No error can be predicted for this sky: " + light.outside.verdict]
    report = {"sky": light.report(), "patches": rows, "means": None, "mean_ratio": None}
    table = [f"{row['patch']:<22} {_rgb(row['rendered_rgb'])}" for row in rows]
    lines = [f"Sky: {sky}", light.caption, "", *table, "", *summary]
    (out / "report.json").write_text(json.dumps(report, indent=1), encoding="utf-8")
    (out / "report.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return summary


def _means(rows: list[dict], measured: bool) -> dict[str, float]:
    if not measured:
        return {
            f"delta_E_{way}": float(np.mean([row["predicted_delta_E"][way] for row in rows]))
            for way in ("today", "spectral")
        }
    keys = [f"{m}_{way}" for m in ("delta_E", "relative_error") for way in ("today", "spectral")]
    return {key: float(np.mean([row[key] for row in rows])) for key in keys}


def _header(measured: bool) -> str:
    if not measured:
        return f"{'patch':<22} {'rendered RGB':^23} {'ΔE today':>9} {'spectral':>9}  (predicted)"
    return (
        f"{'patch':<22} {'rendered RGB':^23} {'reference RGB':^23} "
        f"{'ΔE today':>9} {'spectral':>9} {'rel. today':>10} {'spectral':>9}"
    )


def _line(row: dict, measured: bool) -> str:
    text = f"{row['patch']:<22} {_rgb(row['rendered_rgb'])}"
    if not measured:
        predicted = row["predicted_delta_E"]
        return f"{text} {predicted['today']:9.2f} {predicted['spectral']:9.2f}"
    return (
        f"{text} {_rgb(row['reference_rgb'])} "
        f"{row['delta_E_today']:9.2f} {row['delta_E_spectral']:9.2f} "
        f"{row['relative_error_today']:10.4f} {row['relative_error_spectral']:9.4f}"
    )


def _rgb(values: list[float]) -> str:
    return " ".join(f"{value:7.4f}" for value in values)
