"""A plan as a job of Flamenco's Manager, and sending it there.

https://flamenco.blender.org/development/flamenco-api/; nothing is sent anywhere but to the address
that the user gives.
"""

from __future__ import annotations

import contextlib
import json
import platform
import urllib.error
import urllib.request
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ...errors import InputError, parameter
from ..dispatch import CHUNK, Picture, chunks
from ..online import check_online
from ..plan import read_header, read_tasks
from ..run import unprepared

SCRIPT = Path(__file__).with_name("spectral_skylight.js")
"""The job type, for the folder ``scripts`` beside the Manager's executable."""

JOB_TYPE = SCRIPT.stem.replace("_", "-")
"""As the Manager calls it, after the file."""

WORKERS = 10
"""Of a farm of which nothing is known."""


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
    ``report`` has a worker with this command write the report in the end. Raises InputError for
    a file that is no plan or not prepared.
    """
    plan = Path(plan).resolve()
    header = read_header(plan)
    name = Path(header["study"]).stem
    if missing := unprepared(plan):
        cure = f"run batch plan STUDY.toml with {parameter('prepare')}"
        raise InputError(plan, f"{missing} is not prepared", cure)
    pictures = picture_ranges(chunks(read_tasks(plan), size, header["tasks"], workers))
    return {
        "name": f"{name}, {header['tasks']} pictures",
        "type": JOB_TYPE,
        "priority": priority,
        "submitter_platform": platform.system().lower(),  # as Go's GOOS: linux, windows, darwin
        "settings": {"plan": str(plan), "pictures": pictures, "report": report},
        "metadata": {"project": name},
    }


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


def workers_of(manager: str) -> int:
    """Return how many workers a Manager can hope for; raises InputError as `submit` does."""
    with _answers(manager):
        workers = _call(f"{_address(manager)}/api/v3/worker-mgt/workers")["workers"]
        return max(1, sum(worker["status"] not in ("offline", "error") for worker in workers))


def submit(manager: str, job: dict[str, Any]) -> str:
    """Send a job to a Manager, ``http://host:8080``, and return the address of its page there.

    Raises InputError where nobody answers, the Manager lacks the job type or refuses the job.
    """
    address = _address(manager)
    with _answers(manager):
        kind = _call(f"{address}/api/v3/jobs/type/{JOB_TYPE}")
        made = _call(f"{address}/api/v3/jobs", {**job, "type_etag": kind["etag"]})
        return f"{address}/app/jobs/{made['id']}"


def _address(manager: str) -> str:
    if not manager.startswith(("http://", "https://")):
        raise InputError(
            parameter("manager"), f'"{manager}" is not an address', "write http://HOST:8080"
        )
    return manager.rstrip("/")


@contextlib.contextmanager
def _answers(manager: str) -> Iterator[None]:
    """Say in a line what is wrong with a Manager's answer."""
    try:
        yield
    except urllib.error.HTTPError as error:
        if error.code == 404:
            cure = f'copy {SCRIPT} into the folder "scripts" beside flamenco-manager'
            raise InputError(manager, f"does not know the job type {JOB_TYPE}", cure) from None
        raise InputError(manager, f"refuses ({_said(error)})", "see its log") from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        reason = str(getattr(error, "reason", error))
        raise InputError(
            manager, f"does not answer as a Flamenco Manager ({reason})", "check it"
        ) from None


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any) -> None:
        return None


def _call(address: str, content: dict[str, Any] | None = None) -> dict[str, Any]:
    data = None if content is None else json.dumps(content).encode()
    request = urllib.request.Request(address, data, {"Content-Type": "application/json"})
    check_online(address)
    # To this address and no other: neither a proxy nor where the answer may point.
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}), _NoRedirect)
    with opener.open(request, timeout=60) as answer:
        return json.load(answer)


def _said(error: urllib.error.HTTPError) -> str:
    try:
        return str(json.load(error)["message"])
    except (OSError, ValueError, KeyError, TypeError):
        return f"{error.code} {error.reason}"
