"""Which pictures of a plan are rendered next, together, and again.

One policy for the workers of a farm and for the simulation of a thousand of them in
the benchmarks: it knows neither Blender nor clocks, only a pool that takes chunks of pictures and
gives them back with an answer for each.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Protocol, TypeVar

CHUNK = 12
"""Pictures that a worker is given at once, where nothing else is said."""


class Picture(Protocol):
    """What of a task counts here, see `task.Task`."""

    @property
    def index(self) -> int: ...
    @property
    def blend(self) -> str: ...


P = TypeVar("P", bound=Picture)
Number = int | Callable[[], int]
"""One that stands, or one that is asked for again and again."""

Answer = dict[str, Any]
"""What `render_task.perform` says of a picture; ``status`` is ``failed`` where it is not there."""


class Pool(Protocol[P]):
    """Workers that render chunks, in any order."""

    def room(self) -> int:
        """Chunks that may be given to it now; at least 1 while it has none."""

    def submit(self, chunk: Sequence[P]) -> None:
        """Begin a chunk."""

    def finished(self) -> tuple[Sequence[P], Sequence[Answer]]:
        """Wait for a chunk, and return it with an answer for each of its pictures."""


def chunks(
    pictures: Iterable[P], size: Number = CHUNK, total: int | None = None, workers: Number = 1
) -> Iterator[list[P]]:
    """Cut a plan into chunks of consecutive pictures of one prepared file, at most `size` each.

    With the plan's `total` the chunks shrink towards its end, to half of an equal share of what is
    left for each of the `workers`, so that all of them end together (guided self-scheduling, DOI
    10.1109/TC.1987.5009495).
    """
    done, most, chunk = 0, 1, list[P]()
    for picture in pictures:
        if chunk and (picture.blend != chunk[0].blend or len(chunk) >= most):
            yield chunk
            done, chunk = done + len(chunk), []
        if not chunk:
            most, count = _now(size), _now(workers)
            if total is not None and count > 1:
                most = max(1, min(most, -(-(total - done) // (2 * count))))
        chunk.append(picture)
    if chunk:
        yield chunk


def _now(number: Number) -> int:
    return number() if callable(number) else number


def dispatch(
    work: Iterator[Sequence[P]], pool: Pool[P], tries: int = 3
) -> Iterator[tuple[P, Answer]]:
    """Have all chunks rendered; yield each picture once, with the answer that counts.

    A picture that fails is tried again, alone and after all others, `tries` times in all. `work` is
    read only as far as the pool has room: what is held is as small for a plan of a million
    pictures as for one of ten.
    """
    again: deque[Sequence[P]] = deque()
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
        chunk, answers = pool.finished()
        away -= 1
        for picture, answer in zip(chunk, answers, strict=True):
            if answer["status"] == "failed":
                failures[picture.index] += 1
                if failures[picture.index] < tries:
                    again.append([picture])
                    continue
                answer = {**answer, "tries": tries}
            yield picture, answer
