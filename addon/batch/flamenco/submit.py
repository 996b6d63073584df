"""A plan as a job of Flamenco's Manager, and sending it there.

https://flamenco.blender.org/development/flamenco-api/; nothing is sent anywhere but to the address
that the user gives.
"""

from __future__ import annotations

import json
import platform
import urllib.error
import urllib.request
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ...errors import InputError
from ..dispatch import CHUNK, Picture
from ..plan import read_header, read_tasks
from ..run import unprepared

SCRIPT = Path(__file__).with_name("spectral_skylight.js")
"""The job type, for the folder ``scripts`` beside the Manager's executable."""

JOB_TYPE = SCRIPT.stem.replace("_", "-")
"""As the Manager calls it, after the file."""


def job_of(
    plan: str | Path, size: int = CHUNK, priority: int = 50, report: bool = False
) -> dict[str, Any]:
    """Return a plan as a job, what Flamenco's API calls a SubmittedJob.

    Paths are those of this machine: the Manager's two-way variables make them those of the
    workers. ``size`` bounds the pictures of one task; ``report`` has a worker with this command
    write the report in the end. Raises InputError for a file that is no plan or not prepared.
    """
    plan = Path(plan).resolve()
    total = read_header(plan)["tasks"]
    if missing := unprepared(plan):
        cure = "batch plan STUDY.toml --prepare"
        raise InputError(plan, f"{missing} is not prepared", cure)
    pictures = picture_ranges(read_tasks(plan), size)
    return {
        "name": f"{plan.parent.name}, {total} pictures",
        "type": JOB_TYPE,
        "priority": priority,
        "submitter_platform": platform.system().lower(),  # as Go's GOOS: linux, windows, darwin
        "settings": {"plan": str(plan), "pictures": pictures, "report": report},
        "metadata": {"project": plan.parent.name},
    }


def picture_ranges(pictures: Iterable[Picture], size: int) -> str:
    """Return the ranges of a job, ``"0-79/12,80-99/12"``: no task needs two prepared files."""
    ranges: list[list[int]] = []
    blend = None
    for picture in pictures:
        new = not ranges or ranges[-1][1] != picture.index - 1
        if new or (picture.blend != blend and (picture.index - ranges[-1][0]) % size):
            ranges.append([picture.index, picture.index])
        ranges[-1][1], blend = picture.index, picture.blend
    return ",".join(f"{first}-{last}/{size}" for first, last in ranges)


def submit(manager: str, job: dict[str, Any]) -> str:
    """Send a job to a Manager, ``http://host:8080``, and return the address of its page there.

    Raises InputError where nobody answers, the Manager lacks the job type or refuses the job.
    """
    manager = manager.rstrip("/")
    if not manager.startswith(("http://", "https://")):
        raise InputError("--manager", f'"{manager}" is no address', "write http://HOST:8080")
    try:
        kind = _call(f"{manager}/api/v3/jobs/type/{JOB_TYPE}")
        made = _call(f"{manager}/api/v3/jobs", {**job, "type_etag": kind["etag"]})
    except urllib.error.HTTPError as error:
        if error.code == 404:
            cure = f'copy {SCRIPT} into the folder "scripts" beside flamenco-manager'
            raise InputError(manager, f"does not know the job type {JOB_TYPE}", cure) from None
        raise InputError(manager, f"refuses the job ({_said(error)})", "see its log") from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        reason = str(getattr(error, "reason", error))
        raise InputError(manager, f"is no Manager that answers ({reason})", "check it") from None
    return f"{manager}/app/jobs/{made['id']}"


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any) -> None:
        return None


def _call(address: str, content: dict[str, Any] | None = None) -> dict[str, Any]:
    data = None if content is None else json.dumps(content).encode()
    request = urllib.request.Request(address, data, {"Content-Type": "application/json"})
    # To this address and no other: neither a proxy nor where the answer may point.
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}), _NoRedirect)
    with opener.open(request, timeout=60) as answer:
        return json.load(answer)


def _said(error: urllib.error.HTTPError) -> str:
    try:
        return str(json.load(error)["message"])
    except (OSError, ValueError, KeyError, TypeError):
        return f"{error.code} {error.reason}"
