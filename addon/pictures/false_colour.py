"""Amounts of light as colours, with isolines and a legend.

The colours are *viridis* of S. van der Walt and N. Smith (2015, https://bids.github.io/colormap,
CC0): its lightness grows evenly, so it is read without colours too, in print and by colour-blind
people.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.working_spaces import from_srgb
from ..transfer.readings import number
from .canvas import Canvas
from .theme import LIGHT, Theme

_VIRIDIS = (
    "440154 470d60 48186a 482374 472d7b 453781 424086 3e4989 3b528b 375b8d 33638d "
    "2f6b8e 2c728e 297a8e 26828e 23898e 21918c 1f978b 1f9f88 21a685 27ad81 31b57b "
    "3dbc74 4cc26c 5cc863 6ece58 81d34d 95d840 aadc32 c0df25 d5e21a eae51a fde725"
)
STOPS: NDArray[np.float64] = (
    np.array([list(bytes.fromhex(code)) for code in _VIRIDIS.split()]) / 255.0
)
"""(33, 3) sRGB at even steps; between them linear, within 0.007 of the whole table."""

ROUND = 1.0, 2.0, 5.0
"""What the numbers of a scale begin with …"""

ENDS = 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0
"""… and its last one."""

WIDE = 50.0
"""From how many times the least amount on a scale is logarithmic."""

LEGEND = 150.0
"""Width of the legend [units]."""

_STEEP = 0.15
"""Of the scale from one pixel to the next: what is steeper is an edge, and no isoline."""


@dataclass(frozen=True)
class Scale:
    """Which amounts have the first and the last colour; ``logarithmic``: even steps are ratios.

    ``low`` is below ``high``, and above 0 where the scale is logarithmic.
    """

    low: float
    high: float
    logarithmic: bool = False

    def place(self, amounts: ArrayLike) -> NDArray[np.float64]:
        """Return where amounts lie, 0 at ``low`` and 1 at ``high``; those beyond at the ends."""
        amounts = np.asarray(amounts, dtype=float)
        if self.logarithmic:
            amounts = np.log(np.maximum(amounts, self.low) / self.low)
            return np.clip(amounts / np.log(self.high / self.low), 0.0, 1.0)
        return np.clip((amounts - self.low) / (self.high - self.low), 0.0, 1.0)

    @property
    def levels(self) -> list[float]:
        """Round amounts from ``low`` to ``high``: those of isolines and of the legend."""
        if self.logarithmic:
            decades = range(int(np.floor(np.log10(self.low))), int(np.log10(self.high)) + 1)
            steps = [first * 10.0**decade for decade in decades for first in ROUND]
        else:
            step = rounded((self.high - self.low) / 8.0)
            steps = (np.arange(np.ceil(self.low / step), self.high / step + 1e-6) * step).tolist()
        return [each for each in steps if self.low * 0.999 <= each <= self.high * 1.001]


def scale_of(amounts: ArrayLike) -> Scale:
    """Return a scale with round ends for amounts, those that are no numbers left out.

    One in a hundred at either end may lie beyond. From 0 to 1 where there is no light.
    """
    known = np.asarray(amounts, dtype=float).ravel()
    known = known[np.isfinite(known) & (known > 0.0)]
    if not known.size:
        return Scale(0.0, 1.0)
    low, high = np.percentile(known, (1.0, 99.0))
    if high > WIDE * low:
        low, high = rounded(low, down=True), rounded(high, of=ENDS)
        return Scale(max(low, 1e-4 * high), high, logarithmic=True)
    return Scale(0.0, rounded(high, of=ENDS))


def rounded(amount: float, down: bool = False, of: Sequence[float] = ROUND) -> float:
    """Return the next number that begins with one ``of`` some above an amount, or below it."""
    size = 10.0 ** np.floor(np.log10(amount))
    around = [first * size for first in (*of, 10.0)]
    if down:
        return float(max(each for each in around if each <= amount * (1.0 + 1e-9)))
    return float(min(each for each in around if each >= amount * (1.0 - 1e-9)))


def colours(places: ArrayLike) -> NDArray[np.float64]:
    """Return sRGB (..., 3), 0 to 1, of places on a scale (...)."""
    places = np.asarray(places, dtype=float)
    at = np.linspace(0.0, 1.0, len(STOPS))
    return np.stack([np.interp(places, at, channel) for channel in STOPS.T], axis=-1)


def texels(scale: Scale, count: int = 1024) -> NDArray[np.float32]:
    """Return colours at even steps of a scale, (count, 4): linear RGB, and how many levels lie
    below."""
    t = np.linspace(0.0, 1.0, count)
    below = np.searchsorted(scale.place(scale.levels), t)
    return np.column_stack([from_srgb(colours(t)), below]).astype(np.float32)


def shown(amounts: ArrayLike, scale: Scale, theme: Theme = LIGHT) -> NDArray[np.float64]:
    """Return amounts (h, w) as colours with isolines, (h, w, 3) sRGB; the paper where NaN."""
    amounts = np.asarray(amounts, dtype=float)
    places = scale.place(np.nan_to_num(amounts))
    pixels = colours(places)
    pixels[isolines(amounts, scale)] = 0.0
    pixels[~np.isfinite(amounts)] = theme.paper
    return pixels


def isolines(amounts: ArrayLike, scale: Scale) -> NDArray[np.bool_]:
    """Return the pixels (h, w) at which amounts pass one of the scale's levels.

    Not where they jump, as from one thing to another behind it.
    """
    amounts = np.asarray(amounts, dtype=float)
    band = np.searchsorted(scale.levels, np.nan_to_num(amounts))
    places = scale.place(np.nan_to_num(amounts))
    passed = np.zeros(amounts.shape, bool)
    for axis in (0, 1):
        near = np.abs(np.diff(places, axis=axis)) < _STEEP
        known = np.isfinite(np.diff(amounts, axis=axis))
        here = [slice(None), slice(None)]
        here[axis] = slice(None, -1)
        passed[tuple(here)] |= (np.diff(band, axis=axis) != 0) & near & known
    return passed


def text(amount: float) -> str:
    """Return an amount as `number` writes it, without zeros at its end."""
    figure = number(amount)
    return figure.rstrip("0").rstrip(".") if "." in figure else figure


def false_colour(
    amounts: ArrayLike,
    title: str,
    unit: str,
    *,
    scale: Scale | None = None,
    theme: Theme = LIGHT,
) -> NDArray[np.uint8]:
    """Draw amounts (h, w), NaN where there are none, with a legend; return sRGB, (h', w', 3).

    A pixel for each amount, small pictures enlarged by whole numbers; ``scale``: None for that of
    `scale_of`.
    """
    amounts = np.asarray(amounts, dtype=float)
    scale = scale_of(amounts) if scale is None else scale
    height, width = amounts.shape
    times = max(1, int(np.ceil(320 / height)))
    large = np.kron(amounts, np.ones((times, times)))
    pixels = shown(large, scale, theme)
    unit_size = max(1.0, height * times / 480.0)
    canvas = Canvas(
        width * times / unit_size + LEGEND, height * times / unit_size, unit_size, theme.paper
    )
    canvas.image(pixels, 0, 0, width * times / unit_size, canvas.height)
    legend(canvas, width * times / unit_size + 14.0, title, unit, scale, theme)
    known = amounts[np.isfinite(amounts)]
    if known.size:
        line = f"mean {text(float(known.mean()))}"
        canvas.text(canvas.width - LEGEND + 14, canvas.height - 12, line, 14.0, theme.faint)
    return canvas.pixels


def legend(canvas: Canvas, x: float, title: str, unit: str, scale: Scale, theme: Theme) -> None:
    """Draw a bar of colours from ``x`` on over a canvas's height, with its amounts."""
    top, bottom = 52.0, canvas.height - 38.0
    canvas.text(x, 20, title, 15.0, theme.ink, room=canvas.width - x - 4)
    canvas.text(x, 39, unit, 14.0, theme.faint, room=canvas.width - x - 4)
    bar = colours(np.linspace(1.0, 0.0, 256))[:, None]
    canvas.image(bar, x, top, x + 26, bottom)
    last = np.inf
    for level in scale.levels:
        y = bottom + (top - bottom) * float(scale.place(level))
        canvas.rectangle(x, y - 0.75, x + 26, y + 0.75, (0.0, 0.0, 0.0))
        if last - y >= 17.0:
            canvas.text(x + 32, y + 5, text(level), 14.0, theme.ink)
            last = y
