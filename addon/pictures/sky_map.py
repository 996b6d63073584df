"""Where the pixels of a sky are no skylight, and what of a building's light comes from there."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..sky.sky_classification import FOREIGN, GROUND, KINDS, SKY, SUN, Outside, blocks
from ..sky.sun import Sun
from ..spectra.sorting import median
from ..spectra.working_spaces import LUMINANCE
from .canvas import Canvas
from .theme import DARK, Theme

SIZE = 480.0
"""Side of the picture; its upper half is the map [units]."""

MARKS = {
    SKY: (0.42, 0.62, 0.86),
    SUN: (0.94, 0.89, 0.26),
    GROUND: (0.59, 0.59, 0.59),
    FOREIGN: (0.8, 0.24, 0.63),
}
"""sRGB by kind, told apart by colour-blind people too."""

_WORDS = {SKY: "Skylight", SUN: "Sun", GROUND: "Ground", FOREIGN: "Other light"}
_FACES = {"Up": 0, "North": 5, "East": 6, "South": 7, "West": 8}
"""Faces of a building by their places in `sky.light.FACES`."""

_TEXT = 20.0
BARS = 312.0, 33.0
"""Where the first face's bar begins, and how far the next [units]."""

LEFT = 82.0
"""Where the bars begin [units]."""


def marked(found: Outside, sky: ArrayLike) -> NDArray[np.uint8]:
    """Return a sky with its kinds marked, (h, 2 h, 3) sRGB, the labels' size.

    ``sky``: the panorama, (rows, columns, 3). Skylight is shown as it is, ground grey, foreign
    light magenta, both as bright as they are, and the sun's place yellow, larger than it is.
    """
    rgb = blocks(sky)
    luminance = np.maximum(rgb @ LUMINANCE, 0.0)
    middle = median(luminance[luminance > 0.0]) if luminance.any() else 1.0
    # Reinhard's curve, the median at middle grey.
    scale = 1.0 / (luminance + 4.0 * middle)
    shown = np.clip(rgb * scale[..., None], 0.0, 1.0) ** (1.0 / 2.2)
    brightness = 0.3 + 0.7 * (luminance * scale) ** (1.0 / 2.2)
    for kind in (GROUND, FOREIGN):
        here = found.labels == kind
        shown[here] = np.multiply.outer(brightness[here], MARKS[kind])
    shown[_grown(_grown(found.labels == SUN))] = MARKS[SUN]
    return np.round(shown * 255.0).astype(np.uint8)


def _grown(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a mask (h, w) with the pixels beside, above and under those that are set."""
    grown = mask.copy()
    grown[1:] |= mask[:-1]
    grown[:-1] |= mask[1:]
    grown[:, 1:] |= mask[:, :-1]
    grown[:, :-1] |= mask[:, 1:]
    return grown


def sky_map(
    found: Outside,
    sky: ArrayLike,
    sun: Sun | None = None,
    *,
    theme: Theme = DARK,
    scale: float = 1.0,
) -> NDArray[np.uint8]:
    """Draw a sky with its kinds marked, a legend, and each kind's part of the light on faces.

    Arguments as in `marked`; the sun has a ring around it. ``scale``: pixels a unit. Returns sRGB,
    (h, h, 3).
    """
    canvas = Canvas(SIZE, SIZE, scale, theme.paper)
    canvas.image(marked(found, sky) / 255.0, 0, 0, SIZE, SIZE / 2)
    canvas.rectangle(0, SIZE / 4 - 0.5, SIZE, SIZE / 4 + 0.5, theme.ink, 0.5)
    if sun is not None:
        x, y = sun_place(sun)
        turn = np.linspace(0.0, 2.0 * np.pi, 49)
        circle = x + 17 * np.cos(turn), y + 17 * np.sin(turn)
        canvas.line(*circle, (0.0, 0.0, 0.0), 6.0, opacity=0.6)
        canvas.line(*circle, MARKS[SUN], 3.0)
    x = 12.0
    for kind, word in _WORDS.items():
        canvas.rectangle(x, 256, x + 18, 274, MARKS[kind])
        x += 46.0 + canvas.text(x + 25, 272, word, _TEXT, theme.ink)
    canvas.text(12, 301, "Share of the light on faces that point", _TEXT, theme.faint)
    first, step = BARS
    for place, (name, face) in enumerate(_FACES.items()):
        y = first + step * place
        canvas.text(LEFT - 10, y + 19, name, _TEXT, theme.ink, 1.0)
        canvas.rectangle(LEFT, y, SIZE - 12, y + 25, theme.cell)
        start = LEFT
        for kind in range(len(KINDS)):
            end = start + (SIZE - 12 - LEFT) * found.shares[face, kind]
            canvas.rectangle(start, y, end, y + 25, MARKS[kind])
            start = end
    return canvas.pixels


def sun_place(sun: Sun) -> tuple[float, float]:
    """Return where the sun stands in the map (x, y) [units]."""
    east, north, up = sun.direction
    azimuth, elevation = np.arctan2(north, east), np.arcsin(np.clip(up, -1.0, 1.0))
    x, y = 0.5 - azimuth / (2.0 * np.pi), 0.5 - elevation / np.pi
    return float(x * SIZE), float(y * SIZE / 2)
