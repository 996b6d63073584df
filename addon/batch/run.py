"""Rendering what of a plan is not there yet, and what came of each picture."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..atomic_file import clear_parts
from .dispatch import CHUNK, Number, Pool, chunks, dispatch
from .plan import read_header, read_tasks
from .task import Task

RESULTS = "results.jsonl"
"""Beside the plan: the answer to each picture as it came, a line each, of all runs."""


@dataclass
class Outcome:
    """How many pictures were rendered, found whole and failed, and why the run ended early."""

    total: int
    rendered: int = 0
    skipped: int = 0
    failures: list[str] = field(default_factory=list)
    stopped: str = ""

    @property
    def left(self) -> int:
        """Pictures that the run has yet to come to."""
        return self.total - self.rendered - self.skipped - len(self.failures)

    @property
    def complete(self) -> bool:
        """Whether every picture is there."""
        return self.rendered + self.skipped == self.total


Tell = Callable[[Outcome, float | None], None]
"""Is given the outcome so far, and the time left [s] where it is known."""


class NoSpace(Exception):
    """No space is left: every picture would fail, and none should be rendered for nothing."""


def run(
    plan: Path,
    pool: Pool[Task],
    tell: Tell,
    size: Number = CHUNK,
    workers: Number = 1,
) -> Outcome:
    """Render what of a plan is not there yet, by the workers of a pool.

    A failing picture is tried twice more, after the others. The caller holds the folder's `lock`
    and closes the pool. ``size`` and ``workers`` as in `dispatch.chunks`.
    """
    outcome = Outcome(read_header(plan)["tasks"])
    clock, lock, noted = _Clock(), threading.Lock(), set[int]()
    with (plan.parent / RESULTS).open("a", encoding="utf-8", errors="backslashreplace") as log:

        def note(task: Task, answer: dict[str, Any]) -> None:
            status = answer["status"]
            with lock:
                if status != "skipped":
                    line = {**answer, "key": task.key}
                    log.write(json.dumps(line, ensure_ascii=False) + "\n")
                    log.flush()
                noted.add(task.index)
                outcome.rendered += status == "rendered"
                outcome.skipped += status == "skipped"
                tell(outcome, clock.left(outcome))
            if answer.get("no_space"):
                raise NoSpace(answer["error"])

        if hasattr(pool, "note"):  # it tells of each picture as it is done, not chunk by chunk
            pool.note = note
        work = chunks(read_tasks(plan), size, outcome.total, workers)
        try:
            for task, answer in dispatch(work, pool):
                if task.index not in noted:
                    note(task, answer)
                noted.discard(task.index)
                if answer["status"] == "failed":
                    outcome.failures.append(answer["error"])
                    tell(outcome, clock.left(outcome))
        except NoSpace as stop:
            outcome.stopped = str(stop)
    return outcome


def unprepared(plan: Path) -> str:
    """Return the first prepared file that a plan's tasks miss, empty where none is missing."""
    last = ""
    for task in read_tasks(plan):
        if task.blend != last and not (plan.parent / task.blend).is_file():
            return task.blend
        last = task.blend
    return ""


def clear_leftovers(out: Path) -> None:
    """Remove what dead processes of this machine left half-written under a plan's folder."""
    for folder in (out, out / "prepared", *out.glob("pictures/*")):
        clear_parts(folder)


class _Clock:
    """Time left, by a clock that nobody sets."""

    def __init__(self) -> None:
        self.start = time.monotonic()

    def left(self, outcome: Outcome) -> float | None:
        """Return the time [s] that the pictures yet to come will take; None before the first."""
        if not outcome.rendered:
            return None
        return outcome.left * (time.monotonic() - self.start) / outcome.rendered
