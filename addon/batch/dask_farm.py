"""Dask distributed: the pictures of a plan on the workers of a scheduler.

Workers need Blender, the plan's folder and Dask, but nothing of this package: what they run travels
to them by value. Import late: `distributed` is an extra, `pip install spectral-skylight[farm]`.
"""

from __future__ import annotations

import contextlib
import os
import queue
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import distributed
from distributed import Client, Future, WorkerPlugin

from .. import errors
from ..errors import InputError
from ..scene.output import plan_data
from . import task as task_module
from . import worker as worker_module
from .dispatch import CHUNK
from .task import Task, sources, task_of
from .worker import Worker, blender_command

CONNECT = 10.0
"""How long the scheduler may take to answer [s]."""

NEWS = 600.0
"""How long a worker is at work before it is heard of again, as far as a picture allows [s].

Long, for each chunk may open another prepared file; short enough for progress that one can watch.
"""

PATIENCE = 60.0
"""How long a run waits for the first worker with a Blender [s]."""


class Blenders(WorkerPlugin):
    """On a worker: as many Blenders as it has threads, kept from one chunk to the next.

    Its name is also that of a resource: the scheduler gives pictures to workers that have it.
    """

    def __init__(self, root: str, blender: str | None, timeout: float | None) -> None:
        self.root, self.blender, self.timeout = root, blender, timeout
        self.name = f"spectral-skylight {root}"
        self.scripts = sources()

    async def setup(self, worker: Any) -> None:
        """Offer the worker's threads, if it has a Blender and sees the plan."""
        self.idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        self.all: list[Worker] = []
        self.stopped = False
        blender_command(self.blender)
        if not Path(self.root).is_dir():
            raise InputError(self.root, "is not a folder on this worker", "share it")
        threads = worker.state.nthreads
        self.threads = 0 if threads == 1 else max(1, (os.cpu_count() or 1) // threads)
        await worker.set_resources(**{self.name: threads})

    async def teardown(self, worker: Any) -> None:
        """End all Blenders at once, with the pictures under way."""
        self.stopped = True
        await worker.set_resources(**{self.name: 0})
        for blender in self.all:
            blender.kill()

    def render(self, lines: Sequence[str]) -> list[dict[str, Any]]:
        """Do tasks, lines of a plan, and return their answers."""
        try:
            blender = self.idle.get_nowait()
        except queue.Empty:
            blender = Worker(self.root, self.blender, self.threads, self.scripts)
            self.all.append(blender)
        answers = []
        try:
            for line in lines:
                if self.stopped:
                    raise RuntimeError("the run has ended")
                answers.append(blender.render(task_of(line), self.timeout))
        finally:
            if self.stopped:
                blender.kill()  # which may have started since
            self.idle.put(blender)
        return answers


class DaskPool:
    """A scheduler's workers as a pool for `dispatch`; chunks of lost workers go to others."""

    def __init__(self, client: Client, name: str) -> None:
        self._client, self._name = client, name
        self.note: Callable[[Task, dict[str, Any]], None] = lambda task, answer: None
        self._away: dict[Future, Sequence[Task]] = {}
        self._done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._able: dict[str, int] = {}
        self._rendered, self._seconds = 0, 0.0
        self._asked = -PATIENCE

        # No function of the module: Dask would send that by its name.
        def render(lines: Sequence[str]) -> list[dict[str, Any]]:
            blenders: Any = distributed.get_worker().plugins[name]
            return blenders.render(lines)

        self._render = render

    def workers(self, age: float = 5.0) -> int:
        """Return how many Blenders can render, as of the last ``age`` seconds."""
        if time.monotonic() - self._asked >= age:
            with _scheduler_there():
                workers = self._client.scheduler_info(n_workers=-1)["workers"]
            offers = {at: round(w["resources"].get(self._name, 0)) for at, w in workers.items()}
            before, now = self._able, {at: count for at, count in offers.items() if count}
            self._asked, self._able = time.monotonic(), now or before
            if now and before and before.keys().isdisjoint(now):
                self._send_again()
            if not now:
                return 0
        return sum(self._able.values())

    def together(self) -> int:
        """Return how many pictures a worker is given at once: what it renders in `NEWS`."""
        if not self._rendered:
            return 1
        return max(1, min(CHUNK, int(NEWS * self._rendered / max(self._seconds, 1e-3))))

    def room(self) -> int:
        """One chunk for each Blender, and one in its hand."""
        return max(1, 2 * self.workers()) - len(self._away)

    def submit(self, chunk: Sequence[Task]) -> None:
        """Send a chunk to the scheduler."""
        lines = [task.line() for task in chunk]
        wanted = {self._name: 1}
        with _scheduler_there():
            future = self._client.submit(self._render, lines, pure=False, resources=wanted)
        self._away[future] = chunk
        future.add_done_callback(self._done.put)

    def finished(self) -> tuple[Sequence[Task], Sequence[dict[str, Any]]]:
        """Wait for a chunk; all of its pictures failed where Dask gave it up.

        Raises ConnectionError where the scheduler has gone, and what `note` raises.
        """
        while True:
            self.workers()
            with contextlib.suppress(queue.Empty):
                future = self._done.get(timeout=1)
                if future in self._away and (answers := self._answers(future)) is not None:
                    break
        chunk = self._away.pop(future)
        for task, answer in zip(chunk, answers, strict=True):
            if answer["status"] == "rendered":
                self._rendered += 1
                self._seconds += answer["seconds"]
            self.note(task, answer)
        return chunk, answers

    def _answers(self, future: Future) -> Sequence[dict[str, Any]] | None:
        """Return what came of a chunk; None where that went with its worker and comes again."""
        try:
            return future.result(timeout=5)
        except Exception as error:  # KilledWorker, CancelledError, what a worker raised
            self.workers(age=0)
            if future not in self._away:
                return None
            if isinstance(error, TimeoutError) and future.status != "error":
                self._done.put(future)
                return None
            reason = " ".join(str(error).split()) or type(error).__name__
            failure = {"status": "failed", "error": reason}
            return [{"index": task.index, **failure} for task in self._away[future]]

    def _send_again(self) -> None:
        """Send again what waits for workers that are all gone.

        Dask looks at such work when a worker comes, before that offers what the work asks for.
        """
        chunks = list(self._away.values())
        self.cancel()
        for chunk in chunks:
            self.submit(chunk)

    def cancel(self) -> None:
        """Take back all that is not done."""
        self._client.cancel(list(self._away))
        self._away.clear()


@contextlib.contextmanager
def _scheduler_there() -> Iterator[None]:
    try:
        yield
    except (OSError, RuntimeError, KeyError):
        said = (
            "the Dask scheduler has stopped. Finished pictures are kept; start it, then run again"
        )
        raise ConnectionError(said) from None


def travel_by_value() -> None:
    """Have what workers run travel with all that it needs: they have nothing of this package."""
    import cloudpickle

    ours = (worker_module, task_module, plan_data, errors)
    for module in (sys.modules[__name__], *ours):
        cloudpickle.register_pickle_by_value(module)


@contextlib.contextmanager
def dask_pool(
    address: str,
    root: str | Path,
    blender: str | None = None,
    timeout: float | None = None,
    patience: float = PATIENCE,
) -> Iterator[DaskPool]:
    """Connect to a scheduler, as ``tcp://host:8786``, and yield its workers as a pool.

    ``root``: the plan's folder, at the same path for every worker; ``blender``: its command on the
    workers; ``timeout``: of a picture [s]. However the block ends, nothing goes on
    rendering. Raises InputError where no scheduler answers or no worker can render.
    """
    from .online import check_online  # workers get this module's functions, not that one's

    check_online(address)
    travel_by_value()
    try:
        client = Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError) as error:
        said = " ".join(str(error).split())
        raise InputError(
            address, f"no Dask scheduler answers ({said})", "see dask scheduler"
        ) from None
    with client:
        plugin = Blenders(str(root), blender, timeout)
        pool = DaskPool(client, plugin.name)
        trouble = ""
        try:
            try:
                client.register_plugin(plugin)
            except Exception as error:  # of one worker: others may do, see below
                trouble = f": {error}"
            end = time.monotonic() + patience
            while pool.workers(age=0) == 0:
                if time.monotonic() > end:
                    count = len(client.scheduler_info(n_workers=-1)["workers"])
                    raise InputError(
                        address,
                        f"none of its {count} workers can render{trouble}",
                        "start dask worker where Blender and the plan's folder are",
                    )
                time.sleep(0.2)
            yield pool
        finally:
            with contextlib.suppress(OSError, RuntimeError):  # the scheduler may have gone
                pool.cancel()
                client.unregister_worker_plugin(plugin.name)
