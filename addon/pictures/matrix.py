"""A material's matrix as a picture: how much of each channel of the sky goes to each channel.

G. Hinton's diagram: areas are sizes, colours are signs. RGB times RGB knows the diagonal alone,
drawn as an outline.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .canvas import Canvas
from .theme import DARK, Theme

SIZE = 480.0
"""Side of the picture [units]."""

LEFT, TOP, CELL, GAP = 70.0, 48.0, 124.0, 5.0
"""Where the cells begin, how large they are and how far apart [units]."""

LARGEST = 84.0
"""Side of the square of the largest entry [units]."""

_NOTHING = 1e-4
"""Of the largest entry: less has no outline, for it is rounding."""
_TEXT, _SMALL = 23.0, 20.0
_CHANNELS = {"R": (0.87, 0.25, 0.22), "G": (0.25, 0.66, 0.32), "B": (0.28, 0.47, 0.93)}


def matrix(
    M: ArrayLike,
    *,
    today: ArrayLike | None = None,
    theme: Theme = DARK,
    scale: float = 1.0,
) -> NDArray[np.uint8]:
    """Draw a matrix (3, 3), columns the sky's channels and rows the material's; return sRGB.

    ``today`` (3, 3): the matrix that RGB times RGB amounts to. ``scale``: pixels a unit.
    """
    M = np.asarray(M, dtype=float)
    other = np.zeros((3, 3)) if today is None else np.asarray(today, dtype=float)
    largest = max(np.abs(M).max(), np.abs(other).max(), 1e-9)
    canvas = Canvas(SIZE, SIZE, scale, theme.paper)
    for place, (name, colour) in enumerate(_CHANNELS.items()):
        x, y = centre(place, place)
        canvas.text(x, TOP - 14, f"Sky {name}", _TEXT, colour, 0.5)
        canvas.text(LEFT - 34, y + 8, name, _TEXT, colour, 0.5)
    for (row, column), value in np.ndenumerate(M):
        x, y = centre(row, column)
        half = CELL / 2
        canvas.rectangle(x - half, y - half, x + half, y + half, theme.cell)
        middle, half = y - 14, side(value, largest) / 2
        shade = theme.plus if value > 0 else theme.minus
        canvas.rectangle(x - half, middle - half, x + half, middle + half, shade)
        if abs(other[row, column]) > _NOTHING * largest:
            half = side(other[row, column], largest) / 2
            canvas.frame(x - half, middle - half, x + half, middle + half, theme.ink, 2.0)
        canvas.text(x, y + CELL / 2 - 8, signed(value), _TEXT, theme.ink, 0.5)
    _legend(canvas, theme, today is not None)
    return canvas.pixels


def _legend(canvas: Canvas, theme: Theme, today: bool) -> None:
    """Say what colours and outlines are."""
    x, y = LEFT, SIZE - 32.0
    for word, shade in (("Positive", theme.plus), ("Negative", theme.minus)):
        canvas.rectangle(x, y, x + 18, y + 18, shade)
        x += 48.0 + canvas.text(x + 26, y + 16, word, _SMALL, theme.ink)
    if today:
        canvas.frame(x, y, x + 18, y + 18, theme.ink, 2.0)
        canvas.text(x + 26, y + 16, "RGB × RGB", _SMALL, theme.ink)


def centre(row: int, column: int) -> tuple[float, float]:
    """Return the middle of a cell (x, y) [units]."""
    step = CELL + GAP
    return LEFT + CELL / 2 + column * step, TOP + CELL / 2 + row * step


def side(value: float, largest: float) -> float:
    """Return the side of an entry's square [units]: its area is the entry's size."""
    return LARGEST * float(np.sqrt(abs(value) / largest))


def signed(value: float) -> str:
    """Return a number with its sign and three digits after the point."""
    text = f"{value:+.3f}".replace("-", "−")
    return "0.000" if set(text[1:]) <= set("0.") else text
