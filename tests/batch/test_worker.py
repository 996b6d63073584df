"""A worker answers, whatever its Blender does: here a script that speaks as `render_task` does."""

import os
import subprocess
import sys
import time

import pytest

from spectral_skylight.addon.batch.task import Task, task_of
from spectral_skylight.addon.batch.worker import ANSWER, Worker, blender_command
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.output import render_task

BLENDER = f"""#!{sys.executable}
import json, os, subprocess, sys, time
print("Blender 5.2.3", flush=True)
for line in sys.stdin:
    task = json.loads(line)
    if task["camera"] == "crash":
        print("Segmentation fault", file=sys.stderr, flush=True)
        os._exit(11)
    if task["camera"] == "hang":
        child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
        open(sys.argv[sys.argv.index("--root") + 1] + "/child", "w").write(str(child.pid))
        time.sleep(600)
    print("Fra:1 Mem:12M " * 1000)
    answer = dict(index=task["index"], status="rendered", pid=os.getpid(), camera=task["camera"])
    print({ANSWER!r} + json.dumps(answer), flush=True)
"""


def task(camera, index=0):
    return Task(index, "a.blend", "Scene", camera, 1, "cycles", 1, (8, 8), "p/a.exr", "k")


@pytest.fixture
def worker(tmp_path):
    blender = tmp_path / "blender"
    blender.write_text(BLENDER)
    blender.chmod(0o755)
    worker = Worker(tmp_path, blender)
    yield worker
    worker.close()


posix = pytest.mark.skipif(os.name == "nt", reason="a script is no executable on Windows")


@posix
def test_one_process_does_many_tasks_and_a_dead_one_is_replaced(worker):
    first, second = (worker.render(task("Süd", index)) for index in (0, 1))
    assert (first["index"], second["index"]) == (0, 1) and first["camera"] == "Süd"
    assert first["pid"] == second["pid"]
    dead = worker.render(task("crash", 2))
    assert dead["status"] == "failed" and dead["index"] == 2
    assert dead["error"] == "p/a.exr: Blender stopped with exit code 11: Segmentation fault"
    assert worker.render(task("South"))["pid"] != first["pid"]


@posix
def test_one_that_hangs_is_ended_with_its_children(worker, tmp_path):
    start = time.monotonic()
    late = worker.render(task("hang"), timeout=1.0)
    assert late["error"] == "p/a.exr: did not finish within 1 s" and time.monotonic() - start < 10
    child = int((tmp_path / "child").read_text())
    until = time.monotonic() + 10
    while _alive(child) and time.monotonic() < until:
        time.sleep(0.05)
    assert not _alive(child)
    assert worker.render(task("South"), timeout=60)["status"] == "rendered"


def _alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    stat = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True)
    return not stat.stdout.startswith("Z") and bool(stat.stdout)


def test_no_such_blender_is_told_before_the_first_task(tmp_path):
    with pytest.raises(InputError, match="blender-of-nobody.*check blender"):
        blender_command("blender-of-nobody")
    with pytest.raises(InputError):
        blender_command(tmp_path)


def test_a_task_travels_as_a_line():
    one = task('Süd "Ost"\n')
    assert "\n" not in one.line() and task_of(one.line()) == one
    assert one.png == "p/a.png"
    assert ANSWER == render_task.ANSWER
