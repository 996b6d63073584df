"""Work that says how far it is: a generator that yields `Progress` and returns what it made.

A button goes on with it between two events and a command draws a bar. Whoever closes it ends the
work, which leaves whole what was done until then. What takes long and cannot be cut into steps goes
`aside`, so that a window is alive meanwhile.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Generator, Iterator
from contextvars import ContextVar, copy_context
from dataclasses import dataclass, replace
from typing import Any, TypeVar

Step = TypeVar("Step")
Done = TypeVar("Done")
Other = TypeVar("Other")

PATIENCE = 0.01
"""[s] that a window waits for what goes aside before it looks at its events again."""


@dataclass(frozen=True)
class Progress:
    """How far work is: ``done`` from 0 to 1, and in ``line`` what it is at.

    ``waits``: there is nothing to do now but to wait for what goes aside.
    """

    done: float
    line: str
    waits: bool = False


def run(work: Generator[Step, None, Done], tell: Callable[[Step], object] = lambda _: None) -> Done:
    """Do all the work, ``tell`` of each step, and return what it made."""
    while True:
        try:
            step = next(work)
        except StopIteration as end:
            return end.value
        tell(step)


def mapped(
    work: Generator[Step, None, Done], to: Callable[[Step], Other]
) -> Generator[Other, None, Done]:
    """Do work as a part of other work: yield what ``to`` makes of each step, and return its result.

    Closed, it closes the work.
    """
    try:
        while True:
            try:
                step = next(work)
            except StopIteration as end:
                return end.value
            yield to(step)
    finally:
        work.close()


def timed(
    work: Generator[Step, None, Done],
) -> Generator[Step, None, tuple[Done, float]]:
    """Do work as a part of other work; return its result and the processor time [s] that it took.

    Closed, it closes the work.
    """
    seconds = 0.0
    try:
        while True:
            start = time.process_time()
            try:
                step = next(work)
            except StopIteration as end:
                return end.value, seconds + time.process_time() - start
            seconds += time.process_time() - start
            yield step
    finally:
        work.close()


_between_events: ContextVar[bool] = ContextVar("between_events", default=False)
_own: ContextVar[_Aside | None] = ContextVar("own", default=None)
_turn = threading.Lock()
"""One at a time goes aside: what was dropped may still be at it, and each takes memory."""


@contextlib.contextmanager
def between_events() -> Iterator[None]:
    """Do steps while a window waits: what goes `aside` has a thread of its own."""
    before = _between_events.set(True)
    try:
        yield
    finally:
        _between_events.reset(before)


def is_between_events() -> bool:
    """Whether a window waits for what is done now."""
    return _between_events.get()


def a_while(work: Generator[Progress, None, Any], seconds: float) -> Progress:
    """Work between two events for about so long, or until there is only waiting; how far it is.

    Raises StopIteration at its end, which holds what it returned.
    """
    until = time.monotonic() + seconds
    with between_events():
        step = next(work)
        while not step.waits and time.monotonic() < until:
            step = next(work)
    return step


def aside(
    step: Progress, work: Callable[..., Done], *given: Any
) -> Generator[Progress, None, Done]:
    """Do ``work`` on what is ``given`` and return its result, yielding ``step`` as long as it goes.

    Without a window that is at once. Between events it has a thread of its own: NumPy lets others
    go on meanwhile, but Blender's data belong to the main thread, which `on_main` asks. Closed, it
    leaves the work to end by itself, unheard.
    """
    if not _between_events.get():
        return work(*given)
    thread = _Aside(work, given)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(PATIENCE)
            thread.answer()
            yield replace(step, waits=True)
    finally:
        thread.drop()
    return thread.result()


def on_main(ask: Callable[[], Done]) -> Done:
    """Call a function on the main thread, wherever this is called, and return what it returns."""
    own = _own.get()
    return ask() if own is None else own.ask(ask)


class _Dropped(BaseException):
    """Nobody waits for this work any more."""


class _Aside(threading.Thread):
    """Work in a thread of its own, and what it asks of the main one."""

    def __init__(self, work: Callable[..., Any], given: tuple[Any, ...]) -> None:
        super().__init__(daemon=True)  # Blender may be quit meanwhile
        self._work = work, given
        self._values = copy_context()
        self._dropped = False
        self._value: Any = None
        self._error: BaseException | None = None
        self._question: Callable[[], Any] | None = None
        self._answered = threading.Event()
        self._answer: tuple[Any, BaseException | None] = None, None

    def run(self) -> None:
        with _turn:
            if self._dropped:
                return
            try:
                self._value = self._values.run(self._go)
            except BaseException as error:
                self._error = error

    def _go(self) -> Any:
        _between_events.set(False)
        _own.set(self)
        work, given = self._work
        return work(*given)

    def ask(self, question: Callable[[], Any]) -> Any:
        """Wait for the main thread's answer."""
        self._answered.clear()
        self._question = question
        while not self._answered.wait(1.0) and not self._dropped:
            pass
        if self._dropped:
            raise _Dropped
        value, error = self._answer
        if error is not None:
            raise error
        return value

    def answer(self) -> None:
        """Answer what is asked, if anything is."""
        question, self._question = self._question, None
        if question is None:
            return
        try:
            self._answer = question(), None
        except Exception as error:
            self._answer = None, error
        self._answered.set()

    def drop(self) -> None:
        """Wait no longer."""
        self._dropped = True
        self._answered.set()

    def result(self) -> Any:
        """What the work has returned; raises what it has raised."""
        if self._error is not None:
            raise self._error
        return self._value
