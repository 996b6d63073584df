"""Values over a plan: each cell in a color, round values as lines, the scale beside it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .canvas import Canvas
from .false_colour import colours, scale_of, text
from .theme import LIGHT, Theme

PLAN = 560.0
"""The longer side of the plan [units]."""

MARGIN, SCALE_WIDTH, TITLE = 16.0, 150.0, 44.0
"""Around it, and room for the scale and the title [units]."""

_TEXT = 19.0


def light_map(
    values: NDArray[np.float64],
    spacing: tuple[float, float],
    title: str,
    unit: str,
    theme: Theme = LIGHT,
    scale: float = 1.5,
) -> NDArray[np.uint8]:
    """Draw values (rows, columns), the first row at the bottom, NaN where there are none.

    ``spacing``: between columns, and rows; ``scale``: pixels a unit. Returns sRGB (h, w, 3).
    """
    rows, columns = values.shape
    size = np.array([columns * spacing[0], rows * spacing[1]])
    width, height = size * (PLAN / size.max())
    canvas = Canvas(
        width + 2 * MARGIN + SCALE_WIDTH, max(height, 220.0) + TITLE + MARGIN, scale, theme.paper
    )
    canvas.text(MARGIN, 30.0, title, _TEXT + 3.0, theme.ink)
    x0, y0 = MARGIN, TITLE
    known = np.isfinite(values)
    span = scale_of(values)
    places = np.where(known, span.place(np.nan_to_num(values)), np.nan)
    shown = np.where(known[..., None], colours(np.nan_to_num(places)), theme.cell)
    canvas.image(shown[::-1], x0, y0, x0 + width, y0 + height)
    within = [value for value in span.levels if span.low < value < span.high]
    for value in within:
        for line in _crossings(places, float(span.place(value))):
            x = x0 + (line[:, 0] + 0.5) / columns * width
            y = y0 + height - (line[:, 1] + 0.5) / rows * height
            canvas.line(x, y, theme.paper, 1.6, opacity=0.85)
    canvas.frame(x0, y0, x0 + width, y0 + height, theme.faint, 1.0)
    left, bottom = x0 + width + 22.0, y0 + min(max(height, 200.0), 320.0)
    band = colours(np.linspace(1.0, 0.0, 128))[:, None]
    canvas.image(band, left, y0 + 18.0, left + 22.0, bottom)
    canvas.text(left, y0 + 8.0, unit, _TEXT - 2.0, theme.faint)
    for value in span.levels:
        y = bottom - float(span.place(value)) * (bottom - y0 - 18.0)
        canvas.line([left + 22.0, left + 28.0], [y, y], theme.faint, 1.2)
        canvas.text(left + 33.0, y + 6.0, text(value), _TEXT - 2.0, theme.ink)
    return canvas.pixels


def _crossings(values: NDArray, level: float) -> list[NDArray[np.float64]]:
    """Straight pieces (2, 2) of x, y where values pass a level: marching triangles, four to each
    square of neighbours, about its mean."""
    pieces = []
    rows, columns = values.shape
    for j in range(rows - 1):
        for i in range(columns - 1):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            at = [values[y, x] for x, y in corners]
            if not np.isfinite(at).all() or not min(at) <= level <= max(at):
                continue
            middle = (i + 0.5, j + 0.5)
            mean = float(np.mean(at))
            for k in range(4):
                places = [corners[k], corners[(k + 1) % 4], middle]
                levels = [at[k], at[(k + 1) % 4], mean]
                found = []
                for a in range(3):
                    u, v = levels[a], levels[(a + 1) % 3]
                    if (u < level) != (v < level):
                        share = (level - u) / (v - u)
                        one, other = np.array(places[a]), np.array(places[(a + 1) % 3])
                        found.append(one + share * (other - one))
                if len(found) == 2:
                    pieces.append(np.array(found))
    return pieces
