"""Whole pictures: their error against the time until they are there, as points, fronts and tables.

A point is one way to the picture of one scene. Times are processor seconds where nothing else is
said: what a machine of this kind works, however much else it has to do.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..whole_files import write_text
from .chart_report import machine

TIMES = {
    "": "the first picture",
    "frame_": "a further frame",
    "hour_": "another hour",
    "paint_": "another paint",
}
"""What takes time, by the prefix of its columns ``seconds`` and ``processor``."""

ERRORS = tuple(
    f"{part}{name}" for part in ("", "colour_", "luminance_") for name in ("mean", "p95", "worst")
)
"""CIEDE2000 of the whole, of its colour alone and of its luminance alone."""

FIELDS = [
    *("scene", "way", "family", "label", "state"),
    *(
        f"{what}{clock}"
        for what in ("", "setup_", *list(TIMES)[1:])
        for clock in ("seconds", "processor")
    ),
    *("memory_MB", "megabytes"),
    *ERRORS,
    *("noise", "noise_p95", "blender", "failed"),
]
"""The columns of `scenes.csv`."""

OURS, TODAY = "Ours", "Cycles RGB"
"""How the families of the two begin that are set against one another."""

SHARPER = 0.98
"""A point is on the front where it has less than this part of the error of all faster ones."""


@dataclass(frozen=True)
class Point:
    """One way to one picture.

    ``family``: points of one series; ``label``: which of it this is; ``times``: processor seconds
    by the keys of `TIMES`, those that are known; ``errors`` by `ERRORS`.
    """

    scene: str
    way: str
    family: str
    label: str
    times: dict[str, float]
    wall: float
    setup: float
    memory: float
    size: float | None
    errors: dict[str, float]
    noise: tuple[float, float]

    @property
    def is_ours(self) -> bool:
        """Whether the add-on made it."""
        return self.family.startswith(OURS)


def points(rows: Iterable[Mapping[str, str]]) -> list[Point]:
    """Return the points of a table's rows; those that failed are left out."""
    found = []
    for row in rows:
        if row["failed"]:
            continue
        numbers = {name: float(text) for name, text in row.items() if _is_number(text)}
        found.append(
            Point(
                row["scene"],
                row["way"],
                row["family"],
                row["label"],
                {what: t for what in TIMES if (t := numbers.get(f"{what}processor")) is not None},
                numbers["seconds"],
                numbers["setup_processor"],
                numbers["memory_MB"],
                numbers.get("megabytes"),
                {name: numbers[name] for name in ERRORS},
                (numbers["noise"], numbers["noise_p95"]),
            )
        )
    return found


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False


def front(some: Iterable[Point], what: str = "", error: str = "mean") -> list[Point]:
    """Return the points that none beats in time and error, fastest first."""
    best: list[Point] = []
    known = [point for point in some if what in point.times]
    for point in sorted(known, key=lambda point: (point.times[what], point.errors[error])):
        if not best or point.errors[error] < SHARPER * best[-1].errors[error]:
            best.append(point)
    return best


