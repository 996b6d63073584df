"""Dask's workers render a plan: for real, on this machine, one of them killed half-way."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip("bpy")
distributed = pytest.importorskip("distributed")

from spectral_skylight.addon.batch.dask_farm import dask_pool  # noqa: E402
from spectral_skylight.addon.batch.dispatch import chunks, dispatch  # noqa: E402
from spectral_skylight.addon.batch.plan import read_tasks  # noqa: E402
from spectral_skylight.addon.errors import InputError  # noqa: E402
from spectral_skylight.tests.batch.small_plan import copy_plan, files, small_plan  # noqa: E402

pytestmark = [pytest.mark.blender, pytest.mark.slow]


class Cluster:
    """A scheduler and workers, each a process of its own, on the loopback address."""

    def __init__(self, folder, environment):
        self.file, self.environment, self.processes = folder / "scheduler.json", environment, []
        self.start("scheduler", "--port", "0", "--scheduler-file", self.file)
        while not self.file.exists() or not self.file.read_text():
            time.sleep(0.1)
        self.address = json.loads(self.file.read_text())["address"]

    def start(self, what, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *map(str, arguments)]
        command += ["--host", "127.0.0.1", "--no-dashboard"]
        log = (self.file.parent / f"{what} {len(self.processes)}.log").open("wb")
        with log:
            process = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)
        self.processes.append(process)
        return process

    def worker(self):
        return self.start("worker", self.address, "--nthreads", "1", "--no-nanny")

    def end(self):
        for process in self.processes:
            process.terminate()
        for process in self.processes:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(10)
            process.kill()


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """The environment of a machine that has Blender and Dask, but not this package."""
    shadow = tmp_path_factory.mktemp("shadow")
    (shadow / "spectral_skylight.py").write_text("raise ImportError('is not on this machine')\n")
    environment = {**os.environ, "PYTHONPATH": str(shadow)}
    gone = subprocess.run(
        [sys.executable, "-c", "import spectral_skylight"], env=environment, capture_output=True
    )
    assert b"is not on this machine" in gone.stderr
    return environment


@pytest.fixture
def cluster(tmp_path, elsewhere):
    cluster = Cluster(tmp_path, elsewhere)
    yield cluster
    cluster.end()


def alone(plan):
    """Render a plan as one Blender on its own does, and return the files."""
    script = plan.with_name("render_task.py")
    subprocess.run([sys.executable, script, "--", plan], check=True, capture_output=True)
    return files(plan)


def test_a_killed_worker_loses_nothing(cluster, tmp_path):
    """kill -9 half-way, and the pictures are, byte for byte, those of a run alone."""
    here = small_plan(tmp_path / "here")
    there = copy_plan(here, tmp_path / "there")
    workers = [cluster.worker(), cluster.worker()]
    answers = []
    with dask_pool(cluster.address, there.parent) as pool:
        for _ in dispatch(chunks(read_tasks(there), 2), pool):
            answers.append(_[1])
            if len(answers) == 4:
                os.kill(workers[0].pid, signal.SIGKILL)
    assert [answer["status"] for answer in answers if answer["status"] != "skipped"]
    assert sorted(answer["index"] for answer in answers) == list(range(12))
    assert not [answer for answer in answers if answer["status"] == "failed"]
    assert files(there) == alone(here)


def test_no_scheduler_is_said():
    said = "tcp://127.0.0.1:9: no Dask scheduler answers"
    with pytest.raises(InputError, match=said), dask_pool("tcp://127.0.0.1:9", "."):
        pass
