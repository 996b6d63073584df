"""All light, kept new while a person works: baked between events, and again after every change.

Where a World asks for `choices.AUTO`. Until the new light is there, the last one stays. Nothing of
it is an undo step: Blender's undo brings the light back that belongs to what it restores.
"""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import bpy

from ..choices import AUTO
from ..errors import InputError
from ..progress import Progress, a_while
from . import last_guard, under_way
from .esc import EscKey
from .labels import told
from .translation import translated

if TYPE_CHECKING:
    from ..scene.world.settings import Settings

PAUSE = 0.4
"""[s] without a change before work begins: a person who drags something is not done yet."""

SLICE = 0.05, 0.15
"""[s] of work between two looks at what a person does: more where Blender itself takes long."""


@dataclass
class Work:
    """One bake under way in a scene."""

    scene: str
    steps: Generator[Progress, None, list[str]]
    began: float = field(default_factory=time.monotonic)
    progress: Progress = field(default_factory=lambda: Progress(0.0, "geometry"))

    @property
    def left(self) -> float:
        """Seconds to go, as its pace so far tells; 0 as long as that tells nothing."""
        done = self.progress.done
        return 0.0 if done < 0.05 else (time.monotonic() - self.began) * (1.0 - done) / done


_work: Work | None = None
_asked: float | None = None  # when, by `time.monotonic`, as long as it has not begun
_lines: list[str] = []
_halt = ""
_ended = 0.0  # when, by `time.monotonic`, the last slice ended


def work() -> Work | None:
    """The bake under way, None without."""
    return _work


def waiting() -> bool:
    """Whether a bake is to begin as soon as a person pauses."""
    return _asked is not None


def lines() -> list[str]:
    """What the last bake had to say."""
    return _lines


def halt() -> str:
    """Why the last bake did not end; empty where it did."""
    return _halt


def ask() -> None:
    """Let all light be new soon; a bake under way begins again."""
    global _asked, _halt
    if bpy.app.background:
        return
    drop()
    _halt = ""
    _asked = time.monotonic()
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=PAUSE)


def follows(settings: Settings) -> bool:
    """Whether all light that settings ask for comes by itself after a change."""
    return settings.occlusion == AUTO and not bpy.app.background


def drop() -> None:
    """End the bake under way: what it has done stays."""
    global _work, _asked
    _asked = None
    if _work is not None:
        steps, _work = _work.steps, None
        steps.close()


def _tick() -> float | None:
    """Work for a moment; return in how many seconds to go on, None for not before asked again."""
    if _work is None and _asked is None:
        return None
    window = next(iter(bpy.context.window_manager.windows), None)
    if window is None or busy(window):
        return PAUSE
    with bpy.context.temp_override(window=window):
        if _asked is not None:
            wait = _asked + PAUSE - time.monotonic()
            if wait > 0.0:
                return wait
            if not _begin():
                return None
        _go_on()
    under_way.redraw(at_once=_work is None)
    return 0.01


def busy(window: bpy.types.Window) -> bool:
    """Whether a person is in the middle of something that the bake must not disturb."""
    return (
        bpy.app.is_job_running("RENDER")
        or window.screen.is_animation_playing
        or bool(window.modal_operators)
    )


def _begin() -> bool:
    """Begin what was asked for, where the scene asks for all light."""
    from ..scene.world.settings import stored
    from . import properties

    global _work, _asked
    _asked = None
    scene = bpy.context.scene
    settings = stored(scene.world)
    if settings is None or settings.occlusion != AUTO:
        return False
    from ..scene import use_cases

    if not use_cases.in_scene(scene):
        return False
    _lines.clear()
    steps = use_cases.following(scene, properties.settings_of(scene.world))
    _work = Work(scene.name, steps)
    return True


def _go_on() -> None:
    """Do some of the work."""
    from ..scene import out_of_date
    from . import staleness_handlers

    global _work, _ended, _halt
    current = _work
    assert current is not None
    start = time.monotonic()
    seconds = min(max(SLICE[0], start - _ended), SLICE[1])
    try:
        with staleness_handlers.ours(bpy.context):
            current.progress = a_while(current.steps, seconds)
    except StopIteration as done:
        _lines[:] = done.value
        _work = None
        out_of_date.all_baked(bpy.context.scene)
        staleness_handlers.found_bakes()
        staleness_handlers.look()
    except InputError as error:
        _halt, _work = told(error), None
    except Exception as error:  # a timer that fails is not called again
        _halt, _work = last_guard.line(error), None
    _ended = time.monotonic()


class SKYLIGHT_OT_stop_light(bpy.types.Operator):
    """Stop computing the light. What is there stays, and the next change begins anew"""

    bl_idname = "skylight.stop_light"
    bl_label = "Stop Light"

    @classmethod
    def poll(cls, context):
        """Whether there is anything to stop; else Esc means what it always means."""
        running = _work is not None or _asked is not None
        if not running:
            cls.poll_message_set(translated("No light is being computed"))
        return running

    def execute(self, context):
        """End it; what the bake tidies up then is no change to follow."""
        from . import staleness_handlers

        global _halt
        with staleness_handlers.ours(context):
            drop()
        _halt = "Stopped: not all light"
        return {"FINISHED"}


CLASSES = (SKYLIGHT_OT_stop_light,)

_esc = EscKey("skylight.stop_light")


def attach() -> None:
    """Let Esc stop the bake as long as there is one."""
    _esc.attach()


def detach() -> None:
    """End the bake, and leave Esc as it was."""
    drop()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    _esc.detach()
