"""Several pictures on one sheet, under a title."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .canvas import Canvas
from .theme import LIGHT, Theme

_MARGIN, _TITLE = 20.0, 44.0


def sheet(
    title: str, pictures: Sequence[NDArray[np.uint8]], *, theme: Theme = LIGHT, scale: float = 1.0
) -> NDArray[np.uint8]:
    """Return pictures (h, w, 3) side by side under a title; ``scale``: pixels a unit."""
    sizes = [(picture.shape[1] / scale, picture.shape[0] / scale) for picture in pictures]
    width = sum(size[0] for size in sizes) + _MARGIN * (len(sizes) + 1)
    height = max(size[1] for size in sizes) + _TITLE + _MARGIN
    canvas = Canvas(width, height, scale, theme.paper)
    canvas.text(_MARGIN, 31.0, title, 24.0, theme.ink, room=width - 2 * _MARGIN)
    x = _MARGIN
    for picture, size in zip(pictures, sizes, strict=True):
        canvas.image(picture / 255.0, x, _TITLE, x + size[0], _TITLE + size[1])
        x += size[0] + _MARGIN
    return canvas.pixels
