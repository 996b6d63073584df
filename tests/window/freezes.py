"""How long Blender's window stands still, and what of that is the add-on's doing.

Loaded beside `agent` inside Blender. A timer beats as often as the window looks at its events: what
lies between two beats is a freeze. Of it, ours is the processor time that the main thread has spent
in the add-on's operators, timer, handlers and panels, less what Blender has evaluated of the scene
meanwhile. Processor time, not time by the clock: tests share their machine.
"""

import functools
import importlib
import inspect
import sys
import threading
import time
from collections import Counter
from dataclasses import dataclass, field

import bpy
from bpy.app.handlers import persistent

PACKAGE = "bl_ext.user_default.spectral_skylight"
CALLS = "execute", "invoke", "modal", "draw", "draw_item", "draw_filter", "filter_items"
BEAT = 0.01
SAMPLE = 0.01
"""[s] between two looks at where the main thread is."""


@dataclass
class Step:
    """What a person did, and the worst that it brought: [s] by the clock, of our processor time,
    and what that was in."""

    name: str
    longest: float = 0.0
    ours: float = 0.0
    what: str = ""
    where: Counter = field(default_factory=Counter)


class Freezes:
    """Watches from its making on."""

    def __init__(self) -> None:
        self.steps = [Step("start")]
        self._inside = False
        self._blender = self._since = 0.0
        self._sum, self._calls = 0.0, Counter()
        self._samples: list[tuple[float, str]] = []
        self._last = time.perf_counter()
        self._main = threading.get_ident()
        self._wrap()
        threading.Thread(target=self._sample, daemon=True).start()
        bpy.app.timers.register(self._beat, persistent=True)

    def begin(self, name: str) -> None:
        """What happens from now on belongs to another step."""
        self._beat()
        self.steps.append(Step(name))

    def table(self) -> list[tuple[str, float, float, str, str]]:
        """Of each step its name, the longest freeze, the longest of ours, and what that was in."""
        self._beat()
        return [
            (
                s.name,
                s.longest,
                s.ours,
                s.what,
                "; ".join(f"{t:.2f} {w}" for w, t in s.where.most_common(4)),
            )
            for s in self.steps
        ]

    def _wrap(self) -> None:
        registration = importlib.import_module(PACKAGE + ".addon.registration")
        for cls in registration.CLASSES:
            for name in CALLS:
                if hasattr(cls, name) and issubclass(
                    cls, bpy.types.Operator | bpy.types.Panel | bpy.types.UIList | bpy.types.Menu
                ):
                    setattr(cls, name, self._timed(f"{cls.__name__}.{name}", getattr(cls, name)))
        follow = importlib.import_module(PACKAGE + ".addon.ui.follow")
        follow._tick = self._timed("follow", follow._tick)
        pictures = importlib.import_module(PACKAGE + ".addon.ui.preview_cache")
        pictures._work = self._timed("pictures", pictures._work)
        ours = importlib.import_module(PACKAGE + ".addon.ui.staleness_handlers")
        for name, handler in ours.HANDLERS.items():
            handlers = getattr(bpy.app.handlers, name)
            handlers[handlers.index(handler)] = self._timed(name, handler)

        @persistent
        def evaluates(*_) -> None:
            self._since = time.thread_time()

        @persistent
        def evaluated(*_) -> None:
            self._blender += time.thread_time() - self._since

        bpy.app.handlers.depsgraph_update_pre.insert(0, evaluates)
        bpy.app.handlers.depsgraph_update_post.insert(0, evaluated)

    def _timed(self, name, call):
        def go(*given):
            if self._inside:
                return call(*given)
            self._inside, self._blender = True, 0.0
            start = time.thread_time()
            try:
                return call(*given)
            finally:
                self._inside = False
                own = time.thread_time() - start - self._blender
                self._sum += own
                self._calls[name] += own

        if (code := getattr(call, "__code__", None)) is None or code.co_flags & inspect.CO_VARARGS:
            timed = go
        else:  # Blender looks how many arguments there are
            names = ", ".join(code.co_varnames[: code.co_argcount])
            timed = eval(f"lambda {names}: go({names})", {"go": go})
        return functools.update_wrapper(timed, call)

    def _beat(self) -> float:
        now, step = time.perf_counter(), self.steps[-1]
        step.longest = max(step.longest, now - self._last)
        if self._sum > step.ours:
            step.ours = self._sum
            step.what = ", ".join(name for name, _ in self._calls.most_common(2))
            step.where = Counter()
            before = self._last
            for at, where in self._samples:
                step.where[where] += at - before
                before = at
        self._sum, self._calls, self._samples, self._last = 0.0, Counter(), [], now
        return BEAT

    def _sample(self) -> None:
        """Note which of our lines the main thread is in: what Blender does holds us up, too."""
        while True:
            time.sleep(SAMPLE)
            frame = sys._current_frames().get(self._main)
            lines = []
            while frame is not None and len(lines) < 3:
                name = frame.f_code.co_filename
                if "spectral_skylight" in name:
                    short = name.rpartition("/")[2]
                    lines.append(f"{short}:{frame.f_lineno}")
                frame = frame.f_back
            if lines:
                self._samples.append((time.perf_counter(), " < ".join(lines)))
