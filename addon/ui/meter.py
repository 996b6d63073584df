"""The light meter: at the 3D cursor, an object or a camera's eye, on a button or live.

What it reads is no part of the file: it is kept as long as Blender is open.
"""

# No postponed annotations here: Blender reads properties from them.
# mypy: disable-error-code="valid-type"

from collections.abc import Generator
from typing import Any

import bpy

from ..errors import InputError
from ..progress import Progress, a_while
from . import false_colour, follow, last_guard, operator, panels, properties, under_way
from .labels import told
from .translation import translated

PLACES = (
    ("CURSOR", "3D Cursor", "At the 3D cursor, looking along its Z axis"),
    ("OBJECT", "Object", "At the active object, such as an Empty, looking along its Z axis"),
    ("CAMERA", "Camera", "Vertical light at the eye of the scene's camera"),
)

PAUSE = 0.3
"""[s] that the meter has rested before it is read."""

SLICE = 0.05
"""[s] of work between two looks at what a person does."""

_read: dict[str, list[str]] = {}  # by scene, what was read last
_work: Generator[Progress, None, Any] | None = None
_at: tuple = ()  # where and in which light the meter was read last, or is read now
_seen: tuple = ()  # where it was when it was last looked for


def _switched(self, context) -> None:
    global _at
    _at = ()
    if self.live and not bpy.app.background and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=PAUSE)


class SkylightMeter(bpy.types.PropertyGroup):
    """Where the meter of a scene stands."""

    place: bpy.props.EnumProperty(name="Place", items=PLACES, description="Where to measure")
    live: bpy.props.BoolProperty(
        name="Live",
        description="Read the meter again whenever it or the light has changed",
        update=_switched,
    )


def places(context: bpy.types.Context, kind: str) -> Any:
    """Where a meter of a kind stands and looks, `scene.meter.places.Places`.

    Raises InputError without an active object or camera.
    """
    from ..scene.meter import places as meters

    scene = context.scene
    if kind == "CAMERA":
        return meters.eye(meters.camera(scene, None))
    if kind == "OBJECT":
        obj = context.view_layer.objects.active
        if obj is None:
            raise InputError("the scene", "has no active object", "select one, or use the cursor")
        matrix = obj.matrix_world
    else:
        matrix = scene.cursor.matrix
    return meters.single(matrix.translation, matrix.col[2].to_3d())


def _measuring(context: bpy.types.Context, kind: str) -> Generator[Progress, None, Any]:
    from ..scene import use_cases

    settings = properties.settings_of(context.scene.world)
    return use_cases.measuring(context.scene, settings, places(context, kind))


def _lines(done: Any) -> list[str]:
    """What is shown of what was measured."""
    if done.inside[0]:
        return ["Inside something solid"]
    lines = done.readings.lines(0, done.calibration.absolute)
    return lines if done.calibration.absolute else [*lines, "Relative: set Lux on the Level"]


class SKYLIGHT_OT_measure(operator.Long, bpy.types.Operator):
    """Measure the light: lux, melanopic lux, luminance and color temperature. Press Esc to stop"""

    bl_idname = "skylight.measure"
    bl_label = "Measure Light"
    bl_options = {"REGISTER"}
    doing = "Measuring"

    place: bpy.props.EnumProperty(
        name="Place",
        description="Where to measure",
        items=(("PANEL", "As in the Panel", "Where the scene's meter stands"), *PLACES),
    )

    @classmethod
    def disabled_reason(cls, context):
        return operator.no_sky(context)

    def work(self, context):
        """The generator that measures."""
        kind = context.scene.skylight_meter.place if self.place == "PANEL" else self.place
        return _measuring(context, kind)

    def finish(self, context, done):
        """Show what was read."""
        if done is None:
            return [("WARNING", "Nothing was measured")]
        _read[context.scene.name] = _lines(done)
        return [("INFO", line) for line in done.lines()]


class SKYLIGHT_PT_meter(panels.Child, bpy.types.Panel):
    """What the light is at one place."""

    bl_label = "Light Meter"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 60

    def draw(self, context):
        layout = self.layout
        scene = context.scene
        layout.row().prop(scene.skylight_meter, "place", expand=True)
        row = layout.row(align=True)
        row.operator("skylight.measure", text=translated("Measure"), translate=False)
        row.prop(scene.skylight_meter, "live", toggle=True)
        column = layout.column(align=True)
        for line in _read.get(scene.name, ()):
            column.label(text=translated(line), translate=False)
        if scene.world is not None:
            layout.prop(scene.world.skylight, "level_lux")
        false_colour.draw(layout)


def _tick() -> float | None:
    """Let the meter of the first window's scene go on; None once it is live no more."""
    window = next(iter(bpy.context.window_manager.windows), None)
    if window is None or not window.scene.skylight_meter.live:
        _stop()
        return None
    if follow.work() is not None or follow.waiting() or bpy.app.is_job_running("RENDER"):
        _stop()
        return PAUSE
    with bpy.context.temp_override(window=window):
        return go_on(bpy.context)


def go_on(context: bpy.types.Context) -> float:
    """Look for the scene's meter, or read it for a moment; return seconds until the next time."""
    global _work, _at, _seen
    scene = context.scene
    try:
        found = _key(context)
        rested, _seen = found == _seen, found
        if found != _at:
            _stop()
            if not rested:
                return PAUSE
            _at = found
            _work = _measuring(context, scene.skylight_meter.place)
        if _work is None:
            return PAUSE
        a_while(_work, SLICE)
        return 0.01
    except StopIteration as done:
        _work = None
        _read[scene.name] = _lines(done.value)
    except InputError as error:
        _stop()
        _read[scene.name] = [told(error)]
    except Exception as error:  # a timer that fails is not called again
        _stop()
        _read[scene.name] = [last_guard.line(error)]
    under_way.redraw(at_once=True)
    return PAUSE


def _key(context: bpy.types.Context) -> tuple:
    """Where the meter stands, and which light is known."""
    from ..scene.bake import session

    scene = context.scene
    at = places(context, scene.skylight_meter.place)
    lux = scene.world.skylight.level_lux if scene.world is not None else 0.0
    return (scene.name, *at.points.ravel(), *at.normals.ravel(), lux, session.lit_by())


def _stop() -> None:
    global _work
    if _work is not None:
        _work.close()
        _work = None


CLASSES = (SkylightMeter, SKYLIGHT_OT_measure, SKYLIGHT_PT_meter)


def attach() -> None:
    """Give scenes their meter."""
    bpy.types.Scene.skylight_meter = bpy.props.PointerProperty(type=SkylightMeter)


def detach() -> None:
    """Take it away again."""
    _stop()
    _read.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    del bpy.types.Scene.skylight_meter
