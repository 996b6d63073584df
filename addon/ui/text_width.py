"""How wide texts are in the interface's font, and lines that fit: Blender wraps none by itself."""

from __future__ import annotations

import re
from functools import lru_cache

import blf
import bpy

FONT = 0
"""The interface's own, in `blf`."""

_IDEOGRAPH = r"[\u3000-\u9fff\uff00-\uffef]"
_END = "[、。，．）」』！？：；ー]*"  # what may not begin a line
_WORD = re.compile(rf"(?:RGB × RGB|[^ {_IDEOGRAPH[1:]}+){_END} *|{_IDEOGRAPH}{_END} *")
"""What stays on one line: a word, or a Japanese character."""


def width(text: str) -> float:
    """Return how wide a text is [pixels at scale 1]."""
    styles = bpy.context.preferences.ui_styles
    blf.size(FONT, styles[0].widget.points if styles else 11.0)
    return float(blf.dimensions(FONT, text)[0])


@lru_cache(maxsize=2048)
def wrapped(text: str, room: float) -> tuple[str, ...]:
    """Return a text as lines that are at most ``room`` wide [pixels at scale 1].

    A word that is wider alone has a line of its own.
    """
    lines = [""]
    for word in _WORD.findall(text):
        if lines[-1] and width((lines[-1] + word).rstrip()) > room:
            lines.append("")
        lines[-1] += word
    return tuple(line.rstrip() for line in lines)
