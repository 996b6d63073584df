"""A Blender that does one task after another, restarted where it dies or hangs."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

from ..errors import InputError, parameter
from .task import SCRIPT, Task, sources

ANSWER = "skylight-task "  # as render_task.py has it: workers of a farm get this file alone

PLAIN = ("-b", "--factory-startup", "--python-exit-code", "1", "-P")
"""How Blender runs a script without a window, add-ons and preferences."""


def blender_command(blender: str | Path | None = None) -> list[str]:
    """Return what starts `render_task.py` in a Blender, but for the script and its arguments.

    ``blender``: an executable; None: the running Blender, this Python with bpy as its module, or
    the command ``blender``. Raises InputError where there is none.
    """
    import importlib.util
    import shutil

    if blender is None and "bpy" in sys.modules:
        blender = sys.modules["bpy"].app.binary_path or None
    if blender is not None:
        found = shutil.which(str(blender))
        if found is None:
            raise InputError(
                blender, "is not a Blender that can be started", f"check {parameter('blender')}"
            )
        return [str(Path(found).absolute()), *PLAIN]
    if importlib.util.find_spec("bpy") is not None:
        return [sys.executable, "-P"]
    if found := shutil.which("blender"):
        return [found, *PLAIN]
    raise InputError("batch", "there is no Blender here", f"give {parameter('blender')} PATH")


class Worker:
    """A serving process, started at its first task.

    ``root``: the plan's folder; ``blender``: as in `blender_command`; ``threads``: of a render, 0
    for all cores; ``scripts``: `task.sources`, where this package is not. Blender runs them from a
    folder that nobody else can write to: what lies beside a plan is not trusted. Not for two
    threads at once, except for `kill`.
    """

    def __init__(
        self,
        root: str | Path,
        blender: str | Path | None = None,
        threads: int = 0,
        scripts: Mapping[str, bytes] | None = None,
    ) -> None:
        self.root = Path(root).resolve()
        self._folder = tempfile.TemporaryDirectory(prefix="skylight-", ignore_cleanup_errors=True)
        for name, content in (scripts or sources()).items():
            Path(self._folder.name, name).write_bytes(content)
        script = Path(self._folder.name, SCRIPT.name)
        self.command = [*blender_command(blender), str(script), "--", "--serve"]
        self.command += ["--root", str(self.root), "--threads", str(threads)]
        self._process: subprocess.Popen[str] | None = None
        self._answers: queue.Queue[str | None] = queue.Queue()
        self._log: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - until `close`

    def render(self, task: Task, timeout: float | None = None) -> dict[str, Any]:
        """Do a task and return its answer, see `render_task.perform`.

        A Blender that dies, or takes longer than ``timeout`` [s], is a failure like others, and
        the next task starts a new one.
        """
        try:
            if self._process is None or self._process.poll() is not None:
                self._start()
            assert self._process is not None and self._process.stdin is not None
            self._process.stdin.write(task.line() + "\n")
            self._process.stdin.flush()
            answer = self._answers.get(timeout=timeout)
        except queue.Empty:
            self.kill()
            return _failure(task, f"did not finish within {timeout:g} s")
        except OSError as error:
            self.kill()
            return _failure(task, f"Blender cannot be started or has stopped ({error})")
        if answer is None:
            code = self.kill()
            return _failure(task, f"Blender stopped with exit code {code}{self._last_words()}")
        return json.loads(answer)

    def close(self) -> None:
        """Let the process end, after its task if it has one."""
        if self._process is not None and self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()
        self.kill()
        self._log.close()
        self._folder.cleanup()

    def kill(self) -> int | None:
        """End the process with all that it has started; return its exit code."""
        process = self._process
        if process is None:
            return None
        if os.name == "nt":
            kill = ["taskkill", "/F", "/T", "/PID", str(process.pid)]
            subprocess.run(kill, capture_output=True, check=False)
        else:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
        return process.wait()

    def _start(self) -> None:
        self._log.seek(0)
        self._log.truncate()
        self._answers = queue.Queue()
        if os.name == "nt":
            apart: dict[str, Any] = {"creationflags": 0x200}  # CREATE_NEW_PROCESS_GROUP
        else:
            apart = {"start_new_session": True}  # Ctrl-C reaches us alone, and we end it
        self._process = subprocess.Popen(
            self.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            encoding="utf-8",
            errors="backslashreplace",
            cwd=self._folder.name,
            **apart,
        )
        arguments = (self._process, self._answers)
        threading.Thread(target=_listen, args=arguments, daemon=True).start()

    def _last_words(self) -> str:
        self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, self._log.tell() - 4096))
        lines = self._log.read().decode(errors="replace").splitlines()
        said = next((line.strip() for line in reversed(lines) if line.strip()), "")
        return f": {said}" if said else ""


def _listen(process: subprocess.Popen[str], answers: queue.Queue[str | None]) -> None:
    assert process.stdout is not None
    with contextlib.suppress(ValueError, OSError):
        for line in process.stdout:
            if line.startswith(ANSWER):
                answers.put(line.removeprefix(ANSWER))
    answers.put(None)


def _failure(task: Task, reason: str) -> dict[str, Any]:
    return {"index": task.index, "status": "failed", "error": f"{task.exr}: {reason}"}
