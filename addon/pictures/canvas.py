"""Drawing into pixels with smooth edges: lines, areas, pictures and text.

A pixel takes of a colour what the shape covers of it: exactly for upright shapes, by the distance
to the middle for lines. Places and sizes are in units of the picture, x to the right, y downwards;
colours are sRGB, 0 to 1.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import lettering


class Canvas:
    """A sheet of ``width`` by ``height`` units, ``scale`` pixels each, of one colour at first."""

    def __init__(self, width: float, height: float, scale: float, paper: ArrayLike) -> None:
        self.scale = scale
        self.width, self.height = width, height
        shape = round(height * scale), round(width * scale)
        self._pixels = np.empty((*shape, 3))
        self._pixels[:] = paper

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """The picture, (h, w, 3) sRGB, row 0 at the top."""
        return np.round(self._pixels * 255.0).astype(np.uint8)

    def rectangle(
        self, x0: float, y0: float, x1: float, y1: float, colour: ArrayLike, opacity: float = 1.0
    ) -> None:
        """Fill an upright rectangle."""
        self._paint(self._upright(x0, y0, x1, y1) * opacity, colour)

    def frame(self, x0: float, y0: float, x1: float, y1: float, colour: ArrayLike, width: float):
        """Draw a rectangle's outline, ``width`` wide, inside its edges."""
        outer = self._upright(x0, y0, x1, y1)
        width = min(width, (x1 - x0) / 2.0, (y1 - y0) / 2.0)  # a small one is all edge
        self._paint(outer - self._upright(x0 + width, y0 + width, x1 - width, y1 - width), colour)

    def area(
        self,
        x: ArrayLike,
        top: ArrayLike,
        bottom: ArrayLike,
        colour: ArrayLike,
        opacity: float = 1.0,
    ) -> None:
        """Fill between two curves over x, which increases; ``colour``: one, or one for each x."""
        x = np.asarray(x, dtype=float) * self.scale
        middle = np.arange(self._pixels.shape[1]) + 0.5
        high, low = (
            np.interp(middle, x, np.broadcast_to(curve, x.shape)) * self.scale
            for curve in (top, bottom)
        )
        rows = np.arange(self._pixels.shape[0])[:, None]
        covered = np.clip(low, rows, rows + 1.0) - np.clip(high, rows, rows + 1.0)
        covered = np.maximum(covered, 0.0) * self._covered(x[0] / self.scale, x[-1] / self.scale, 1)
        shade = np.asarray(colour, dtype=float)
        if shade.ndim == 2:
            shade = np.stack([np.interp(middle, x, part) for part in shade.T], axis=-1)
        self._paint(covered * opacity, shade)

    def line(
        self,
        x: ArrayLike,
        y: ArrayLike,
        colour: ArrayLike,
        width: float,
        dash: tuple[float, float] | None = None,
        opacity: float = 1.0,
    ) -> None:
        """Draw a line through points with round joints; ``dash``: lengths of strokes and gaps."""
        points = np.stack(np.broadcast_arrays(x, y), axis=-1).astype(float) * self.scale
        covered = np.zeros(self._pixels.shape[:2])
        half = width * self.scale / 2.0
        for start, end in _strokes(points, dash and np.array(dash) * self.scale):
            block, distance = self._distance(start, end, half + 1.0)
            covered[block] = np.maximum(covered[block], np.clip(half + 0.5 - distance, 0.0, 1.0))
        self._paint(covered * opacity, colour)

    def disc(
        self, x: float, y: float, radius: float, colour: ArrayLike, opacity: float = 1.0
    ) -> None:
        """Fill a circle."""
        self.line([x, x], [y, y], colour, 2.0 * radius, opacity=opacity)

    def image(self, rgb: ArrayLike, x0: float, y0: float, x1: float, y1: float) -> None:
        """Place a picture (h, w, 3), 0 to 1, in a rectangle; each pixel is the mean under it."""
        rgb = np.asarray(rgb, dtype=float)
        edges = ((y0, y1), (x0, x1))
        down, across = (
            lettering.means(low * self.scale, (high - low) * self.scale / n, n, pixels)
            for (low, high), n, pixels in zip(edges, rgb.shape, self._pixels.shape, strict=False)
        )
        covered = np.outer(down.sum(axis=1), across.sum(axis=1))
        mixed = np.einsum("yi,ijc,xj->yxc", down, rgb, across, optimize=True)
        self._pixels *= 1.0 - covered[..., None]
        self._pixels += mixed

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        colour: ArrayLike,
        align: float = 0.0,
        room: float | None = None,
    ) -> float:
        """Write a line on the baseline y; x is its start, middle or end: ``align`` 0, 0.5 or 1.

        ``room``: how wide it may be; a longer one is cut with an ellipsis. Returns its width.
        """
        if room is not None and lettering.width(text, size) > room:
            while text and lettering.width(text + "…", size) > room:
                text = text[:-1]
            text = text.rstrip() + "…"
        width = lettering.width(text, size)
        start = (x - align * width) * self.scale
        covered, top, left = lettering.line(text, size * self.scale, start, y * self.scale)
        up, over = max(-top, 0), max(-left, 0)
        pixels = self._pixels[top + up :, left + over :]
        covered = covered[up : up + pixels.shape[0], over : over + pixels.shape[1]]
        self._blend(pixels[: covered.shape[0], : covered.shape[1]], covered, colour)
        return width

    def _upright(self, x0: float, y0: float, x1: float, y1: float) -> NDArray[np.float64]:
        return np.outer(self._covered(y0, y1, 0), self._covered(x0, x1, 1))

    def _covered(self, low: float, high: float, axis: int) -> NDArray[np.float64]:
        """Return what part of each row (axis 0) or column (1) an interval covers."""
        return lettering.means(
            low * self.scale, (high - low) * self.scale, 1, self._pixels.shape[axis]
        )[:, 0]

    def _paint(self, covered: NDArray[np.float64], colour: ArrayLike) -> None:
        rows, columns = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered.any(axis=0))
        if rows.size:  # most shapes are small
            block = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
            shade = np.asarray(colour, dtype=float)
            shade = shade[block[1]] if shade.ndim == 2 else shade
            self._blend(self._pixels[block], covered[block], shade)

    @staticmethod
    def _blend(
        pixels: NDArray[np.float64], covered: NDArray[np.float64], colour: ArrayLike
    ) -> None:
        pixels += covered[..., None] * (np.asarray(colour, dtype=float) - pixels)

    def _distance(self, start, end, margin: float):
        """Return the block of pixels around a segment and how far their middles are from it."""
        size = self._pixels.shape[1::-1]
        left, top = np.clip(np.floor(np.minimum(start, end) - margin).astype(int), 0, size)
        right, bottom = np.clip(np.ceil(np.maximum(start, end) + margin).astype(int), 0, size)
        block = np.s_[top:bottom, left:right]
        rows, columns = np.ogrid[block]
        x, y = columns + 0.5, rows + 0.5
        along = end - start
        length = float(along @ along)
        place = (x - start[0]) * along[0] + (y - start[1]) * along[1]
        t = np.clip(place / length, 0.0, 1.0) if length else np.zeros_like(place)
        return block, np.hypot(x - start[0] - t * along[0], y - start[1] - t * along[1])


def _strokes(points: NDArray[np.float64], dash: NDArray[np.float64] | None):
    """Return the segments of a line, cut into dashes where it has them."""
    segments = list(pairwise(points))
    if dash is None:
        return segments
    strokes, travelled, period = [], 0.0, float(dash.sum())
    for start, end in segments:
        length = float(np.hypot(*(end - start)))
        first, last = int(travelled // period), int((travelled + length) // period)
        for number in range(first, last + 1):
            low = max(number * period, travelled) - travelled
            high = min(number * period + dash[0], travelled + length) - travelled
            if high > low:
                direction = (end - start) / length
                strokes.append((start + low * direction, start + high * direction))
        travelled += length
    return strokes
