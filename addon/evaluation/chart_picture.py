"""The chart as a picture: accuracy against speed, with every method named."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from .chart import Row, front
from .charts import in_words, new_figure, write

FLOOR = 0.01
"""Mean CIEDE2000 that smaller ones are drawn at."""

_COLOURS = {
    "RGB × RGB": "#c1272d",
    "3x3": "#15803c",
    "texture": "#0f8a8a",
    "prefiltered": "#0f8a8a",
    "six channels": "#8a4fa3",
    "bands": "#1f6fb4",
    "spectrum restored": "#b4690e",
    "light": "#15803c",
    "walls": "#1f6fb4",
}
_PANELS = {
    "Materials: reflected light of a pixel": ("material",),
    "Light: irradiance of a face": ("light", "walls"),
}
_BARS = {
    "sun": "Sunlight",
    "ground": "Light from the ground",
    "glass": "Light through tinted glass",
    "lamp": "Lamps",
}
"""Kinds whose ways take the same time, and differ by their errors alone."""
_CLUSTER = 1.4
"""Points within this factor of the fastest have their names in a column to the left."""


def draw(
    stem: Path, rows: Sequence[Row], eevee: Mapping[str, tuple[float, str]], caption: Sequence[str]
) -> list[Path]:
    """Draw the table's rows and write them as PNG and SVG.

    ``eevee``: by its label, what a sample of a material costs, over Diffuse, and what is to be
    said of it; empty where it was not measured. ``caption``: lines under the picture.
    """
    barred = [kind for kind in _BARS if any(row.kind == kind for row in rows)]
    heights = [5.4] + [1.3] * bool(barred) + [1.4] * bool(eevee)
    figure = new_figure(14.0, 2.2 + 1.1 * sum(heights))
    figure.get_layout_engine().set(rect=(0.008, 0.0, 0.984, 1.0))
    grid = figure.add_gridspec(len(heights), 2, height_ratios=heights, width_ratios=[1.25, 1.0])
    drawn = []
    for column, (title, kinds) in enumerate(_PANELS.items()):
        axis = figure.add_subplot(grid[0, column])
        drawn.append((axis, *_panel(axis, title, [row for row in rows if row.kind in kinds])))
    if barred:
        cells = grid[1, :].subgridspec(1, len(barred))
        for cell, kind in zip(cells, barred, strict=True):
            _bars(figure.add_subplot(cell), kind, [row for row in rows if row.kind == kind])
    if eevee:
        _strip(figure.add_subplot(grid[-1, :]), eevee)
    figure.supxlabel("\n".join(caption), fontsize=8.5, color="#555555", x=0.012, ha="left")
    figure.draw_without_rendering()  # lays everything out: from here on places are known
    figure.set_layout_engine("none")
    for axis, points, lines in drawn:
        _name(figure, axis, points, lines)
    return write(figure, stem)


def _panel(axis: Any, title: str, rows: Sequence[Row]) -> tuple[list[_Point], list[_Line]]:
    """Draw points and fronts; return what is to be named and the lines to keep clear of."""
    points, lines = [], []
    axis.set(xscale="log", yscale="log")
    axis.set_title(title, loc="left", fontsize=12)
    axis.set_xlabel("Processor time per shaded pixel [ns], vectorized NumPy")
    axis.set_ylabel("Mean color error (CIEDE2000)")
    axis.axhspan(1e-6, 1.0, color="#15803c", alpha=0.05, linewidth=0)
    axis.grid(True, which="major", color="#e8e8e8", linewidth=0.8)
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)
    for row in rows:
        x, mean = row.nanoseconds[0], float(row.errors.delta_E.mean())
        colour = _COLOURS["walls" if row.kind == "walls" else row.family]
        axis.plot(x, max(mean, FLOOR), zorder=3, **_marker(row.kind, row, colour))
        name = f"3x3, {row.name}" if row.family == "3x3" and not row.is_limit else row.name
        name = in_words(re.sub(",? and ", " + ", name).removesuffix(" known"))
        name += ": exact" if mean < FLOOR / 10 else ""
        points.append((x, max(mean, FLOOR), name, colour))
    for kind in {row.kind: None for row in rows}:
        best = front([row for row in rows if row.kind == kind])
        line = [(row.nanoseconds[0], max(float(row.errors.delta_E.mean()), FLOOR)) for row in best]
        axis.step(*zip(*line, strict=True), where="post", color="#999999", linewidth=1.3, zorder=1)
        lines.append(line)
    x, y = np.array([point[:2] for point in points]).T
    # Names to the left take so much, and the legend over them.
    left, top = (15000.0, 5.0) if sum(x < _CLUSTER * x.min()) > 3 else (60.0, 1.7)
    axis.set_xlim(x.min() / left, x.max() * 9.0)
    axis.set_ylim(y.min() / 1.7, y.max() * top)
    _legend(axis, {row.kind for row in rows})
    return points, lines


_Point = tuple[float, float, str, str]
_Line = list[tuple[float, float]]


def _marker(kind: str, row: Row | None, colour: str) -> dict[str, Any]:
    limit = row is not None and row.is_limit
    hollow = row is not None and row.needs_more
    return {
        "marker": "X" if limit else ("D" if kind == "walls" else "o"),
        "color": colour,
        "markerfacecolor": "white" if hollow or limit else colour,
        "markersize": 7,
        "markeredgewidth": 1.6,
        "linestyle": "none",
    }


def _legend(axis: Any, kinds: set[str]) -> None:
    """Say what the markers and the line mean."""
    from matplotlib.lines import Line2D

    ink: dict[str, Any] = {
        "markeredgecolor": "#555555",
        "markersize": 7,
        "linestyle": "none",
        "markeredgewidth": 1.6,
    }
    if "material" in kinds:
        place = "upper right"
        signs = [
            ("o", "#555555", "Needs the color of the light and at most the sun's position"),
            ("o", "white", "Needs the spectrum of the light or more channels"),
            ("X", "white", "Limit: fitted to the true colors"),
        ]
    else:
        place = "lower left"
        signs = [
            ("o", _COLOURS["light"], "Open sky"),
            ("D", _COLOURS["walls"], "Street with light gray walls, as high as it is wide"),
        ]
    handles = [Line2D([], [], **ink, marker=m, markerfacecolor=fill) for m, fill, _ in signs]
    handles.append(Line2D([], [], color="#999999", linewidth=1.3))
    labels = [
        *(label for *_, label in signs),
        "Pareto front: no method is both faster and more accurate",
    ]
    axis.legend(handles, labels, loc=place, frameon=False, fontsize=8.5)


def _bars(axis: Any, kind: str, rows: Sequence[Row]) -> None:
    """Draw what ways to shade one kind of light are off by, each bar with its name over it."""
    means = [float(row.errors.delta_E.mean()) for row in rows]
    for place, (row, mean) in enumerate(zip(rows, means, strict=True)):
        axis.barh(place, mean, height=0.34, color=_COLOURS[row.family])
        name = in_words(row.name.removesuffix(" in Rec.709"))
        axis.text(0.0, place - 0.22, name, va="bottom", fontsize=8.5, color="#444444")
        text = f"{mean:.2f}" if mean > FLOOR / 10 else "exact"
        axis.text(mean + 0.01 * max(means), place, text, va="center", fontsize=9, weight="bold")
    axis.set(xlim=(0.0, 1.25 * max(means)), ylim=(3.4, -0.8), xticks=[], yticks=[])
    axis.set_title(f"{_BARS[kind]}: mean CIEDE2000", loc="left", fontsize=10.5)
    axis.spines[["top", "right", "bottom"]].set_visible(False)


def _strip(axis: Any, eevee: Mapping[str, tuple[float, str]]) -> None:
    """Draw what a sample in Eevee costs, ours in green, with a remark on each."""
    column = 1.12 * max(ratio for ratio, _ in eevee.values())
    for place, (name, (ratio, remark)) in enumerate(eevee.items()):
        colour = "#15803c" if name.startswith("Skylight") else "#b5b5b5"
        axis.barh(place, ratio, height=0.62, color=colour)
        axis.text(
            ratio + 0.01 * column, place, f"{ratio:.2f}", va="center", fontsize=9, weight="bold"
        )
        axis.text(column, place, remark, va="center", fontsize=9, color="#444444")
    axis.set_yticks(range(len(eevee)), list(eevee), fontsize=9)
    # The remarks want two fifths of the width, however long the bars.
    axis.set(xlim=(0, column / 0.6), ylim=(len(eevee) - 0.5, -0.5), xticks=[])
    axis.tick_params(left=False)
    axis.set_title("Eevee: time of a sample relative to Diffuse", loc="left", fontsize=12)
    axis.axvline(1.0, color="#999999", linewidth=0.8, zorder=0)
    axis.spines[:].set_visible(False)


def _name(figure: Any, axis: Any, points: Sequence[_Point], lines: Sequence[_Line]) -> None:
    """Write each point's name where nothing else is, with a line to it where that is afar."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    renderer = FigureCanvasAgg(figure).get_renderer()
    unit = figure.dpi / 72
    to_data = axis.transData.inverted().transform
    taken = [_box(place, place, 6 * unit) for place in _places(axis, points)]
    taken.append(np.array(axis.get_legend().get_window_extent(renderer).extents))
    for line in lines:
        for (x0, y0), (x1, y1) in pairwise(line):
            (level, corner, end) = _places(axis, [(x0, y0), (x1, y0), (x1, y1)])
            taken += [_box(level, corner, 2 * unit), _box(end, corner, 2 * unit)]
    left = min(x for x, *_ in points) * _CLUSTER
    cluster = [point for point in points if point[0] < left]
    column = sorted(cluster, key=lambda point: -point[1]) if len(cluster) > 3 else []
    taken += _name_column(axis, renderer, column, unit)
    rest = [point for point in points if point not in column]
    inside = axis.get_window_extent(renderer).extents
    for x, y, name, colour in sorted(rest, key=lambda point: (-point[1], point[0])):
        (place,) = _places(axis, [(x, y)])
        text = axis.text(x, y, name, fontsize=9, color=colour, va="bottom", zorder=4)
        extent = text.get_window_extent(renderer)
        size = np.array([extent.width, extent.height])
        corner = _free_corner(place, size, taken, inside, unit)
        taken.append(_box(corner, corner + size, 2 * unit))
        text.set_position(to_data(corner))
        nearest = np.clip(place, corner, corner + size)
        if np.linalg.norm(nearest - place) > 14 * unit:
            axis.plot(*to_data([place, nearest]).T, color=colour, linewidth=0.6, zorder=2)


