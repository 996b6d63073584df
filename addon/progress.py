"""Work that says how far it is: a generator that yields `Progress` and returns what it made.

A button goes on with it between two events and a command draws a bar. Whoever closes it ends the
work, which leaves whole what was done until then.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TypeVar

Step = TypeVar("Step")
Done = TypeVar("Done")


@dataclass(frozen=True)
class Progress:
    """How far work is: ``done`` from 0 to 1, and in ``line`` what it is at."""

    done: float
    line: str


def run(work: Generator[Step, None, Done], tell: Callable[[Step], object] = lambda _: None) -> Done:
    """Do all the work, ``tell`` of each step, and return what it made."""
    while True:
        try:
            step = next(work)
        except StopIteration as end:
            return end.value
        tell(step)


def mapped(
    work: Generator[Step, None, Done], to: Callable[[Step], Progress]
) -> Generator[Progress, None, Done]:
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
