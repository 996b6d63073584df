"""What the add-on's operators share: when they may run, and how they end."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator

import bpy

from ..errors import InputError
from . import wheels


class Thin:
    """Mixin of an operator whose `run` calls one function and returns lines for the person.

    `InputError` becomes one reported line and CANCELLED: the rooms check before they change.
    """

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether the button can be pressed; it says why not."""
        reason = wheels.missing() or cls.hindrance(context)
        if reason:
            cls.poll_message_set(reason)  # type: ignore[attr-defined]
        return not reason

    @classmethod
    def hindrance(cls, context: bpy.types.Context) -> str:
        """Why the operator cannot run here, empty where it can."""
        return ""

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run, and report what came of it."""
        try:
            with _busy(context):
                lines = self.run(context)
        except InputError as error:
            self.report({"ERROR"}, str(error))  # type: ignore[attr-defined]
            return {"CANCELLED"}
        for level, line in lines:
            self.report({level}, line)  # type: ignore[attr-defined]
        return {"FINISHED"}

    def run(self, context: bpy.types.Context) -> Iterable[tuple[str, str]]:
        """Do it; return (level, line) pairs, level INFO or WARNING."""
        raise NotImplementedError


def no_sky(context: bpy.types.Context) -> str:
    """Why the scene's World lights nothing, empty where it has an HDRI."""
    from ..scene import world

    try:
        world.sky_of(context.scene.world)
    except InputError as error:
        return str(error)
    return ""


def caption(world: bpy.types.World) -> str:
    """What a picture under a World must say as long as not all light is in it."""
    from ..scene import sky_light

    found = sky_light.description_of(world)
    return found["caption"] if found else ""


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
