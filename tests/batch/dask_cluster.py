"""A Dask scheduler and workers, each a process of its own, on the loopback address."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from pathlib import Path

from spectral_skylight.addon.batch.task import Task
from spectral_skylight.addon.scene.output import plan_data


class Cluster:
    """A scheduler in an environment, and the workers that are started with it."""

    def __init__(self, folder: Path, environment: dict[str, str] | None = None) -> None:
        self.file, self.environment, self.processes = folder / "scheduler.json", environment, []
        self._start("scheduler", "--port", "0", "--scheduler-file", self.file)
        while not self.file.exists() or not self.file.read_text():
            time.sleep(0.1)
        self.address = json.loads(self.file.read_text())["address"]

    def worker(self, threads: int = 1) -> subprocess.Popen:
        """Start a worker; its process is the one that can be killed, for it has no nanny."""
        return self._start("worker", self.address, "--nthreads", threads, "--no-nanny")

    def at_least_one(self) -> None:
        """Start a worker where none is left of tests before, or none were."""
        if all(process.poll() is not None for process in self.processes[1:]):
            self.worker()

    def end(self) -> None:
        """End all processes."""
        for process in self.processes:
            process.terminate()
        for process in self.processes:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(2)
            process.kill()

    def _start(self, what: str, *arguments: object) -> subprocess.Popen:
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *map(str, arguments)]
        command += ["--host", "127.0.0.1", "--no-dashboard"]
        with (self.file.parent / f"{what} {len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)
        self.processes.append(process)
        return process


INSTANT = f"""#!{sys.executable} -S
import json, sys
for line in sys.stdin:
    answer = {{"index": json.loads(line)["index"], "status": "rendered", "seconds": 0.0}}
    print("skylight-task " + json.dumps(answer), flush=True)
"""


def instant_blender(folder: Path) -> str:
    """What takes no time and draws nothing, in place of a Blender; for POSIX."""
    blender = folder / "blender"
    blender.write_text(INSTANT)
    blender.chmod(0o755)
    return str(blender)


def instant_plan(folder: Path, pictures: int) -> Path:
    """A plan of so many pictures, forty of each prepared file, none of which is there."""
    folder.mkdir()
    plan = folder / "plan.jsonl"
    with plan.open("w", encoding="utf-8") as file:
        header = {
            "format": plan_data.FORMAT,
            "version": plan_data.VERSION,
            "tasks": pictures,
            "study": "study.toml",
        }
        file.write(json.dumps(header) + "\n")
        for index in range(pictures):
            sky, camera = divmod(index, 40)
            names = (f"prepared/{sky}.blend", "Scene", f"camera {camera}")
            where = f"pictures/{sky}/{camera}.exr"
            task = Task(index, *names, 1, "cycles", 1, (32, 32), where, f"{index:024x}")
            file.write(task.line() + "\n")
    return plan
