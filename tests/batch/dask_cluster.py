"""A Dask scheduler and workers, each a process of its own, on the loopback address."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from pathlib import Path


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
