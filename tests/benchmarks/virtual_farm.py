"""A farm in virtual time: a pool for `dispatch` whose workers need no machine, and may die."""

from __future__ import annotations

import heapq
from collections import deque
from dataclasses import dataclass, field
from itertools import count
from typing import NamedTuple

import numpy as np

LOAD, SKIP = 3.0, 0.05
"""Seconds to open a prepared file, and to find a picture finished."""


class Picture(NamedTuple):
    """What of a task counts here."""

    index: int
    blend: str


@dataclass
class Worker:
    """One Blender: what it renders, since when, and whether its machine is still there."""

    chunk: list[Picture] | None = None
    pictures: deque[Picture] = field(default_factory=deque)
    blend: str = ""
    since: float = 0.0
    alive: bool = True


class VirtualFarm:
    """A scheduler as Dask's or Flamenco's: a lost worker's chunk goes to another, once noticed.

    `seconds` (pictures,) is what each takes; `deaths` maps a worker to the time of its end. Its
    Blender, an `orphan`, goes on until the end of the "picture" or "chunk" under way, or is gone as
    well, "no". `start` is what each chunk costs where it starts a Blender of its own, else 0.
    Pictures in `broken` fail whenever they are tried, others with the probability `flaky`.
    """

    def __init__(
        self,
        seconds: np.ndarray,
        workers: int,
        deaths: dict[int, float],
        notice: float = 60.0,
        start: float = 0.0,
        orphan: str = "picture",
        broken: frozenset[int] = frozenset(),
        flaky: float = 0.0,
        seed: int = 1,
    ) -> None:
        self.seconds, self.notice, self.start, self.orphan = seconds, notice, start, orphan
        self.broken, self.flaky, self.rng = broken, flaky, np.random.default_rng(seed)
        self.workers = [Worker() for _ in range(workers)]
        self.idle = deque(range(workers))
        self.waiting: deque[list[Picture]] = deque()
        self.finished_chunks: deque = deque()
        self.known = workers
        self.now, self.order, self.events = 0.0, count(), []
        self.whole: set[int] = set()
        self.renders: list[int] = []
        self.lost = 0.0
        self.away = self.most_away = 0
        self.failed: set[int] = set()
        for worker, time in deaths.items():
            self._at(time, self._death, worker)

    # The pool that `dispatch` sees.

    def room(self):
        return 2 * self.known - self.away

    def submit(self, chunk):
        self.away += 1
        self.most_away = max(self.most_away, self.away)
        self.waiting.append(chunk)
        self._assign()

    def finished(self):
        while not self.finished_chunks:
            self.now, _, happens, argument = heapq.heappop(self.events)
            happens(argument)
        self.away -= 1
        chunk = self.finished_chunks.popleft()
        failed = {picture.index for picture in chunk} & self.failed
        self.failed -= failed
        return chunk, [{"status": "failed" if p.index in failed else "rendered"} for p in chunk]

    # What happens meanwhile.

    def _at(self, time, happens, argument):
        heapq.heappush(self.events, (time, next(self.order), happens, argument))

    def _assign(self):
        while self.waiting and self.idle:
            worker = self.workers[number := self.idle.popleft()]
            worker.chunk = self.waiting.popleft()
            worker.pictures = deque(worker.chunk)
            if self.start:
                worker.blend = ""
                self._at(self.now + self.start, self._next, number)
            else:
                self._next(number)

    def _next(self, number):
        """Begin the worker's next picture, or hand its chunk back."""
        worker = self.workers[number]
        if not worker.alive and (self.orphan != "chunk" or not worker.pictures):
            return
        if not worker.pictures:
            self.finished_chunks.append(worker.chunk)
            worker.chunk = None
            self.idle.append(number)
            self._assign()
            return
        picture, blend = worker.pictures[0]
        worker.since, takes = self.now, SKIP
        if picture not in self.whole:
            takes = self.seconds[picture] + LOAD * (worker.blend != blend)
            worker.blend = blend
        self._at(self.now + takes, self._picture, (number, picture, takes > SKIP))

    def _picture(self, event):
        """A picture's end: moved into place, failed, or rendered for nobody."""
        number, picture, rendered = event
        worker = self.workers[number]
        if not worker.alive and self.orphan == "no":
            return
        failed = rendered and (picture in self.broken or self.rng.random() < self.flaky)
        if rendered:
            self.renders.append(picture)
        if failed and worker.alive:
            self.failed.add(picture)
        elif not failed:
            self.lost += (self.now - worker.since) * (rendered and picture in self.whole)
            self.whole.add(picture)
        worker.pictures.popleft()
        self._next(number)

    def _death(self, number):
        worker = self.workers[number]
        worker.alive = False
        if worker.chunk is None:
            self.idle.remove(number)
        elif self.orphan == "no":
            self.lost += self.now - worker.since
        self._at(self.now + self.notice, self._noticed, number)

    def _noticed(self, number):
        self.known -= 1
        if self.workers[number].chunk is not None:
            self.waiting.appendleft(self.workers[number].chunk)
            self._assign()