def verdict(some: Sequence[Point], what: str = "") -> list[str]:
    """Say of one scene's points whether ours are the front from a second on, and what RGB × RGB
    leaves at ours' time."""
    lines = []
    best = front(some, what)
    # What is there before a second is still the best until something nearer is.
    ends = [*(point.times[what] for point in best[1:]), np.inf]
    rivals = [k for k, end in enumerate(ends) if end > 1.0 and not best[k].is_ours]
    if rivals:
        names = ", ".join(
            f"{p.way} ({p.times[what]:.1f} s, {p.errors['mean']:.2f})"
            for p in (best[k] for k in rivals)
        )
        since = ends[rivals[-1]]
        then = f"; from {since:.1f} s on it is" if np.isfinite(since) else ""
        lines.append(f"not all of the front is ours: {names}{then}")
    elif best:
        lines.append("from one second on the front is ours alone")
    ours = [point for point in some if point.is_ours and what in point.times]
    today = [p for p in some if p.family.startswith(TODAY) and what in p.times]
    if not ours or not today:
        return lines
    nearest = min(ours, key=lambda point: point.errors["mean"])
    reached = min(today, key=lambda point: point.errors["mean"])
    least, rgb = nearest.errors["mean"], reached.errors["mean"]
    never = "never reaches" if rgb > least else "reaches"
    lines.append(f"RGB × RGB {never} ours' mean error: {rgb:.2f} at best, ours {least:.2f}")
    first = min(ours, key=lambda point: (point.errors["mean"] > 1.5 * least, point.times[what]))
    in_time = [point for point in today if point.times[what] <= first.times[what]]
    if in_time:
        ratio = min(point.errors["p95"] for point in in_time) / first.errors["p95"]
        lines.append(
            f"in {first.times[what]:.1f} s RGB × RGB has {ratio:.1f} times ours' 95th percentile"
        )
    return lines


def report_scenes(out: Path, rows: Sequence[Mapping[str, str]]) -> list[Path]:
    """Draw a table's points and write what they say as text; return the files.

    Raises `InputError` where no point is there yet, and where matplotlib is missing.
    """
    from .scene_chart_picture import draw, draw_again

    some = points(rows)
    if not some:
        raise InputError(out / "scenes.csv", "has no point", "measure one first")
    made = caption(rows)
    text = [f"# Whole pictures\n\n{made}\n"]
    for scene in dict.fromkeys(point.scene for point in some):
        text += _section(scene, [point for point in some if point.scene == scene])
    failed = [f"- {row['scene']}, {row['way']}: {row['failed']}" for row in rows if row["failed"]]
    if failed:
        text += ["\n## Not measured\n", *failed]
    write_text(out / "scenes.md", "\n".join(text) + "\n")
    return [
        *draw(out / "scenes", some, made),
        *draw_again(out / "scenes_again", some, made),
        out / "scenes.md",
        out / "scenes.csv",
    ]


def caption(rows: Sequence[Mapping[str, str]]) -> str:
    """Say what the figures were measured on."""
    on = machine()
    blender = "/".join(sorted({row["blender"] for row in rows if row["blender"]}))
    return (
        f"Processor seconds on {on['processor']}, {on['cores']} cores, no GPU: Eevee draws by "
        f"software. {on['system']}, Python {on['python']}, NumPy {on['numpy']}, Blender {blender}, "
        f"{date.today().isoformat()}. Numbers: samples a pixel. Judged by Cycles at fifteen "
        "wavelengths with every bounce."
    )


def _section(scene: str, some: Sequence[Point]) -> list[str]:
    """One scene's table and verdicts."""
    best = front(some)
    lines = [
        f"\n## {scene}\n",
        f"The reference's own noise: mean {some[0].noise[0]:.2f}, p95 {some[0].noise[1]:.2f}. "
        + "; ".join(verdict(some))
        + ".\n",
        "| | set-up [s] | first picture [s] (wall) | frame | hour | paint | memory [MB] "
        "| file [MB] | mean | p95 | worst | color | luminance |",
        "|---|" + "---|" * 12,
    ]
    for point in sorted(some, key=lambda point: point.times[""]):
        again = [f"{point.times[w]:.1f}" if w in point.times else "" for w in list(TIMES)[1:]]
        name = f"**{point.way}**" if point in best else point.way
        size = f"{point.size:.2f}" if point.size else ""
        cells = [
            *(name, f"{point.setup:.1f}", f"{point.times['']:.1f} ({point.wall:.1f})", *again),
            *(f"{point.memory:.0f}", size),
            *(f"{point.errors[e]:.2f}" for e in ("mean", "p95", "worst", "colour_mean")),
            f"{point.errors['luminance_mean']:.2f}",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines
