"""A run in a process of its own, watched from outside by the small file that it writes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO, Any

from .owner import STATUS, check_links, check_owner


class Background:
    """`batch run` of a study, started at once.

    ``blender``: the executable in which the add-on is enabled; without one, this Python with bpy.
    Raises InputError where ``out`` is not the study's.
    """

    def __init__(self, study: Path, out: Path, blender: str = "", workers: int = 0) -> None:
        self.out = out
        check_links(out)
        check_owner(study, out)
        (out / STATUS).unlink(missing_ok=True)
        arguments = ["batch", "run", str(study)]
        arguments += ["--workers", str(workers)] if workers else []
        package = __name__.rpartition(".addon.")[0]
        code = f"import sys; from {package}.addon.cli import main; sys.exit(main(sys.argv[1:]))"
        command = [blender, "--background", "--command", "skylight"]
        command = command if blender else [sys.executable, "-P", "-c", code]
        self._log: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - as long as the process
        apart: dict[str, Any] = {"start_new_session": True}
        if os.name == "nt":
            apart = {"creationflags": 0x200 | 0x8000000}  # a group of its own, and no window
        self._process = subprocess.Popen(
            [*command, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=subprocess.STDOUT,
            **apart,
        )

    def status(self) -> dict[str, Any]:
        """Return ``state``, ``line``, and where known ``done``, ``failed``, ``total``, ``left``.

        ``state``: ``starting``, ``preparing``, ``rendering``; ``done``, ``failed``, ``stopped``.
        """
        ended = self._process.poll()
        found = _read(self.out / STATUS) or {"state": "starting", "line": "starting"}
        if ended is None or found["state"] in ("done", "stopped"):
            return found
        return {**found, "state": "failed", "line": self._last_words() or f"exit code {ended}"}

    @property
    def running(self) -> bool:
        """Whether the process is there."""
        return self._process.poll() is None

    def cancel(self, patience: float = 20.0) -> None:
        """Ask the run to end, and wait for it; what was done stays."""
        self._process.terminate()
        try:
            self._process.wait(patience)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _last_words(self) -> str:
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").splitlines()
        ours = [line for line in lines if line.startswith("spectral-skylight: ")]
        return ours[-1].removeprefix("spectral-skylight: ") if ours else ""


def _read(path: Path) -> dict[str, Any]:
    """Return what a status file says, empty where it is none or somebody has changed it."""
    try:
        found = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    except (OSError, ValueError, RecursionError):
        return {}
    right = isinstance(found, dict) and all(
        isinstance(found.get(name), str) for name in ("state", "line")
    )
    numbers = (found.get(name) or 0 for name in ("done", "failed", "total")) if right else ()
    return found if right and all(type(each) is int for each in numbers) else {}