def _name_column(axis: Any, renderer: Any, points: Sequence[_Point], unit: float) -> list[Any]:
    """Write names to the left of points that stand above one another, each with a line to it.

    Returns the names' boxes.
    """
    if not points:
        return []
    places = np.array(_places(axis, points))
    apart = 13.5 * unit
    heights = places[:, 1].copy()
    for _ in range(500):  # push neighbours apart until none is too near
        gaps = heights[:-1] - heights[1:]
        push = np.maximum(apart - gaps, 0.0) / 2
        if push.max(initial=0.0) < 0.01:
            break
        heights[:-1] += push
        heights[1:] -= push
    to_data = axis.transData.inverted().transform
    edge, boxes = places[:, 0].min() - 34 * unit, []
    for place, height, (_, _, name, colour) in zip(places, heights, points, strict=True):
        end = (edge + 2 * unit, height)
        style = {"color": colour, "fontsize": 9, "ha": "right", "va": "center", "zorder": 4}
        text = axis.text(*to_data((edge, height)), name, **style)
        boxes.append(np.array(text.get_window_extent(renderer).extents))
        near = (place[0] - 6 * unit, place[1])
        axis.plot(*to_data([end, near]).T, color=colour, linewidth=0.6, zorder=2)
    return boxes


def _places(axis: Any, points: Sequence[Any]) -> list[Any]:
    return list(axis.transData.transform([point[:2] for point in points]))


def _box(one: Any, other: Any, margin: float) -> Any:
    return np.array([*(np.minimum(one, other) - margin), *(np.maximum(one, other) + margin)])


def _free_corner(place: Any, size: Any, taken: Sequence[Any], inside: Any, unit: float) -> Any:
    """Return the lower left corner of the nearest free box for a text beside a point."""
    turns = np.radians([0, 180, 90, 270, 30, 330, 150, 210, 60, 300, 120, 240])
    for distance in np.arange(8.0, 400.0, 3.0) * unit:
        for turn in turns:
            low = place + distance * np.array([np.cos(turn), np.sin(turn)])
            low += size / 2 * (np.round([np.cos(turn), np.sin(turn)], 6) - 1.0)
            high = low + size
            fits = np.all(low > inside[:2]) and np.all(high < inside[2:])
            if fits and not any(np.all(low < box[2:]) and np.all(high > box[:2]) for box in taken):
                return low
    return place + 8 * unit
