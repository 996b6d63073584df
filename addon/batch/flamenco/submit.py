"""A plan as a job of Flamenco's Manager, and sending it there."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from ...errors import InputError, parameter
from ...scene.output import plan_data
from ..dispatch import CHUNK, Picture, chunks
from ..plan import read_header, read_tasks
from ..report import record
from ..run import unprepared
from ..task import Task, scripts_hash, sources
from .manager import Manager

SCRIPT = Path(__file__).with_name("spectral_skylight.js")
"""The job type, for the folder ``scripts`` beside the Manager's executable."""

JOB_TYPE = SCRIPT.stem.replace("_", "-")
"""As the Manager calls it, after the file."""

WORKERS = 10
"""Of a farm of which nothing is known."""

PREVIEWS = (3, 8)
"""The first version of Flamenco that shows previews and progress of such a job."""


def job_of(
    plan: str | Path,
    size: int = CHUNK,
    workers: int = WORKERS,
    priority: int = 50,
    report: bool = False,
) -> dict[str, Any]:
    """Return a plan as a job, what Flamenco's API calls a SubmittedJob.

    Paths are those of this machine: the Manager's two-way variables make them those of the
    workers. ``size`` and ``workers`` decide how many pictures a task has, as in `dispatch.chunks`;
    ``report`` has a worker write the report in the end. Raises InputError for a file that is no
    plan or not prepared.
    """
    plan = Path(plan).resolve()
    header = read_header(plan)
    name = Path(header["study"]).stem
    if missing := unprepared(plan):
        cure = f"run batch plan STUDY.toml with {parameter('prepare')}"
        raise InputError(plan, f"{missing} is not prepared", cure)
    for script, content in sources().items():
        copy = plan_data.inside(plan.parent, script, ".py")
        if not copy.is_file() or copy.read_bytes() != content:
            raise InputError(copy, "is not this program's script", "plan the study again")
    names: list[str] = []
    animated = any(a.camera == b.camera for a, b in pairwise(read_tasks(plan, 0, 2)))

    def named() -> Iterator[list[Task]]:
        for chunk in chunks(read_tasks(plan), size, header["tasks"], workers):
            names.append(task_name(chunk, record(plan.parent, chunk[0].blend), animated))
            yield chunk

    pictures = picture_ranges(named())
    return {
        "name": f"{name}, {header['tasks']} pictures",
        "type": JOB_TYPE,
        "priority": priority,
        "submitter_platform": platform.system().lower(),  # as Go's GOOS: linux, windows, darwin
        "settings": {
            "plan": str(plan),
            "pictures": pictures,
            "names": "\n".join(names),
            "report": report,
            "scripts": scripts_hash(),
        },
        "metadata": {"project": name},
    }


def task_name(
    chunk: Sequence[Task], prepared: dict[str, Any] | None, animated: bool = False
) -> str:
    """Return the name of a task by which a person finds its pictures: scene, sky, cameras.

    ``prepared``: what is known of the file that they are rendered from, see `report.record`;
    ``animated``: whether frames are to be named.
    """
    known = prepared or {"scene": Path(chunk[0].blend).stem.partition(".")[0]}
    place = ", ".join(str(known[key]) for key in ("scene", "variant", "sky") if known.get(key))
    frames: dict[str, list[int]] = {}
    for task in chunk:
        frames.setdefault(task.camera, []).append(task.frame)
    cameras = list(frames)
    if animated:
        cameras = [
            f"{camera} {numbers[0]}" + (f"-{numbers[-1]}" if len(numbers) > 1 else "")
            for camera, numbers in frames.items()
        ]
    if len(cameras) > 3:
        cameras = [f"{cameras[0]} to {cameras[-1]}"]
    return " ".join(f"{place}: {', '.join(cameras)}".split())


def picture_ranges(work: Iterable[Sequence[Picture]]) -> str:
    """Return chunks as the job type reads them: ``"0-79/12,80-99/10"``, in twelves, then tens."""
    ranges: list[tuple[int, int, int]] = []
    for chunk in work:
        first, last, size = chunk[0].index, chunk[-1].index, len(chunk)
        if ranges:
            start, end, pieces = ranges[-1]
            if end + 1 == first and (first - start) % pieces == 0 and size <= pieces:
                ranges[-1] = (start, last, pieces)
                continue
        ranges.append((first, last, size))
    return ",".join(f"{first}-{last}/{size}" for first, last, size in ranges)


def workers_of(manager: str, tag: str | None = None) -> int:
    """Return how many workers a Manager can hope for; raises InputError as `submit` does."""
    asked = Manager(manager)
    return asked.workers(None if tag is None else asked.tag(tag))


def lacks(manager: str) -> str:
    """Say what a Manager is too old for, empty where that is nothing or its version is unknown."""
    version = Manager(manager).version()
    if version is None or version >= PREVIEWS:
        return ""
    old, needed = (".".join(map(str, each)) for each in (version, PREVIEWS))
    return f"Flamenco {old} shows neither previews nor progress of this job: {needed} or newer does"


def submit(manager: str, job: dict[str, Any], tag: str | None = None) -> str:
    """Send a job to a Manager, ``http://host:8080``, and return the address of its page there.

    ``tag``: the name of those workers' tag that may render it; None: all. Raises InputError where
    nobody answers, the Manager lacks the job type or the tag, or refuses the job.
    """
    asked = Manager(manager)
    kind = asked.job_type(JOB_TYPE, SCRIPT)
    settings = [setting.get("key") for setting in kind.get("settings", ())]
    if settings and not job["settings"].keys() <= set(settings):
        cure = f'copy {SCRIPT} into its folder "scripts" again'
        raise InputError(asked.address, f"has the job type {JOB_TYPE} of another version", cure)
    chosen = {} if tag is None else {"worker_tag": asked.tag(tag)}
    return asked.send({**job, **chosen, "type_etag": kind["etag"]})
