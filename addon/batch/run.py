"""Rendering a plan on this machine: worker processes, progress, and what came of each picture."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import InputError
from . import dispatch
from .lock import locked
from .plan import read_header, read_tasks
from .task import Task
from .worker import Worker

TOGETHER = 64
"""Pictures of one prepared file that a worker takes at once: opening and compiling take seconds."""


@dataclass
class Outcome:
    """How many pictures were rendered, found whole and failed, and why the run ended early."""

    total: int
    rendered: int = 0
    skipped: int = 0
    failures: dict[int, str] = field(default_factory=dict)
    stopped: str = ""

    @property
    def done(self) -> int:
        """Pictures that need nothing more in this run."""
        return self.rendered + self.skipped + len(self.failures)

    @property
    def complete(self) -> bool:
        """Whether every picture is there."""
        return self.rendered + self.skipped == self.total


def run(
    plan: str | Path,
    workers: int | None = None,
    blender: str | Path | None = None,
    timeout: float | None = None,
    tell: Callable[[Outcome, float | None], None] = lambda outcome, left: None,
) -> Outcome:
    """Render what of a plan is not there yet.

    A failing picture is tried twice more, after the others. `results.jsonl` beside the plan notes
    each as it is done. Interrupted, it ends its workers; what was done stays.

    Parameters
    ----------
    workers
        Processes; None: `useful_workers`.
    blender
        An executable, see `worker.blender_command`.
    timeout
        [s] for one picture; None: none.
    tell
        Is given the outcome so far and the time left [s], None where it is unknown.

    Raises
    ------
    InputError
        No plan, prepared files that are missing, or no Blender. The folder is to be `locked`.
    """
    plan = Path(plan).resolve()
    total = read_header(plan)["tasks"]
    missing = next((t for t in read_tasks(plan) if not (plan.parent / t.blend).is_file()), None)
    if missing is not None:
        raise InputError(plan, f"{missing.blend} is not prepared", "run it from its study")
    engine = next((task.engine for task in read_tasks(plan, 0, 1)), None)
    count = workers or useful_workers(engine, total)
    clear_leftovers(plan.parent)
    outcome, clock = Outcome(total), _Clock()
    with (
        contextlib.closing(_Pool(plan, count, blender, timeout)) as pool,
        (plan.parent / RESULTS).open("a", encoding="utf-8") as log,
    ):

        def told(task: Task, answer: dict[str, Any]) -> None:
            if answer["status"] != "skipped":
                log.write(json.dumps({**answer, "key": task.key}, ensure_ascii=False) + "\n")
                log.flush()
            if answer["status"] == "failed":
                return  # `dispatch` says whether for good
            outcome.rendered += answer["status"] == "rendered"
            outcome.skipped += answer["status"] == "skipped"
            tell(outcome, clock.left(outcome))

        pool.told = told
        files = (task.blend for task in read_tasks(plan))
        work = dispatch.chunks(files, TOGETHER, total, count)
        try:
            for number, result in dispatch.dispatch(work, pool):
                if isinstance(result, str):
                    outcome.failures[number] = result
                    tell(outcome, clock.left(outcome))
        except _NoSpace as stop:
            outcome.stopped = str(stop)
    return outcome


RESULTS = "results.jsonl"


def useful_workers(engine: str | None, total: int) -> int:
    """Return how many processes render an engine's pictures fastest here, at most ``total``.

    Cycles (on the processor) draws with all cores, but opens, builds and saves with one. Eevee's
    pictures come from one GPU, which a second process keeps busy while the first prepares.
    """
    affinity = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity else os.cpu_count() or 1
    useful = max(1, cores // 2) if engine == "cycles" else 2
    return max(1, min(useful, cores, total))


def clear_leftovers(out: Path) -> None:
    """Take away what dead processes of this machine left half-written under a plan's folder."""
    host = "".join(c for c in socket.gethostname() if c.isalnum() or c == "-")
    for folder in ("pictures", "prepared", "."):
        depth = "*/.*" if folder == "pictures" else ".*"
        for path in (out / folder).glob(depth):
            if f".{host}." in path.name and ".part" in path.name:
                path.unlink(missing_ok=True)


class _NoSpace(Exception):
    """No space is left: every picture would fail, and none should be rendered for nothing."""


class _Clock:
    """Time left, by a clock that nobody sets."""

    def __init__(self) -> None:
        self.start = time.monotonic()

    def left(self, outcome: Outcome) -> float | None:
        """Return the time [s] that the pictures which are left will take, None before the first."""
        worked = outcome.rendered + len(outcome.failures)
        if not worked:
            return None
        return (outcome.total - outcome.done) * (time.monotonic() - self.start) / worked


class _Pool:
    """Worker processes as `dispatch` wants them, a thread each."""

    def __init__(
        self, plan: Path, count: int, blender: str | Path | None, timeout: float | None
    ) -> None:
        cores = os.cpu_count() or 1
        threads = 0 if count == 1 else max(1, cores // count)
        self.plan, self.timeout = plan, timeout
        self.told: Callable[[Task, dict[str, Any]], None] = lambda task, answer: None
        self._workers = [Worker(plan.parent, blender, threads) for _ in range(count)]
        self._work: queue.Queue[range | None] = queue.Queue()
        self._done: queue.Queue[Any] = queue.Queue()
        self._away = 0
        self._lock = threading.Lock()
        self._threads = [
            threading.Thread(target=self._serve, args=(worker,), daemon=True)
            for worker in self._workers
        ]
        for thread in self._threads:
            thread.start()

    def room(self) -> int:
        return len(self._workers) - self._away

    def submit(self, chunk: range) -> None:
        self._away += 1
        self._work.put(chunk)

    def finished(self) -> tuple[range, Mapping[int, dict], Mapping[int, str]]:
        while True:
            with contextlib.suppress(queue.Empty):  # waiting for ever, Windows hears no Ctrl-C
                found = self._done.get(timeout=0.2)
                break
        if isinstance(found, BaseException):
            raise found
        self._away -= 1
        return found

    def close(self) -> None:
        for _ in self._workers:
            self._work.put(None)
        for worker in self._workers:
            worker.close()

    def _serve(self, worker: Worker) -> None:
        try:
            while (chunk := self._work.get()) is not None:
                results, errors = {}, {}
                for task in read_tasks(self.plan, chunk.start, len(chunk)):
                    answer = worker.render(task, self.timeout)
                    if answer["status"] == "failed":
                        errors[task.index] = answer["error"]
                    else:
                        results[task.index] = answer
                    with self._lock:
                        self.told(task, answer)
                    if answer.get("no_space"):
                        raise _NoSpace(answer["error"])
                self._done.put((chunk, results, errors))
        except BaseException as error:  # the main thread raises it
            self._done.put(error)


@contextlib.contextmanager
def ended_gently() -> Iterator[None]:
    """Let a request to end (SIGTERM) do what Ctrl-C does."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def bar(outcome: Outcome) -> Any:
    """Return a bar of progress on stderr, whose time left is `run`'s."""
    from tqdm import tqdm

    form = "{desc} {percentage:3.0f}% {bar:20} {n_fmt}/{total_fmt}{postfix}"
    return tqdm(total=outcome.total, file=sys.stderr, bar_format=form, desc="pictures")


__all__ = ["Outcome", "clear_leftovers", "ended_gently", "locked", "run", "useful_workers"]
