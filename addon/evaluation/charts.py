"""The evaluation as pictures: the paper's Figures 1 and 2 and its table, and measured daylight.

Every function draws one figure and writes it twice, PNG and SVG.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..spectra.grid import WAVELENGTHS
from ..whole_files import writing
from .day import FACE_NAMES, Day
from .evaluation import Errors

_STYLES: dict[str, dict[str, Any]] = {
    "RGB × RGB in Rec.709": {"color": "#c1272d"},
    "RGB × RGB in Rec.2020": {"color": "#e8912d"},
    "rayleigh": {"color": "#1f6fb4"},
    "daylight": {"color": "#76b7e5"},
    "atmosphere": {"color": "#15803c", "linestyle": ":"},
    "atmosphere, colour known": {"color": "#15803c", "linestyle": "--"},
    "atmosphere, elevation known": {"color": "#15803c"},
    "best 3x3": {"color": "#777777"},
}
"""The same line for the same method in every figure."""
_OTHER = {"color": "#8a4fa3"}
_CHANNELS = ("#c1272d", "#2e8b3d", "#1f4fb4")


def basis_functions(stem: Path, bases: Mapping[str, NDArray[np.float64]]) -> list[Path]:
    """Draw bases as the spectra s_r, s_g, s_b that they give to red, green and blue, (81, 3) each.

    That is what of a basis matters, and what makes different ones comparable.
    """
    figure = new_figure(4.2 * len(bases), 3.6)
    axes = figure.subplots(1, len(bases), sharey=True, squeeze=False)[0]
    for axis, (name, functions) in zip(axes, bases.items(), strict=True):
        for values, colour, channel in zip(functions.T, _CHANNELS, "rgb", strict=True):
            axis.plot(WAVELENGTHS, values, color=colour, label=f"$s_{channel}$")
        axis.axhline(0.0, color="#bbbbbb", linewidth=0.8, zorder=0)
        axis.set(title=in_words(name), xlabel="Wavelength [nm]", xlim=(380, 780))
    # At the dark ends, which the eye hardly sees, some grow large.
    middle = (WAVELENGTHS >= 420) & (WAVELENGTHS <= 680)
    shown = np.stack([functions[middle] for functions in bases.values()])
    margin = 0.15 * np.ptp(shown)
    axes[0].set(
        ylabel="Spectrum per unit of a channel", ylim=(shown.min() - margin, shown.max() + margin)
    )
    axes[0].legend(frameon=False)
    return write(figure, stem)


def error_over_day(stem: Path, days: Mapping[str, tuple[Day, Sequence[Errors]]]) -> list[Path]:
    """Draw the relative error of patch 1 on a face that looks up, over the hours of each day.

    ``days``: by caption, the light and the errors under all of it, patch 1 first.
    """
    figure = new_figure(5.2 * len(days), 4.4)
    axes = figure.subplots(1, len(days), sharey=True, squeeze=False)[0]
    for axis, (caption, (day, errors)) in zip(axes, days.items(), strict=True):
        for method in errors:
            relative = method.relative.reshape(len(day.hours), len(FACE_NAMES), -1)[:, 0, 0]
            style = _STYLES.get(method.method, _OTHER)
            axis.semilogy(day.hours, relative, marker=".", label=in_words(method.method), **style)
        axis.axhline(0.01, color="#333333", linewidth=0.8, linestyle=":")
        axis.set(title=f"Sky: {caption}", xlabel="Local time [h]", xticks=range(0, 25, 3))
        axis.set_xlim(day.hours[0] - 0.5, day.hours[-1] + 0.5)
    axes[0].set_ylabel("Relative error of patch 1, face up")
    _legend_below(figure, axes[0])
    return write(figure, stem)


def table(stem: Path, patches: Sequence[str], errors: Sequence[Errors], title: str) -> list[Path]:
    """Draw mean relative errors over the day, patches down, faces across, one panel a method."""
    figure = new_figure(4.4 * len(errors) + 1.2, 7.2)
    axes = figure.subplots(1, len(errors), sharey=True, squeeze=False)[0]
    for axis, method in zip(axes, errors, strict=True):
        mean = by_face(method).mean(axis=0).T
        axis.imshow(
            np.log10(np.maximum(mean, 1e-6)), cmap="YlOrRd", vmin=-4, vmax=-0.7, aspect="auto"
        )
        for (row, column), value in np.ndenumerate(mean):
            colour = "white" if value > 0.06 else "black"
            axis.text(
                column, row, f"{value:.4f}", ha="center", va="center", fontsize=6, color=colour
            )
        axis.set_title(in_words(method.method), fontsize=9)
        axis.set_xticks(range(len(FACE_NAMES)), FACE_NAMES, rotation=60, ha="right", fontsize=7)
        axis.set_yticks(range(len(patches)), patches, fontsize=7)
    figure.suptitle(title, fontsize=10)
    return write(figure, stem)


def distribution(stem: Path, errors: Sequence[Errors], title: str) -> list[Path]:
    """Draw for each method which share of lights and materials stays under which CIEDE2000."""
    figure = new_figure(7.2, 5.2)
    axis = figure.subplots()
    share = np.linspace(0.0, 100.0, 400)
    for method in errors:
        values = np.percentile(method.delta_E, share)
        label = f"{in_words(method.method)}: mean {method.delta_E.mean():.2f}"
        style = _STYLES.get(method.method, _OTHER)
        axis.plot(np.maximum(values, 1e-3), share, label=label, **style)
    axis.axhline(95.0, color="#333333", linewidth=0.8, linestyle=":")
    axis.set(xscale="log", xlabel="Color error (CIEDE2000)", title=title)
    axis.set_ylabel("Lights and materials with a smaller error [%]")
    axis.set_xlim(left=0.01)
    _legend_below(figure, axis)
    return write(figure, stem)


def by_face(method: Errors) -> NDArray[np.float64]:
    """Return the relative errors over a day as (t, 9, m)."""
    return method.relative.reshape(-1, len(FACE_NAMES), method.relative.shape[1])


def in_words(name: str) -> str:
    """Return a method's name as a figure says it."""
    return name.replace("colour", "color").replace("grey", "gray")


def new_figure(width: float, height: float) -> Any:
    """Return an empty figure [inches]. Raises `InputError` where matplotlib is missing."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise InputError(
            "matplotlib", "is needed to draw figures", "pip install matplotlib"
        ) from error
    return Figure(figsize=(width, height), layout="constrained")


def _legend_below(figure: Any, axis: Any) -> None:
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, fontsize=8)


def _few_colours(path: Path) -> None:
    """Make a PNG a third as large: figures have few colours, and their edges' shades are as few."""
    from PIL import Image  # matplotlib's own

    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    few.save(path, optimize=True)


def write(figure: Any, stem: Path) -> list[Path]:
    """Write a figure as PNG and SVG, the same bytes each time."""
    import matplotlib

    paths = [stem.with_suffix(suffix) for suffix in (".png", ".svg")]
    with matplotlib.rc_context({"svg.hashsalt": stem.name, "svg.fonttype": "none"}):
        with writing(paths[0]) as part:
            figure.savefig(part, dpi=160, metadata={"Software": None})
            _few_colours(part)
        with writing(paths[1]) as part:
            figure.savefig(part, metadata={"Date": None})
    return paths
