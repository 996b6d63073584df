"""The chart of whole pictures, drawn: a panel for each scene, time across, error up."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .charts import new_figure, write
from .scene_chart import TIMES, Point, front, verdict

_COLOURS = {
    "Ours in Cycles": "#15803c",
    "Ours in Eevee": "#0f8a8a",
    "Ours, traced": "#7fb000",
    "Ours, traced, denoised": "#b5d33c",
    "Ours, traced in Rec.2020": "#3f7d5a",
    "Ours, traced in Rec.2020, denoised": "#8cc3a3",
    "Eevee": "#777777",
    "Cycles RGB": "#c1272d",
    "Cycles RGB, denoised": "#e07b39",
    "Cycles RGB in Rec.2020": "#8a4fa3",
    "Cycles RGB in Rec.2020, denoised": "#b48cc8",
    "Cycles by wavelength": "#1f6fb4",
    "Mitsuba 3, spectral": "#a0672f",
    "Radiance, 20 bands": "#222222",
}
_OTHER = "#333333"
_COLUMNS = 3


def draw(stem: Path, some: Sequence[Point], caption: str) -> list[Path]:
    """Draw error against the time of the first picture, and write it as PNG and SVG."""
    scenes = list(dict.fromkeys(point.scene for point in some))
    columns = min(_COLUMNS, len(scenes))
    rows = -(-len(scenes) // columns)
    figure = new_figure(5.4 * columns + 0.2, 5.2 * rows + 1.5)
    axes = figure.subplots(rows, columns, squeeze=False)
    for axis in axes.flat[len(scenes) :]:
        axis.set_axis_off()
    for axis, scene in zip(axes.flat, scenes, strict=False):
        own = [point for point in some if point.scene == scene]
        _panel(axis, own, "")
        said = "\n".join(line[0].upper() + line[1:] for line in verdict(own))
        axis.set_title(scene, loc="left", fontsize=12, weight="bold")
        axis.set_xlabel("Processor time until the picture is there [s]")
        axis.text(
            *(0.0, -0.15, _wrapped(said)),
            transform=axis.transAxes,
            va="top",
            fontsize=8.5,
            color="#444444",
        )
    for axis in axes[:, 0]:
        axis.set_ylabel("Color error: mean (point), 95 of 100 pixels (line), CIEDE2000")
    _close(figure, some, caption)
    figure.draw_without_rendering()  # only then is it known where the axes are
    for axis, scene in zip(axes.flat, scenes, strict=False):
        _name(axis, [point for point in some if point.scene == scene])
    return write(figure, stem)


def draw_again(stem: Path, some: Sequence[Point], caption: str) -> list[Path]:
    """Draw error against the time of what comes after the first picture."""
    scenes = list(dict.fromkeys(point.scene for point in some))
    later = list(TIMES)[1:]
    figure = new_figure(4.6 * len(later) + 0.2, 3.4 * len(scenes) + 1.5)
    axes = figure.subplots(len(scenes), len(later), squeeze=False, sharey="row")
    for row, scene in zip(axes, scenes, strict=True):
        own = [point for point in some if point.scene == scene]
        for axis, what in zip(row, later, strict=True):
            known = [point for point in own if what in point.times]
            if known:
                _panel(axis, known, what)
            axis.set_title(f"{scene}: {TIMES[what]}", loc="left", fontsize=10)
        row[0].set_ylabel("Mean CIEDE2000")
    for axis in axes[-1]:
        axis.set_xlabel("Processor time until the picture is there [s]")
    _close(figure, some, caption)
    return write(figure, stem)


def _panel(axis: Any, some: Sequence[Point], what: str) -> None:
    """Draw the points of one scene, their series, their front and the reference's noise."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set(xscale="log", yscale="log")
    axis.grid(True, which="major", color="#e8e8e8", linewidth=0.8)
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)
    for family in dict.fromkeys(point.family for point in some):
        series = sorted(
            (point for point in some if point.family == family), key=lambda p: p.times[what]
        )
        colour = _COLOURS.get(family, _OTHER)
        for line in _lines(series):
            places = [[p.times[what] for p in line], [p.errors["mean"] for p in line]]
            axis.plot(*places, color=colour, linewidth=0.9, alpha=0.7, zorder=2)
        for point in series:
            x, mean, p95 = point.times[what], point.errors["mean"], point.errors["p95"]
            axis.plot(x, mean, "o", color=colour, markersize=5.5, zorder=3)
            axis.plot([x, x], [mean, p95], color=colour, linewidth=0.8, alpha=0.3, zorder=2)
    best = front(some, what)
    edge = max(point.times[what] for point in some) * 1.6
    times = [*(point.times[what] for point in best), edge]
    errors = [*(point.errors["mean"] for point in best), best[-1].errors["mean"]]
    axis.step(times, errors, where="post", color="#999999", linewidth=1.3, zorder=1)
    noise = some[0].noise[0]
    low = 0.7 * min(noise, min(point.errors["mean"] for point in some))
    axis.axhspan(low, noise, color="#999999", alpha=0.18, linewidth=0)
    axis.text(
        0.01,
        noise,
        "noise of the reference",
        transform=axis.get_yaxis_transform(),
        ha="left",
        va="top",
        fontsize=7.5,
        color="#555555",
    )
    axis.set_ylim(bottom=low)
    for one in axis.xaxis, axis.yaxis:
        one.set_major_locator(LogLocator(10.0, (1.0, 2.0, 5.0)))
        one.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        one.set_minor_formatter(NullFormatter())
    axis.set_xlim(right=edge)


