"""The last guard of buttons and panels: what nobody foresaw is one line, and Blender goes on.

Files are edited by hand and by other add-ons, so anything may be met. A panel that failed at each
redraw would fill the console, and a button would show a traceback.
"""

from __future__ import annotations

import functools
import sys
import traceback
from collections.abc import Callable
from typing import Any

import bpy

from ..errors import fault

_told: set[str] = set()


def guarded(cls: type) -> type:
    """Return a class of Blender's with its methods guarded; once is enough.

    Not a gizmo: its methods have other parameters.
    """
    if issubclass(cls, bpy.types.Gizmo):
        return cls
    for name, wrap in _WRAPS.items():
        method = getattr(cls, name, None)
        if method is not None and not hasattr(method, "__wrapped__"):
            bound = hasattr(method, "__self__")
            setattr(cls, name, classmethod(wrap(method.__func__)) if bound else wrap(method))
    return cls


def handler(method: Callable[..., None]) -> Callable[..., None]:
    """Return a handler of Blender's, or the callback of a property, that never fails."""

    @functools.wraps(method)
    def quiet(*arguments: Any) -> None:
        try:
            method(*arguments)
        except Exception as error:
            line(error)

    return quiet


def line(error: Exception) -> str:
    """Return an exception's line; the first time the console gets all of it."""
    text = fault(error)
    if text not in _told:
        _told.add(text)
        traceback.print_exception(error, file=sys.stderr)
    return text


# Blender counts the parameters of methods: each wrapper names its own.


def _execute(method: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(method)
    def execute(self: Any, context: bpy.types.Context) -> Any:
        try:
            return method(self, context)
        except Exception as error:
            self.report({"ERROR"}, line(error))
            return {"FINISHED"}  # an undo step takes back what was done so far

    return execute


def _on_event(method: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(method)
    def on_event(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> Any:
        try:
            return method(self, context, event)
        except Exception as error:
            self.report({"ERROR"}, line(error))
            return {"CANCELLED"}

    return on_event


def _draw(method: Callable[..., None]) -> Callable[..., None]:
    @functools.wraps(method)
    def draw(self: Any, context: bpy.types.Context) -> None:
        try:
            method(self, context)
        except Exception as error:
            self.layout.label(text=line(error), icon="ERROR", translate=False)

    return draw


def _poll(method: Callable[..., bool]) -> Callable[..., bool]:
    @functools.wraps(method)
    def poll(cls: Any, context: bpy.types.Context) -> bool:
        try:
            return method(cls, context)
        except Exception as error:
            if hasattr(cls, "poll_message_set"):
                cls.poll_message_set(line(error))
            return False

    return poll


_WRAPS = {
    "execute": _execute,
    "invoke": _on_event,
    "modal": _on_event,
    "draw": _draw,
    "poll": _poll,
}
