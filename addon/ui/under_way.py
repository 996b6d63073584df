"""What an operator is at, for the panel: its status bar lies far from what was pressed."""

from __future__ import annotations

import time

import bpy

from ..progress import Progress
from .translation import translated

SHOWN = 0.3
"""[s] between two looks at the progress: each costs a redraw."""

_doing = ""
_step: Progress | None = None
_shown = 0.0  # when, by `time.monotonic`, the panel was drawn last


def show(doing: str, step: Progress | None) -> None:
    """Remember what is done and how far it is, None for nothing, and draw the sidebars now and
    then."""
    global _doing, _step
    _doing, _step = doing, step
    redraw(at_once=step is None)


def redraw(at_once: bool = False) -> None:
    """Draw the sidebars again, and not the pictures beside them: those may take seconds."""
    global _shown
    if not at_once and time.monotonic() - _shown < SHOWN:
        return
    _shown = time.monotonic()
    manager = bpy.context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            for region in area.regions if area.type == "VIEW_3D" else ():
                if region.type == "UI":
                    region.tag_redraw()


def draw(layout: bpy.types.UILayout) -> bool:
    """A bar of what is under way; whether anything is."""
    if _step is None:
        return False
    doing, line = translated(_doing), translated(_step.line)
    text = f"{doing} {line}: {100 * _step.done:.0f} %"
    layout.progress(factor=_step.done, text=translated(text))
    return True