_SIZE = 7.0
"""Of the points' names [pt]."""

_SIDES = ((5, 3), (5, -10), (0, 8), (0, -15), (5, 13), (5, -20))
"""Where a name may stand beside its point [pt]; also to the left."""


def _name(axis: Any, some: Sequence[Point]) -> None:
    """Write the points' names where there is room: of a series by number at least its ends."""
    to_points = axis.transData.transform
    scale = 72.0 / axis.figure.dpi
    frame = axis.get_window_extent().transformed(axis.figure.dpi_scale_trans.inverted())
    frame = [72.0 * x for x in (frame.x0, frame.y0, frame.x1, frame.y1)]
    dots = [tuple(to_points((p.times[""], p.errors["mean"])) * scale) for p in some]
    taken = [(x - 3, y - 3, x + 3, y + 3) for x, y in dots]
    first: dict[tuple[str, str], Point] = {}
    for point in sorted(some, key=lambda point: point.times[""]):
        first.setdefault((point.family, point.label), point)
    ends = {}
    for point in first.values():
        ends.setdefault(point.family, [point, point])[1] = point
    needed = [p for p in first.values() if not p.label[:1].isdigit() or p in ends[p.family]]
    spare = [point for point in first.values() if point not in needed]
    for point in [*needed, *spare]:
        x, y = to_points((point.times[""], point.errors["mean"])) * scale
        wide = 0.56 * _SIZE * len(point.label)
        places = []
        for dx, dy in _SIDES:
            for left in (x + dx, x - dx - wide):
                places.append((left, y + dy, left + wide, y + dy + _SIZE + 1))
        crossed = [sum(_overlap(place, other) for other in taken) for place in places]
        crossed = [
            area + 1e3 * (not _within(place, frame))
            for area, place in zip(crossed, places, strict=True)
        ]
        best = crossed.index(min(crossed))
        if crossed[best] and point in spare:
            continue
        taken.append(places[best])
        axis.annotate(
            point.label,
            (point.times[""], point.errors["mean"]),
            (places[best][0] - x, places[best][1] - y + 1),
            textcoords="offset points",
            fontsize=_SIZE,
            color=_COLOURS.get(point.family, _OTHER),
            annotation_clip=False,
        )


def _overlap(a: Sequence[float], b: Sequence[float]) -> float:
    """Return the area that two boxes (left, bottom, right, top) share."""
    wide, high = (min(a[k + 2], b[k + 2]) - max(a[k], b[k]) for k in (0, 1))
    return max(wide, 0.0) * max(high, 0.0)


def _within(box: Sequence[float], frame: Sequence[float]) -> bool:
    return box[0] >= frame[0] and box[2] <= frame[2] + 8 and box[1] >= frame[1]


def _lines(series: Sequence[Point]) -> list[list[Point]]:
    """Return what of a series is one line: one way as it becomes better, and one way by number."""
    ways: dict[str, list[Point]] = {}
    for point in series:
        ways.setdefault(point.way, []).append(point)
    several = [line for line in ways.values() if len(line) > 1]
    single = [line[0] for line in ways.values() if len(line) == 1]
    return [*several, [point for point in single if point.label[:1].isdigit()]]


def _wrapped(text: str, width: int = 76) -> str:
    import textwrap

    return "\n".join(part for line in text.splitlines() for part in textwrap.wrap(line, width))


def _close(figure: Any, some: Sequence[Point], caption: str) -> None:
    """Say below what colours mean, and on what it was measured."""
    from matplotlib.lines import Line2D

    families = list(dict.fromkeys(point.family for point in some))
    families.sort(key=lambda name: list(_COLOURS).index(name) if name in _COLOURS else 99)
    handles = [
        Line2D([], [], marker="o", linestyle="none", color=_COLOURS.get(name, _OTHER), label=name)
        for name in families
    ]
    handles.append(Line2D([], [], color="#999999", label="Pareto front"))
    figure.legend(
        handles=handles,
        loc="outside upper left",
        ncols=max(1, int(figure.get_figwidth() / 2.6)),
        frameon=False,
        fontsize=9,
    )
    figure.supxlabel(
        _wrapped(caption, int(13 * figure.get_figwidth())),
        fontsize=8.5,
        color="#555555",
        x=0.012,
        ha="left",
    )
