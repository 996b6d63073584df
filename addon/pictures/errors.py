"""What is expected of materials under a sky: RGB times RGB beside the spectral matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .canvas import Canvas
from .theme import LIGHT, Theme

WIDTH, ROW, TOP = 480.0, 38.0, 104.0
LEFT, RIGHT = 190.0, 424.0
"""Between which the bars are drawn [units]."""

_TEXT = 19.0
JUST_NOTICEABLE = 1.0
"""CIEDE2000."""


def errors(
    names: Sequence[str],
    today: ArrayLike,
    ours: ArrayLike,
    *,
    theme: Theme = LIGHT,
    scale: float = 1.0,
) -> NDArray[np.uint8]:
    """Draw expected CIEDE2000 (m,) of two methods as bars, the worst of today's first.

    An unknown error (NaN) has a dash. ``scale``: pixels a unit. Returns sRGB, (h, w, 3).
    """
    today, ours = np.asarray(today, dtype=float), np.asarray(ours, dtype=float)
    canvas = Canvas(WIDTH, TOP + ROW * len(names) + 14.0, scale, theme.paper)
    known = np.nan_to_num([today, ours])
    longest = max(float(known.max(initial=0.0)), 1.2 * JUST_NOTICEABLE)
    unit = (RIGHT - LEFT) / longest
    canvas.text(16, 31, "Expected color error (CIEDE2000)", _TEXT, theme.ink)
    x = 16.0
    for label, shade in (("RGB × RGB", theme.today), ("Spectral", theme.ours)):
        canvas.rectangle(x, 45, x + 14, 59, shade)
        x += 50.0 + canvas.text(x + 22, 59, label, _TEXT, theme.ink)
    noticeable = LEFT + unit * JUST_NOTICEABLE
    canvas.rectangle(
        noticeable - 0.6, TOP - 8, noticeable + 0.6, canvas.height - 10, theme.faint, 0.6
    )
    canvas.text(noticeable, TOP - 14, "Just noticeable", _TEXT - 3, theme.faint, 0.5)
    for place, k in enumerate(np.argsort(-known[0], kind="stable")):
        y = TOP + ROW * place
        canvas.text(LEFT - 10, y + 25, names[k], _TEXT, theme.ink, 1.0, room=LEFT - 26)
        for start, value, shade in ((4, today[k], theme.today), (19, ours[k], theme.ours)):
            end = LEFT + unit * np.nan_to_num(value)
            canvas.rectangle(LEFT, y + start, end, y + start + 12, shade)
            number = "–" if np.isnan(value) else f"{value:.2f}"
            canvas.text(end + 6, y + start + 11, number, 15.0, theme.ink)
    return canvas.pixels
