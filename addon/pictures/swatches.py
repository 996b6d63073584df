"""A sheet of reflectances: each as it looks under a sky and, beside it, under D65."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.working_spaces import srgb
from .canvas import Canvas
from .theme import DARK, Theme

MOST = 240
"""Swatches on a sheet: more are too many to compare."""

ACROSS = 6
"""Swatches in a row."""

WIDTH, HEIGHT, GAP, MARGIN, TOP = 150.0, 64.0, 12.0, 18.0, 44.0
"""Of a swatch, between swatches, around all, and above them for the title [units]."""

_NAME, _TITLE = 13.0, 17.0
_CAPTION = 20.0


def swatches(
    names: Sequence[str],
    left: ArrayLike | None,
    right: ArrayLike,
    *,
    captions: tuple[str, str] = ("under this sky", "under D65"),
    theme: Theme = DARK,
    scale: float = 1.0,
) -> NDArray[np.uint8]:
    """Draw swatches of two halves, up to `MOST`, each above its name; return sRGB.

    ``left``, ``right`` (m, 3): linear Rec.709, white at 1, what lies outside 0 to 1 cut off; with
    ``left`` None a swatch is one colour. ``captions``: what the halves are. ``scale``: pixels a
    unit.
    """
    names = names[:MOST]
    halves = [srgb(np.clip(half, 0.0, 1.0)) for half in (left, right) if half is not None]
    rows = max(1, -(-len(names) // ACROSS))
    width = 2 * MARGIN + ACROSS * (WIDTH + GAP) - GAP
    height = TOP + MARGIN + rows * (HEIGHT + _CAPTION + GAP) - GAP
    canvas = Canvas(width, height, scale, theme.paper)
    said = (
        f"Left: {captions[0]}. Right: {captions[1]}"
        if len(halves) == 2
        else f"Colors {captions[1]}"
    )
    canvas.text(MARGIN, TOP - 18, said, _TITLE, theme.ink)
    for number, name in enumerate(names):
        row, column = divmod(number, ACROSS)
        x, y = MARGIN + column * (WIDTH + GAP), TOP + row * (HEIGHT + _CAPTION + GAP)
        part = WIDTH / len(halves)
        for place, colours in enumerate(halves):
            start = x + place * part
            canvas.rectangle(start, y, start + part, y + HEIGHT, colours[number])
        canvas.text(x, y + HEIGHT + 15, name, _NAME, theme.ink, room=WIDTH)
    return canvas.pixels
