"""What the add-on's operators share: when they may run, and how they end."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path
from typing import Any

import bpy

from ..errors import InputError
from ..progress import Progress, a_while, run
from . import staleness_handlers, under_way
from .labels import told
from .translation import translated


class Thin:
    """Mixin of an operator whose `run` calls one function and returns lines for the person.

    `InputError` becomes one reported line and CANCELLED: the rooms check before they change.
    """

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the button can be pressed; it says why not."""
        reason = cls.disabled_reason(context)
        if reason:
            cls.poll_message_set(translated(reason))  # type: ignore[attr-defined]
        return not reason

    @classmethod
    def disabled_reason(cls, context: bpy.types.Context) -> str:
        """Why the operator cannot run here, empty where it can."""
        return ""

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run, and report what came of it."""
        try:
            with _busy(context), staleness_handlers.at_work():
                lines = self.run(context)
        except InputError as error:
            self.report({"ERROR"}, translated(told(error)))  # type: ignore[attr-defined]
            return {"CANCELLED"}
        staleness_handlers.after(context)
        for level, line in lines:
            self.report({level}, translated(line))  # type: ignore[attr-defined]
        return {"FINISHED"}

    def run(self, context: bpy.types.Context) -> Iterable[tuple[str, str]]:
        """Do it; return (level, line) pairs, level INFO or WARNING."""
        raise NotImplementedError


SLICE = 0.15
"""[s] of work between two looks at the keyboard."""


class Long(Thin):
    """Mixin of an operator whose work takes long: pressed, it shows progress and Esc ends it.

    A script's call runs to the end at once. `work` is a generator that can be closed at any yield
    and leaves things whole then, so that what was done is one undo step.
    """

    doing = ""
    """What the status bar and the panel say is done."""

    stopped = False
    """Whether Esc has ended the work, and its `rest` is done."""

    asked = False
    """Whether a person is asked for something first, after whose answer Blender calls `execute`."""

    def work(self, context: bpy.types.Context) -> Generator[Progress, None, Any]:
        """Yield `progress.Progress`, and return what `finish` reports on."""
        raise NotImplementedError

    def finish(self, context: bpy.types.Context, done: Any) -> Iterable[tuple[str, str]]:
        """Do what follows; ``done``: what `work` returned, None where it was ended before.

        Without more to do `work` returns the lines itself.
        """
        return [("WARNING", "Stopped")] if done is None else done

    def run(self, context: bpy.types.Context) -> Iterable[tuple[str, str]]:
        """Work to the end."""
        return self.finish(context, run(self.work(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run to the end, or where a person has answered, work on between events."""
        if self.asked and context.window is not None:
            self.asked = False  # a change in the panel of the last operation has no events
            return self._start(context)
        return super().execute(context)

    def rest(self, context: bpy.types.Context) -> Generator[Progress, None, Any] | None:
        """What is still to be done once Esc has ended the work, None for nothing.

        It returns what `finish` reports on; a second Esc ends that too.
        """
        return None

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Start, and work on between events until done."""
        return self.execute(context) if context.window is None else self._start(context)

    def _start(self, context: bpy.types.Context) -> set[str]:
        try:
            self.generator = self.work(context)
        except InputError as error:
            self.report({"ERROR"}, told(error))  # type: ignore[attr-defined]
            return {"CANCELLED"}
        manager = context.window_manager
        self.timer = manager.event_timer_add(SLICE / 10, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Work for a moment, or end."""
        if event.type == "ESC":
            self.generator.close()
            rest = None if self.stopped else self.rest(context)
            if rest is None:
                self._tidy(context)
                return self._end(context, None)
            self.generator, self.stopped = rest, True
        if event.type == "TIMER":
            try:
                with staleness_handlers.at_work():
                    progress = a_while(self.generator, SLICE)
            except StopIteration as done:
                self._tidy(context)
                return self._end(context, done.value)
            except InputError as error:  # the rooms check before they change
                self._tidy(context)
                self.report({"ERROR"}, translated(told(error)))  # type: ignore[attr-defined]
                return {"CANCELLED"}
            except Exception:
                self._tidy(context)
                raise
            under_way.show(self.doing, progress)
            context.window_manager.progress_update(100 * progress.done)
            doing, line = translated(self.doing), translated(progress.line)
            text = f"{doing} {line}: {100 * progress.done:.0f} %. Press Esc to stop"
            context.workspace.status_text_set(translated(text))
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """End, as Blender asks when a file is closed."""
        self.generator.close()
        self._tidy(context)

    def _tidy(self, context: bpy.types.Context) -> None:
        under_way.show("", None)
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _end(self, context: bpy.types.Context, done: Any) -> set[str]:
        """Report; FINISHED makes one undo step of all that was done."""
        try:
            with staleness_handlers.at_work():
                lines = self.finish(context, done)
        except InputError as error:
            lines = [("ERROR", told(error))]
        staleness_handlers.after(context)
        for level, line in lines:
            self.report({level}, translated(line))  # type: ignore[attr-defined]
        return {"FINISHED"}


def no_sky(context: bpy.types.Context) -> str:
    """Why the scene has no sky, empty where it has a World."""
    from ..scene.world import hdri

    try:
        hdri.sky_of(context.scene.world)
    except InputError as error:
        return told(error)
    return ""


def of_light(scene: bpy.types.Scene) -> list[tuple[str, str]]:
    """What is left out of a scene's light, and what a picture must say as long as not all is in."""
    from ..scene import out_of_date
    from ..scene.world import light_group

    found = light_group.record_of(scene.world)
    if found is None:
        return []
    return [*(("WARNING", line) for line in found.warnings), ("INFO", out_of_date.caption(scene))]


def folder() -> str:
    """Where a file browser opens: beside the blend file, its name not in the field of the file's.

    At home as long as nothing is saved.
    """
    path = Path(bpy.data.filepath).parent if bpy.data.filepath else Path.home()
    return f"{path}{os.sep}"


def thumbnails() -> Any:
    """The property by which Blender's file browser opens with pictures (`eFileDisplayType`)."""
    return bpy.props.EnumProperty(
        items=(("DEFAULT", "Default", "", 0), ("THUMBNAIL", "Thumbnails", "", 3)),
        default="THUMBNAIL",
        options={"HIDDEN"},
    )


def browse(operator: bpy.types.Operator, context: bpy.types.Context) -> set[str]:
    """Open the file browser for an operator that wants a file, as its `invoke`."""
    context.window_manager.fileselect_add(operator)
    return {"RUNNING_MODAL"}


@contextlib.contextmanager
def _busy(context: bpy.types.Context) -> Iterator[None]:
    """Show that work goes on: a large HDRI takes a second or two."""
    manager = context.window_manager
    manager.progress_begin(0, 1)
    try:
        yield
    finally:
        manager.progress_end()
