"""Asking a Flamenco Manager, and saying in plain words what it answers.

https://flamenco.blender.org/development/flamenco-api/; nothing is sent anywhere but to the address
that the user gives.
"""

from __future__ import annotations

import http.client
import json
import re
import urllib.error
import urllib.request
from typing import Any
from urllib.parse import urlsplit

from ...errors import InputError, parameter
from ..online import check_online


class Manager:
    """A Manager by its address, ``http://host:8080``, or one of its pages in a browser.

    Raises InputError for what is no address; its methods raise InputError where nobody answers,
    or no Manager, or with a refusal.
    """

    def __init__(self, address: str) -> None:
        self.address = _without_page(address)

    def job_type(self, name: str, script: object) -> dict[str, Any]:
        """Return a job type; ``script`` is named where the Manager does not have it."""
        try:
            found = self._call(f"jobs/type/{name}")
        except _NotFound as error:
            if not error.said:
                raise
            cure = f'copy {script} into the folder "scripts" beside flamenco-manager'
            raise InputError(self.address, f"does not know the job type {name}", cure) from None
        self._need(found, "etag")
        return found

    def version(self) -> tuple[int, int] | None:
        """Return its version, as (3, 8); None where it does not say."""
        try:
            found = re.match(r"v?(\d+)\.(\d+)", str(self._call("version")["version"]))
        except (InputError, KeyError):
            return None
        return (int(found[1]), int(found[2])) if found else None

    def tag(self, name: str) -> str:
        """Return the identifier of a tag of workers by its name."""
        tags = self._list(self._call("worker-mgt/tags"), "tags")
        known = {str(tag.get("name")): str(tag.get("id")) for tag in tags}
        if name not in known:
            held = ", ".join(f'"{each}"' for each in known) or "none"
            raise InputError(self.address, f'has no worker tag "{name}"', f"it has {held}")
        return known[name]

    def workers(self, tag: str | None = None) -> int:
        """Return how many workers it can hope for, of those with a tag's identifier."""
        workers = self._list(self._call("worker-mgt/workers"), "workers")
        alive = [each for each in workers if each.get("status") not in ("offline", "error")]
        if tag is not None:
            told = [self._call(f"worker-mgt/workers/{each.get('id')}") for each in alive]
            alive = [one for one in told if tag in [own.get("id") for own in one.get("tags") or []]]
        return max(1, len(alive))

    def send(self, job: dict[str, Any]) -> str:
        """Send a job, a SubmittedJob, and return the address of its page."""
        made = self._call("jobs", job)
        self._need(made, "id")
        return f"{self.address}/app/jobs/{made['id']}"

    def _list(self, found: dict[str, Any], key: str) -> list[dict[str, Any]]:
        content = found.get(key) or []  # Go leaves an empty list out, or writes null
        if not isinstance(content, list) or not all(isinstance(each, dict) for each in content):
            raise self._stranger(f"{key} is no list")
        return content

    def _need(self, found: dict[str, Any], key: str) -> None:
        if key not in found:
            raise self._stranger(f"no {key} in its answer")

    def _call(self, path: str, content: dict[str, Any] | None = None) -> dict[str, Any]:
        """Return the answer to a GET, or to a POST of ``content``."""
        address = f"{self.address}/api/v3/{path}"
        data = None if content is None else json.dumps(content).encode()
        request = urllib.request.Request(address, data, {"Content-Type": "application/json"})
        check_online(address)
        # To this address and no other: neither a proxy nor where the answer may point.
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}), _NoRedirect)
        try:
            with opener.open(request, timeout=60) as answer:
                found = json.load(answer)
        except urllib.error.HTTPError as error:
            said = _message(error)
            if error.code == 404:
                raise _NotFound(self.address, path, said) from None
            cure = "submit again" if error.code == 412 else "see its log"
            reason = said or f"{error.code} {error.reason}"
            raise InputError(self.address, f"refuses ({reason})", cure) from None
        except json.JSONDecodeError:
            raise self._stranger("its answer is no JSON") from None
        except (OSError, ValueError, http.client.HTTPException) as error:
            raise self._stranger(_in_words(error)) from None
        if not isinstance(found, dict):
            raise self._stranger("its answer is no object")
        return found

    def _stranger(self, reason: str) -> InputError:
        cure = "check that it runs, and the address"
        return InputError(self.address, f"does not answer as a Flamenco Manager ({reason})", cure)


class _NotFound(InputError):
    """404: of a Manager that says what it does not have, or of some other server."""

    def __init__(self, address: str, path: str, said: str) -> None:
        problem = f"does not answer as a Flamenco Manager (404: it has no page /api/v3/{path})"
        super().__init__(address, problem, "give the Manager's address, http://HOST:8080")
        self.said = said


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any) -> None:
        return None


def _without_page(address: str) -> str:
    """Return a Manager's address, given as such or as one of its pages."""
    given = address.strip().strip("\"'<>").strip()
    try:
        parts = urlsplit(given)
        whole = parts.scheme.lower() in ("http", "https") and bool(parts.hostname)
        whole = whole and (parts.port is None or parts.port > 0)
    except ValueError:
        whole = False
    if not whole:
        cure = "write http://HOST:8080"
        raise InputError(parameter("manager"), f'"{address}" is not an address', cure)
    before = re.split(r"/(?:app|api)(?:/|$)", parts.path)[0].rstrip("/")
    return f"{parts.scheme.lower()}://{parts.netloc}{before}"


def _message(error: urllib.error.HTTPError) -> str:
    """Return what a refusal says, as one line; empty where it says nothing that a Manager says."""
    try:
        found = json.load(error)
    except (OSError, ValueError):
        return ""
    if not isinstance(found, dict):
        return ""
    for _ in range(8):  # the web framework puts one message into another, also as text
        if isinstance(found, dict):
            found = found.get("message", found.get("error", ""))
        elif isinstance(found, str) and found.lstrip().startswith("{"):
            try:
                found = json.loads(found)
            except ValueError:
                break
    if not isinstance(found, str):
        return ""
    # Of a job type's error also comes where its script stands, of a schema's what it wants.
    said = re.split(r"\n\s*(?:Schema|Value):|\s+at \S+ \(\S+\.js:|\s+at \S+\.js:", found)[0]
    return " ".join(said.split()).removeprefix("Error: ")


def _in_words(error: Exception) -> str:
    reason = getattr(error, "reason", error)
    if isinstance(reason, ConnectionRefusedError):
        return "nothing runs there, or a firewall is before it"
    if isinstance(reason, TimeoutError):
        return "no answer within a minute"
    words = str(getattr(reason, "strerror", None) or reason) or type(error).__name__
    return " ".join(words.split())
