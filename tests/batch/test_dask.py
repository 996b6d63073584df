"""Dask's workers render a plan: for real, on this machine, one of them killed half-way."""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import bpy
import distributed
import psutil
import pytest

from spectral_skylight.addon.batch import dask_farm
from spectral_skylight.addon.cli import main
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests import signals
from spectral_skylight.tests.batch.dask_cluster import Cluster
from spectral_skylight.tests.batch.small_plan import copy_plan, files, small_plan

pytestmark = [
    pytest.mark.blender,
    pytest.mark.slow,
    pytest.mark.skipif(bpy.app.version < (5, 3), reason="one for all Blenders: in the newest"),
    pytest.mark.skipif(os.name == "nt", reason="kill -9 and Ctrl-C of a process are POSIX's"),
]


@pytest.fixture(scope="module")
def cluster(tmp_path_factory, elsewhere):
    cluster = Cluster(tmp_path_factory.mktemp("cluster"), elsewhere)
    yield cluster
    cluster.end()


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    """Twelve pictures of two files, one of which cannot be; rendered by one Blender on its own."""
    plan = small_plan(tmp_path_factory.mktemp("here") / "house")
    text = plan.read_text(encoding="utf-8").replace('"camera 3"', '"camera nobody has"', 1)
    plan.write_text(text, encoding="utf-8")
    script = plan.with_name("render_task.py")
    done = subprocess.run([sys.executable, script, "--", plan], capture_output=True)
    assert done.returncode == 0 and b"camera nobody has" in done.stdout
    assert len(files(plan)) == 2 * 11
    return plan


def pictures(plan):
    return [name for name in files(plan) if name.endswith(".exr")]


def when(pictures_are, plan, do):
    """Do something as soon as there are so many pictures."""

    def wait():
        while len(pictures(plan)) < pictures_are:
            time.sleep(0.05)
        do()

    thread = threading.Thread(target=wait, daemon=True)
    thread.start()
    return thread


def blenders(plan):
    """Processes that serve a plan's tasks, after the seconds in which an orphan may end."""

    def serving():
        lines = (" ".join(p.info["cmdline"] or ()) for p in psutil.process_iter(["cmdline"]))
        return [line for line in lines if f"--serve --root {plan.parent}" in line]

    end = time.monotonic() + 20
    while serving() and time.monotonic() < end:
        time.sleep(0.1)
    return serving()


def test_a_killed_worker_loses_nothing(cluster, plan, tmp_path, capsys):
    """kill -9 half-way, and the pictures are, byte for byte, those of a run alone."""
    there = copy_plan(plan, tmp_path / "there")
    victim, _ = cluster.worker(), cluster.worker()
    killer = when(3, there, lambda: os.kill(victim.pid, signal.SIGKILL))
    code = main(["batch", "run", str(there), "--scheduler", cluster.address])
    killer.join(1)
    assert victim.poll() == -signal.SIGKILL
    assert code == 1
    said = capsys.readouterr()
    assert "1 failed" in said.out
    assert "camera nobody has" in said.err
    assert files(there) == files(plan)
    # What fails is tried three times, and the others go on.
    log = (there.parent / "results.jsonl").read_text(encoding="utf-8").splitlines()
    answers = [json.loads(line) for line in log]
    assert sum(answer["status"] == "failed" for answer in answers) == 3
    assert blenders(there) == []


def test_ctrl_c_ends_the_farms_work_and_a_second_run_does_the_rest(cluster, plan, tmp_path):
    """Also where the only worker is killed in that run, and another comes later."""
    cluster.at_least_one()
    there = copy_plan(plan, tmp_path / "there")
    run = ["batch", "run", str(there), "--scheduler", cluster.address]
    code = f"import sys; from spectral_skylight.addon.cli import main; sys.exit(main({run}))"
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stderr=subprocess.PIPE,
        preexec_fn=None if os.name == "nt" else signals.heard,
    )
    when(1, there, lambda: process.send_signal(signal.SIGINT))
    said = process.communicate(timeout=120)[1]
    assert process.returncode == 1
    assert b"stopped" in said
    assert blenders(there) == []
    count = len(pictures(there))
    assert 1 <= count < 11

    def replace():
        cluster.processes[-1].kill()
        cluster.processes[-1].wait()
        cluster.worker()

    when(count + 1, there, replace)
    assert main(run) == 1  # for the camera that nobody has
    assert files(there) == files(plan)


def test_workers_that_cannot_render_are_given_nothing(cluster, tmp_path):
    cluster.at_least_one()
    said = "none of its .* workers can render.*no/blender.* is not a Blender that can be started"
    with distributed.Client(cluster.address, set_as_default=False) as client:
        client.wait_for_workers(1, timeout=60)
    pool = dask_farm.dask_pool(cluster.address, tmp_path, "no/blender", patience=0)
    with pytest.raises(InputError, match=said), pool:
        pass


def test_a_scheduler_that_goes_is_said(cluster, plan, tmp_path, monkeypatch, capsys):
    """Last, for it takes the scheduler away: in the midst of a run, and before another."""
    monkeypatch.setattr(dask_farm, "CONNECT", 2)
    there = copy_plan(plan, tmp_path / "there")
    run = ["batch", "run", str(there), "--scheduler", cluster.address]
    when(1, there, cluster.processes[0].kill)
    assert main(run) == 1
    assert "the Dask scheduler has stopped. Finished pictures are kept" in capsys.readouterr().err
    assert files(there).items() <= files(plan).items()
    assert main(run) == 2
    assert f"{cluster.address}: no Dask scheduler answers" in capsys.readouterr().err
