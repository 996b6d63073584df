"""The sky that is shown, simulated with less noise while a person works on.

The simulation knows nothing of the blend file, so whatever is done meanwhile stays. Its sky takes
the place of the one shown where that is still the same sky.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any

import bpy

from ..errors import InputError
from ..progress import Progress, a_while, run
from . import follow, last_guard, make_sky, operator, properties, staleness_handlers, under_way
from .esc import EscKey
from .labels import told

QUALITY = "reference"

SLICE = 0.05
"""[s] of work between two looks at what a person does."""

PAUSE = 0.4
"""[s] between two looks where something else has its turn."""


@dataclass
class Work:
    """One simulation under way, of the sky of a scene."""

    scene: str
    made: Any
    steps: Generator[Progress, None, Any]
    progress: Progress = field(default_factory=lambda: Progress(0.0, "sky"))


_work: Work | None = None
_line = ""


def work() -> Work | None:
    """The simulation under way, None without."""
    return _work


def line() -> str:
    """Why the last one did not end; empty where it did."""
    return _line


def drop() -> None:
    """End the simulation under way: the sky stays as it is."""
    global _work
    if _work is not None:
        steps, _work = _work.steps, None
        steps.close()


def begin(scene: bpy.types.Scene) -> None:
    """Begin with the sky of a scene, between events from now on."""
    global _work, _line
    made = _made(scene)
    _work, _line = Work(scene.name, made, _drawing(made)), ""
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=0.01)


def _tick() -> float | None:
    """Work for a moment; return in how many seconds to go on, None for no more."""
    global _work, _line
    if _work is None:
        return None
    window = next(iter(bpy.context.window_manager.windows), None)
    if window is None or follow.busy(window) or follow.work() is not None or follow.waiting():
        return PAUSE
    try:
        _work.progress = a_while(_work.steps, SLICE)
    except StopIteration as done:
        current, _work = _work, None
        with bpy.context.temp_override(window=window):
            _line = _show(current, done.value)
    except InputError as error:
        _line, _work = told(error), None
    except Exception as error:  # a timer that fails is not called again
        _line, _work = last_guard.line(error), None
    under_way.redraw(at_once=_work is None)
    return 0.01


def _show(current: Work, drawn: Any) -> str:
    """Let a scene have the new sky; why not, where it has another by now."""
    scene = bpy.data.scenes.get(current.scene)
    if scene is None or _made(scene) != current.made:
        return "The sky has changed: not refined"
    with staleness_handlers.ours(bpy.context):
        _apply(scene, drawn)
    staleness_handlers.after(bpy.context)
    return ""


def _apply(scene: bpy.types.Scene, drawn: Any) -> Any:
    from ..scene import use_cases

    settings = properties.settings_of(scene.world)
    return run(use_cases.showing_sky(scene, drawn, settings, not follow.follows(settings)))


def _made(scene: bpy.types.Scene) -> Any:
    """The place and the quality of the sky of a scene; None of one that was not simulated."""
    from ..scene.world import hdri, simulated_sky

    try:
        image = hdri.sky_of(scene.world).image
    except InputError:
        return None
    return None if image is None else simulated_sky.made_of(image)


def can_refine(made: Any) -> bool:
    """Whether a sky, as `simulated_sky.made_of` returns it, can be had with less noise."""
    return made is not None and made[1] != QUALITY


class SKYLIGHT_OT_refine_sky(operator.Thin, bpy.types.Operator):
    """Simulate the sky that is shown with less noise. It takes a minute or two, in which you can \
work on; Esc stops it"""

    bl_idname = "skylight.refine_sky"
    bl_label = "Refine Sky"

    @classmethod
    def disabled_reason(cls, context):
        if _work is not None:
            return "The sky is being refined"
        if not can_refine(_made(context.scene)):
            return "There is no preview of a simulated sky"
        return ""

    def invoke(self, context, event):
        if context.window is None:
            return self.execute(context)
        begin(context.scene)
        return {"FINISHED"}

    def run(self, context):
        scene = context.scene
        return make_sky.report(scene, _apply(scene, run(_drawing(_made(scene)))))


def _drawing(made: Any) -> Generator[Progress, None, Any]:
    from ..scene.world import simulated_sky

    return simulated_sky.drawing(made[0], QUALITY)


class SKYLIGHT_OT_stop_refining(bpy.types.Operator):
    """Stop refining the sky. It stays as it is"""

    bl_idname = "skylight.stop_refining"
    bl_label = "Stop Refining"

    @classmethod
    def poll(cls, context):
        """Whether there is anything to stop; else Esc means what it always means."""
        if _work is None:
            cls.poll_message_set("No sky is being refined")
        return _work is not None

    def execute(self, context):
        """End it."""
        drop()
        return {"FINISHED"}


CLASSES = (SKYLIGHT_OT_refine_sky, SKYLIGHT_OT_stop_refining)

_esc = EscKey("skylight.stop_refining")


def attach() -> None:
    """Let Esc stop it as long as a sky is refined."""
    _esc.attach()


def detach() -> None:
    """End it, and leave Esc as it was."""
    drop()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    _esc.detach()
