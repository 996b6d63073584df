"""Pictures that panels show: drawn once for what they show, soon after a panel asks for them.

A panel's `draw` may not compute: what is not there yet is put on a list, which a timer works off
while Blender waits for the mouse. Pictures are kept by their numbers, so that undo, redo and other
materials of the same numbers find theirs again; nothing of them lies in the blend file.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from itertools import count
from typing import Any

import bpy
import bpy.utils.previews

from ..errors import InputError
from .labels import told

KEPT = 96
"""Pictures: up to 1 MB each, and the swatches of a grid."""

Draw = Callable[[], Any]
"""Returns sRGB pixels (h, w, 3) uint8, or raises InputError. It holds numbers, no blend data."""

SLICE = 0.05
"""[s] of drawing between two looks at what a person does."""

_previews: Any = None
_names: dict[Hashable, str] = {}  # of what is drawn, the latest last
_problems: dict[Hashable, str] = {}
_wanted: dict[Hashable, Draw] = {}
_numbers = count()


def icon(key: Hashable, draw: Draw) -> int:
    """The icon of a picture; 0 while it is being drawn, and where `problem` says why it is not.

    ``key``: all that the picture depends on.
    """
    if key in _names:
        _names[key] = _names.pop(key)
        return int(_previews[_names[key]].icon_id)
    if key not in _problems:
        _wanted[key] = draw
        if not (bpy.app.background or bpy.app.timers.is_registered(_work)):
            bpy.app.timers.register(_work, first_interval=0.01)
    return 0


def problem(key: Hashable) -> str:
    """Why there is no picture, empty where there is or will be one."""
    return _problems.get(key, "")


def draw_wanted() -> None:
    """Draw all that panels have asked for."""
    while _wanted:
        _draw_one()


def _draw_one() -> None:
    key, draw = _wanted.popitem()
    try:
        _keep(key, draw())
    except InputError as error:
        _problems[key] = told(error)


def pixels(key: Hashable) -> Any:
    """What Blender holds of a picture: RGBA rows from below, flat, 0 to 1; empty without."""
    return _previews[_names[key]].image_pixels_float[:] if key in _names else []


def clear() -> None:
    """Let go of all pictures; the next that is asked for begins anew."""
    global _previews
    if bpy.app.timers.is_registered(_work):
        bpy.app.timers.unregister(_work)
    for kept in (_names, _problems, _wanted):
        kept.clear()
    if _previews is not None:
        bpy.utils.previews.remove(_previews)
        _previews = None


def _work() -> float | None:
    """Draw for a moment, and let the panels show it: a timer's turn."""
    until = time.monotonic() + SLICE
    while _wanted and time.monotonic() < until:
        _draw_one()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"VIEW_3D", "PROPERTIES"}:
                area.tag_redraw()
    return 0.01 if _wanted else None


def _keep(key: Hashable, rgb: Any) -> None:
    from ..pictures.preview import rgba

    global _previews
    if _previews is None:
        _previews = bpy.utils.previews.new()
    while len(_names) >= KEPT:
        del _previews[_names.pop(next(iter(_names)))]
    name = str(next(_numbers))
    preview = _previews.new(name)
    preview.image_size = rgb.shape[1::-1]
    preview.image_pixels_float.foreach_set(rgba(rgb))
    _names[key] = name
