"""Which pictures of a plan are rendered next, together, and again.

One policy for worker processes here, for a farm's workers, and for the simulation of a thousand of
them in the benchmarks: it knows neither Blender nor clocks, only a pool that takes chunks of
pictures and gives them back.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import Protocol, TypeVar

Result = TypeVar("Result", covariant=True)

CHUNK = 12
"""Pictures that one start of Blender renders, where nothing else is said."""


class Pool(Protocol[Result]):
    """Workers that render chunks, in any order."""

    def room(self) -> int:
        """Chunks that may be given to it now without waiting."""

    def submit(self, chunk: range) -> None:
        """Begin a chunk: pictures by their place in the plan."""

    def finished(self) -> tuple[range, Mapping[int, Result], Mapping[int, str]]:
        """Wait for a chunk, and return it with the results and the errors of its pictures."""


def chunks(
    files: Iterable[str], size: int = CHUNK, total: int | None = None, workers: int = 1
) -> Iterator[range]:
    """Cut a plan into chunks of pictures of one prepared file, at most `size` each.

    `files` has the prepared file of each picture, in the plan's order. With their `total` the
    chunks shrink towards the end, to half of an equal share of what is left for each of the
    `workers`, so that all of them end together (guided self-scheduling, DOI
    10.1109/TC.1987.5009495).
    """
    first = 0
    for _, group in groupby(files):
        end = first + sum(1 for _ in group)
        while first < end:
            share = size if total is None else -(-(total - first) // (2 * workers))
            count = max(1, min(size, share, end - first))
            yield range(first, first + count)
            first += count


def dispatch(
    work: Iterator[range], pool: Pool[Result], tries: int = 3
) -> Iterator[tuple[int, Result | str]]:
    """Have all chunks rendered; yield each picture once, with its result or its last error.

    A picture that fails is tried again, alone and after all others, `tries` times in all. `work` is
    read only as far as the pool has room: what is held is as small for a plan of a million
    pictures as for one of ten.
    """
    again: deque[range] = deque()
    failures: Counter[int] = Counter()
    away = 0
    while True:
        while pool.room() > 0:
            chunk = next(work, None) or (again.popleft() if again else None)
            if chunk is None:
                break
            pool.submit(chunk)
            away += 1
        if not away:
            return
        chunk, results, errors = pool.finished()
        away -= 1
        for number in chunk:
            if number in results:
                yield number, results[number]
                continue
            failures[number] += 1
            if failures[number] < tries:
                again.append(range(number, number + 1))
            else:
                yield number, errors[number]
