"""The report of a room: one page with its pictures in it, and the same as a table."""

from __future__ import annotations

import base64
import csv
import io
import tempfile
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...pictures.light_map import light_map
from ...pictures.png_file import write_png
from ...transfer.readings import headings, number
from ...whole_files import write_text
from .light_meter import Measured
from .room import Room


def write(path: Path, room: Room, name: str) -> list[Path]:
    """Write the page as ``path`` (.html) and the table beside it (.csv); return both paths.

    ``name``: of the room. Whole or not at all; raises InputError where that cannot be written.
    """
    beside = path.with_suffix(".csv")
    text = page(room, name)
    write_text(beside, table(room.measured, room.daylight_factor))
    write_text(path, text)
    return [path, beside]


def table(measured: Measured, daylight_factor: NDArray[np.float64] | None = None) -> str:
    """Return what was measured as CSV, a row for each place; what is worth nothing stays empty."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    shown = headings(measured.calibration.absolute)
    more = [] if daylight_factor is None else ["daylight_factor_percent"]
    rows.writerow(["x", "y", "z", "normal_x", "normal_y", "normal_z", *shown, *more])
    for k, values in enumerate(measured.readings.rows):
        place = [*measured.places.points[k], *measured.places.normals[k]]
        if daylight_factor is not None:
            values = np.append(values, 100.0 * daylight_factor[k])
        read = ["" if measured.inside[k] or value != value else f"{value:.6g}" for value in values]
        rows.writerow([*(f"{value:.6g}" for value in place), *read])
    return text.getvalue()


def page(room: Room, name: str) -> str:
    """Return the HTML."""
    measured = room.measured
    readings, absolute = measured.readings, measured.calibration.absolute
    unit = "lx" if absolute else "relative"
    kinds = [
        ("Illuminance", readings["illuminance"], unit),
        ("Melanopic EDI", readings["melanopic"], unit),
        ("Daylight factor", 100.0 * room.daylight_factor, "%"),
    ]
    lines = "".join(_row(room, *kind) for kind in kinds)
    T = readings.temperature[0][room.valid]
    tiles = [(f"{number(room.figures(kinds[0][1])[0])} {unit}", "mean illuminance")]
    tiles.append((f"{room.figures(kinds[2][1])[0]:.1f} %", "mean daylight factor"))
    if absolute:
        share = 100.0 * room.share_over(room.threshold)
        tiles.append((f"{share:.0f} %", f"of the floor over {room.threshold:g} lx"))
    if np.isfinite(T).any():
        tiles.append((f"{np.nanmedian(T):.0f} K", "median color temperature"))
    shown = "".join(f"<div><b>{value}</b>{words}</div>" for value, words in tiles)
    maps = "".join(_map(room, *kind) for kind in kinds)
    grid = measured.places
    notes = [
        measured.calibration.line,
        f"{int(room.valid.sum())} meters, {grid.spacing[0]:.3g} by {grid.spacing[1]:.3g} apart",
        "daylight factor: CIE overcast sky, ISO 15469 no. 16, without sun and lamps",
        "uniformity: minimum over mean",
    ]
    if inside := int((~room.valid).sum()):
        notes.append(f"{inside} meters stand inside something solid and do not count")
    said = "".join(f"<li>{escape(note)}</li>" for note in notes)
    title = escape(name)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>\n'
        f'<meta name="viewport" content="width=device-width">\n<style>{_STYLE}</style></head>\n'
        f"<body><h1>{title}</h1>\n<div class=tiles>{shown}</div>\n"
        "<table><tr><th><th>mean<th>minimum<th>maximum<th>uniformity"
        f"{lines}</table>\n<main>{maps}</main>\n<ul>{said}</ul></body></html>\n"
    )


def _row(room: Room, name: str, values: NDArray, unit: str) -> str:
    mean, low, high, uniformity = room.figures(values)
    cells = "".join(f"<td>{number(each)} {unit}" for each in (mean, low, high))
    return f"<tr><th>{name}{cells}<td>{uniformity:.2f}"


def _map(room: Room, name: str, values: NDArray, unit: str) -> str:
    grid = room.on_grid(values)
    picture = light_map(grid, room.measured.places.spacing, name, unit)
    with tempfile.TemporaryDirectory(prefix="skylight-") as folder:
        path = Path(folder) / "map.png"
        write_png(path, picture)
        data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<figure><img src="data:image/png;base64,{data}" alt="{name} over the plan"></figure>'


_STYLE = """
body{font:14px/1.45 system-ui,sans-serif;margin:2rem;background:#fff;color:#1b1b1b}
h1{font-size:1.5rem;margin:0 0 1rem}.tiles{display:flex;flex-wrap:wrap;gap:.6rem}
.tiles div{border:1px solid #d9d9d9;border-radius:6px;padding:.5rem .9rem}
.tiles b{display:block;font-size:1.35rem;font-weight:600}
table{border-collapse:collapse;margin:1.2rem 0}
th,td{padding:.35rem .7rem;text-align:left;border-bottom:1px solid #d9d9d9}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(340px,1fr));gap:.8rem}
figure{margin:0}img{max-width:100%}
"""
