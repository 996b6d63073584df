"""A material's reflectance as a curve, in the light that it meets."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.grid import WAVELENGTHS
from .canvas import Canvas
from .spectral_colours import spectral_colours
from .theme import DARK, Theme

SIZE = 480.0
"""Side of the picture [units]."""

LEFT, RIGHT, TOP, BOTTOM = 78.0, 464.0, 88.0, 408.0
"""Edges of the plot [units]."""

_BAND = 16.0
_TEXT = 21.0
_HELD, _ESTIMATED = (7.0, 6.0), (0.1, 8.0)
"""Dashes: strokes and dots [units]."""
_SKY_PEAK = 0.94
"""How high the sky's spectrum reaches: it has no unit, so its own peak is its measure."""
_SEEN = (WAVELENGTHS >= 420) & (WAVELENGTHS <= 680)
"""Where that peak is looked for: at the dark ends, which the eye hardly sees, some grow large."""


def curve(
    reflectance: ArrayLike,
    *,
    sky: ArrayLike | None = None,
    measured: tuple[float, float] | None = None,
    estimated: bool = False,
    theme: Theme = DARK,
    scale: float = 1.0,
) -> NDArray[np.uint8]:
    """Draw a reflectance (81,), 0 to 1, over nm; return sRGB (h, h, 3).

    Under the axis stands what the eye sees of each wavelength. ``sky`` (81,): the spectrum of the
    light, drawn relative to its peak, and in its colours what the material reflects of it.
    ``measured`` [nm]: beyond it the curve holds the values of its ends, and is dashed.
    ``estimated``: whether nobody measured it. ``scale``: pixels a unit.
    """
    rho = np.asarray(reflectance, dtype=float)
    canvas = Canvas(SIZE, SIZE, scale, theme.paper)
    canvas.rectangle(LEFT, TOP, RIGHT, BOTTOM, theme.cell)
    low, high = measured or (WAVELENGTHS[0], WAVELENGTHS[-1])
    held = [(a, b) for a, b in ((WAVELENGTHS[0], low), (high, WAVELENGTHS[-1])) if b > a]
    for start, end in held:
        canvas.rectangle(place_x(start), TOP, place_x(end), BOTTOM, theme.paper, 0.6)
    top = highest(rho)
    x = place_x(WAVELENGTHS)
    if sky is not None:
        light = np.maximum(np.asarray(sky, dtype=float), 0.0)
        light = _SKY_PEAK * light / max(light[_SEEN].max(), 1e-30)
        reflected = BOTTOM - (BOTTOM - TOP) * light * np.clip(rho, 0.0, 1.0)
        canvas.area(x, reflected, BOTTOM, spectral_colours(), 0.8)
    _axes(canvas, theme, top)
    if sky is not None:
        canvas.line(x, BOTTOM - (BOTTOM - TOP) * light, theme.sky, 2.2)
        canvas.rectangle(
            LEFT - 3.0, 0.0, SIZE, TOP - 1.0, theme.paper
        )  # what rises out of the plot
    y = place_y(rho, top)
    for start, end in [(max(low, WAVELENGTHS[0]), min(high, WAVELENGTHS[-1])), *held]:
        nodes = np.unique(np.clip(WAVELENGTHS, start, end))
        dash = _HELD if (start, end) in held else _ESTIMATED if estimated else None
        canvas.line(place_x(nodes), np.interp(place_x(nodes), x, y), theme.ink, 3.6, dash)
    _key(canvas, theme, sky is not None, bool(held), estimated)
    return canvas.pixels


def place_x(wavelengths: ArrayLike) -> NDArray[np.float64]:
    """Return where wavelengths [nm] stand [units]."""
    share = (np.asarray(wavelengths) - WAVELENGTHS[0]) / np.ptp(WAVELENGTHS)
    return LEFT + (RIGHT - LEFT) * share


def place_y(reflectance: ArrayLike, top: float) -> NDArray[np.float64]:
    """Return how high reflectances stand [units] where the axis ends at ``top``."""
    return BOTTOM - (BOTTOM - TOP) * np.asarray(reflectance) / top


def highest(reflectance: NDArray[np.float64]) -> float:
    """Return where the axis ends: dark materials get a closer look."""
    return next((end for end in (0.1, 0.2, 0.5) if reflectance.max() <= 0.95 * end), 1.0)


def _axes(canvas: Canvas, theme: Theme, top: float) -> None:
    """Draw wavelengths with their colours, and per cent."""
    for share in (0.0, 0.5, 1.0):
        y = float(place_y(share * top, top))
        canvas.rectangle(LEFT, y - 0.5, RIGHT, y + 0.5, theme.faint, 0.6)
        canvas.text(LEFT - 8, y + 7, f"{100 * share * top:g} %", _TEXT, theme.faint, 1.0)
    band = BOTTOM + 4
    canvas.area(place_x(WAVELENGTHS), band, band + _BAND, spectral_colours())
    for nm in (400, 500, 600, 700):
        x = float(place_x(nm))
        canvas.rectangle(x - 0.5, TOP, x + 0.5, BOTTOM, theme.faint, 0.35)
        canvas.text(x, BOTTOM + _BAND + 28, f"{nm}", _TEXT, theme.faint, 0.5)
    canvas.text(RIGHT, BOTTOM + _BAND + 28, "nm", _TEXT, theme.faint, 1.0)


def _key(canvas: Canvas, theme: Theme, sky: bool, held: bool, estimated: bool) -> None:
    """Say what the lines are."""
    words = "Reflectance (estimated)" if estimated else "Reflectance"
    x = _sample(canvas, theme.ink, LEFT, 31.0, words, 3.6, _ESTIMATED if estimated else None)
    if held and not estimated:
        _sample(canvas, theme.ink, x, 31.0, "Not measured", 3.6, _HELD)
    if sky:
        x = _sample(canvas, theme.sky, LEFT, 63.0, "Skylight", 2.2)
        canvas.area(np.linspace(x, x + 30, 41), 48, 63, spectral_colours()[14:55], 0.8)
        canvas.text(x + 40, 63, "Reflected light", _TEXT, theme.sky)


def _sample(
    canvas: Canvas,
    colour: ArrayLike,
    x: float,
    y: float,
    words: str,
    width: float,
    dash: tuple[float, float] | None = None,
) -> float:
    """Draw a piece of a line and its name; return where the next can begin."""
    canvas.line([x, x + 30], y - 7, colour, width, dash)
    return x + 56 + canvas.text(x + 40, y, words, _TEXT, colour)
