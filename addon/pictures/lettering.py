"""Letters as pixels, at any size, without a font engine: the command line has none of Blender's.

``letters.npz`` holds DejaVu Sans as it comes out at `EM` pixels (tests/pictures/letters.py makes
it). A letter of another size is that picture's mean under each pixel: nothing is hinted, so text
looks the same at every place, and the same bytes come out everywhere.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

EM = 40.0
"""Size of the stored letters [pixels]."""

_FILE = Path(__file__).with_name("letters.npz")
_UNKNOWN = "□"


def width(text: str, size: float) -> float:
    """Return how far a line of text reaches [pixels] at a size [pixels an em]."""
    advances = [_letters()[_known(character)][1] for character in text]
    return sum(advances) * size / EM


def line(text: str, size: float, x: float, y: float) -> tuple[NDArray[np.float64], int, int]:
    """Return the coverage (h, w), 0 to 1, of a line of text and the pixel of its corner.

    ``x``, ``y`` [pixels]: where its baseline begins, y downwards; ``size`` [pixels an em]. A
    character that is not stored comes out as a box.
    """
    scale = size / EM
    top, left = int(np.floor(y - 1.1 * size)), int(np.floor(x - 0.2 * size))
    rows = int(np.ceil(1.6 * size)) + 2
    columns = int(np.ceil(width(text, size) + 0.4 * size)) + 2
    found = np.zeros((rows, columns))
    for character in text:
        pixels, advance, (bearing, ascent) = _letters()[_known(character)]
        if pixels.size:
            vertical = means(y - top - ascent * scale, scale, pixels.shape[0], rows)
            across = means(x - left + bearing * scale, scale, pixels.shape[1], columns)
            found += vertical @ pixels @ across.T
        x += advance * scale
    return np.minimum(found, 1.0), top, left


def means(start: float, scale: float, samples: int, pixels: int) -> NDArray[np.float64]:
    """Return what part of each pixel (pixels, samples) a row of samples covers.

    The first sample begins at ``start``, and each is ``scale`` pixels long.
    """
    edges = start + scale * np.arange(samples + 1)
    place = np.arange(pixels)[:, None]
    inside = np.clip(edges, place, place + 1.0)
    return np.diff(inside, axis=1)


def _known(character: str) -> str:
    return character if character in _letters() else _UNKNOWN


@cache
def _letters() -> dict[str, tuple[NDArray[np.float64], float, tuple[float, float]]]:
    """Return each character's coverage (h, w), advance, and (bearing, ascent), at `EM`."""
    with np.load(_FILE) as stored:
        characters, boxes = stored["characters"], stored["boxes"].astype(float)
        pixels = stored["pixels"] / 255.0
    sizes = boxes[:, :2].astype(int)
    parts = np.split(pixels, np.cumsum(sizes.prod(axis=1))[:-1])
    return {
        str(character): (part.reshape(size), box[4], (box[2], box[3]))
        for character, part, size, box in zip(characters, parts, sizes, boxes, strict=True)
    }
