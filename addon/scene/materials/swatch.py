"""A colour under a sky as a swatch can show it: the sky's white on level ground is 1."""

from __future__ import annotations

from collections.abc import Sequence


def scale(colour: Sequence[float], white: float) -> float:
    """Return by what a scene-linear colour is multiplied, for nothing of it to be over 1.

    ``white``: the luminance of a white diffuser on level ground; where it is 0 the colour is 0 too.
    """
    return 1.0 / max(white or 1.0, *colour)


def shown(colour: Sequence[float], white: float) -> tuple[float, ...]:
    """Return a colour (3,) from 0 to 1; what is out of gamut is cut off, as Blender does."""
    return tuple(max(0.0, part) * scale(colour, white) for part in colour)
