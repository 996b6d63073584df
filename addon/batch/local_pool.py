"""This machine's workers, as `dispatch` wants them."""

from __future__ import annotations

import contextlib
import os
import queue
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .task import Task
from .worker import Worker

TOGETHER = 64
"""Pictures of one prepared file that a worker takes at once: opening and compiling take seconds."""


def useful_workers(engine: str | None, total: int) -> int:
    """Return how many processes render an engine's pictures fastest here, at most ``total``.

    Cycles draws with all cores of the processor, but opens, builds and saves with one: two
    processes for every four cores keep them busy (tests/benchmarks/test_batch_speed.py). Eevee's
    pictures come from one GPU, which a second process feeds while the first opens and saves.
    """
    useful = max(2, cores() // 2) if engine == "cycles" else 2
    return max(1, min(useful, cores(), total))


def cores() -> int:
    """Return how many processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


class LocalPool:
    """Worker processes, each with a thread that waits for it.

    ``root``, ``blender`` and ``timeout`` as `Worker` has them. ``note`` is called with each
    picture's answer as it comes, from those threads.
    """

    def __init__(
        self, root: Path, count: int, blender: str | None = None, timeout: float | None = None
    ) -> None:
        threads = 0 if count == 1 else max(1, cores() // count)
        self.note: Callable[[Task, dict[str, Any]], None] = lambda task, answer: None
        self._timeout, self._away = timeout, 0
        self._workers = [Worker(root, blender, threads) for _ in range(count)]
        self._work: queue.Queue[Sequence[Task] | None] = queue.Queue()
        self._done: queue.Queue[Any] = queue.Queue()
        for worker in self._workers:
            threading.Thread(target=self._serve, args=(worker,), daemon=True).start()

    def room(self) -> int:
        """Workers that have nothing to do."""
        return len(self._workers) - self._away

    def submit(self, chunk: Sequence[Task]) -> None:
        """Give a chunk to the next worker that is free."""
        self._away += 1
        self._work.put(chunk)

    def finished(self) -> tuple[Sequence[Task], Sequence[dict[str, Any]]]:
        """Wait for a chunk."""
        while True:
            with contextlib.suppress(queue.Empty):  # waiting for ever, Windows hears no Ctrl-C
                found = self._done.get(timeout=0.2)
                break
        if isinstance(found, BaseException):
            raise found
        self._away -= 1
        return found

    def close(self) -> None:
        """End all processes at once, with the pictures under way."""
        for worker in self._workers:
            self._work.put(None)
            worker.close()

    def _serve(self, worker: Worker) -> None:
        try:
            while (chunk := self._work.get()) is not None:
                answers = []
                for task in chunk:
                    answers.append(worker.render(task, self._timeout))
                    self.note(task, answers[-1])
                self._done.put((chunk, answers))
        except BaseException as error:  # for the thread that waits
            self._done.put(error)
