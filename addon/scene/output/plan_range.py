"""Pictures of a plan in one Blender, as a farm starts it: what it says, leaves and returns.

A picture that fails does not fail its range: a farm counts failed ranges, and ends the job or
shuts out the worker for a few of them. A last check fails, with the list. A copy of this file lies
beside each plan of a batch, so it imports nothing of the package.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO, Any

if __package__:
    from ...atomic_file import host
    from . import plan_data
    from .image_file import made_by
else:  # a copy beside a plan
    import plan_data  # type: ignore[no-redef]
    from atomic_file import host  # type: ignore[no-redef]
    from image_file import made_by  # type: ignore[no-redef]

ANSWER = "skylight-task "
"""What an answer's line starts with: Blender greets on stdout before any script can stop it."""

RESULTS = "results"
"""Beside the plan: ``results.jsonl`` of runs there, and a folder with a file of each range."""

Task = dict[str, Any]
"""A line of a plan, see `batch.task.Task`."""

Answer = dict[str, Any]
"""What became of a task, see `render_task.perform`."""


def planned(plan: Path, first: int = 0, count: int | None = None) -> Iterator[Task]:
    """Give a plan's tasks, ``count`` of them from number ``first`` on, but for its header."""
    with plan.open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, start=-1):
            if number >= first and (count is None or number < first + count):
                yield plan_data.task(line)


def render(
    tasks: Iterable[Task], root: Path, perform: Callable[[Task], Answer], out: IO[str]
) -> int:
    """Render a range and return the exit code: 1 where this machine can render no more of it.

    ``perform`` does a task and returns its answer. ``out`` is told of each picture, also in the
    words by which Flamenco's workers know previews and progress; where nobody listens any more,
    the one that started this is gone, and so is the need for the pictures to come.
    """
    counts: Counter[str] = Counter()
    with _Results(root) as results:
        for task in tasks:
            answer = perform(task)
            counts[answer["status"]] += 1
            results.add(task, answer)
            if answer.get("no_space") or answer.get("wrong_blender"):
                _say(out, ANSWER + json.dumps(answer), answer["error"])
                return 1
            if not _say(out, ANSWER + json.dumps(answer), *_for_flamenco(task, root, answer)):
                return 1
    said = ", ".join(f"{number} {status}" for status, number in counts.items())
    _say(out, said or "nothing to render")
    return 0


def _for_flamenco(task: Task, root: Path, answer: Answer) -> list[str]:
    """Return what Blender itself would print of a frame: a worker takes its lines for news."""
    if answer["status"] == "failed":
        lines = [f"Failed, and the others go on: {answer['error']}"]
    else:
        lines = [f"Saved: '{root / task['exr'].removesuffix('.exr')}.png'"]
    minutes, seconds = divmod(answer["seconds"], 60.0)
    return [*lines, f"Time: {minutes:02.0f}:{seconds:05.2f}"]


def _say(out: IO[str], *lines: str) -> bool:
    """Print lines; whether anybody still reads them."""
    try:
        print(*lines, sep="\n", file=out, flush=True)
    except OSError:
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), out.fileno())  # or closing it fails again
        return False
    return True


def lacks(task: Task, root: Path) -> str:
    """Say why a picture is not there, by whichever build of Blender; empty where it is."""
    try:
        made_by(plan_data.inside(root, task["exr"], ".exr"), task["key"])
    except (OSError, ValueError) as error:
        return str(getattr(error, "strerror", None) or error)
    return ""


def check(tasks: Iterable[Task], root: Path, out: IO[str]) -> int:
    """Render nothing and list what is missing of a range, and why; 1 where that is anything."""
    known = answers(root)
    total, missing = 0, list[str]()
    for task in tasks:
        total += 1
        answer: Answer = {"index": task["index"], "status": "skipped"}
        if reason := lacks(task, root):
            said = known.get(task["key"], {}).get("failed", {}).get("error")
            missing.append(said or f"{root / task['exr']}: is not there, or not whole ({reason})")
            answer |= {"status": "failed", "error": missing[-1]}
        _say(out, ANSWER + json.dumps(answer))
    if missing:
        _say(out, f"{len(missing)} of {total} pictures are missing:", *missing)
    else:
        _say(out, f"All {total} pictures are there")
    return 1 if missing else 0


def answers(root: Path) -> dict[str, dict[str, Answer]]:
    """Return the last answers known beside a plan, by key and ``rendered`` or ``failed``.

    What is no answer is passed over: a process may be killed while it writes.
    """
    found: dict[str, dict[str, Answer]] = {}
    for path in [root / f"{RESULTS}.jsonl", *sorted((root / RESULTS).glob("*.jsonl"))]:
        if not path.is_file():
            continue
        with contextlib.suppress(OSError), path.open(encoding="utf-8", errors="replace") as file:
            for line in file:
                with contextlib.suppress(ValueError):
                    answer = plan_data.answer(line)
                    found.setdefault(answer["key"], {})[answer["status"]] = answer
    return found


class _Results:
    """What becomes of a range's pictures, in a file that no other process writes to."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._file: IO[str] | None = None

    def __enter__(self) -> _Results:
        return self

    def __exit__(self, *_: Any) -> None:
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.close()

    def add(self, task: Task, answer: Answer) -> None:
        """Note an answer; a disk without room for that is told by the pictures."""
        if answer["status"] == "skipped":
            return
        try:
            if self._file is None:
                (self._root / RESULTS).mkdir(exist_ok=True)
                name = f"{RESULTS}/{task['index']:06d}.{host()}-{os.getpid()}.jsonl"
                path = plan_data.inside(self._root, name, ".jsonl")
                self._file = path.open("a", encoding="utf-8", errors="backslashreplace")
            line = {**answer, "key": task["key"], "host": host()}
            self._file.write(json.dumps(line, ensure_ascii=False) + "\n")
            self._file.flush()
        except (OSError, ValueError) as error:
            print(f"{self._root / RESULTS} cannot be written: {error}", file=sys.stderr)
