"""A plan on a farm by Flamenco: submitted over HTTP, compiled by the job type, run as processes."""

import http.server
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager

import psutil
import pytest

from spectral_skylight.addon.batch.flamenco import submit
from spectral_skylight.addon.cli import main
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests.batch import flamenco_manager as manager
from spectral_skylight.tests.batch.small_plan import copy_plan, files, small_plan

pytestmark = [pytest.mark.blender, pytest.mark.slow]


@contextmanager
def answering(replies):
    """A server on the loopback address; `replies` maps a path to a function of what was sent."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            length = int(self.headers.get("Content-Length", 0))
            code, content = 404, {"code": 404, "message": "no such job type known"}
            if self.path in replies:
                code, content = replies[self.path](json.loads(self.rfile.read(length) or "null"))
            self.send_response(code)
            if code == 302:
                self.send_header("Location", content)
            self.end_headers()
            self.wfile.write(json.dumps(content).encode())

        do_POST = do_GET

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """SKYLIGHT_BLENDER, or what calls this Python's bpy by Blender's own command line."""
    if blender := os.environ.get("SKYLIGHT_BLENDER"):
        return blender
    folder = tmp_path_factory.mktemp("blender")
    (folder / "blender.py").write_text(
        "import runpy, sys\n"
        "before = sys.argv[:sys.argv.index('--')]\n"
        "assert before[1:5] == ['-b', '--factory-startup', '--python-exit-code', '1'], before\n"
        "runpy.run_path(before[before.index('-P') + 1], run_name='__main__')\n"
    )
    launcher = folder / ("blender.cmd" if os.name == "nt" else "blender")
    start = f"{shlex.quote(sys.executable)} {shlex.quote(str(folder / 'blender.py'))}"
    launcher.write_text(f"@{start} %*\n" if os.name == "nt" else f'#!/bin/sh\nexec {start} "$@"\n')
    launcher.chmod(0o755)
    return str(launcher)


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    """A plan of six pictures of two files, rendered by one Blender on its own."""
    plan = small_plan(tmp_path_factory.mktemp("farm") / "Haus am See (2)", cameras=3)
    script = plan.with_name("render_task.py")
    subprocess.run([sys.executable, script, "--", plan], check=True, capture_output=True)
    assert len(files(plan)) == 2 * 2 * 3
    return plan


def test_a_submitted_plan_is_rendered(plan, blender, elsewhere, tmp_path, capsys):
    """The paths are the office's; two-way variables make them those of the workers."""
    there = copy_plan(plan, tmp_path / "there")
    (kind,) = ({**manager.job_type(), "name": submit.JOB_TYPE, "etag": "4711"},)
    jobs = []

    def made(job):
        jobs.append(job)
        return 200, {**job, "id": "d0e5"}

    replies = {
        "/api/v3/jobs/type/spectral-skylight": lambda _: (200, kind),
        "/api/v3/jobs": made,
        "/api/v3/worker-mgt/workers": lambda _: (200, {"workers": [{"status": "awake"}]}),
    }
    with answering(replies) as address:
        send = ["batch", "flamenco", str(there), "--manager", address, "--together", "3"]
        assert main(send) == 0
    assert capsys.readouterr().out == f"{address}/app/jobs/d0e5\n"
    (job,) = jobs
    assert (job["name"], job["type_etag"]) == ("study, 6 pictures", "4711")
    required = {setting["key"] for setting in kind["settings"] if setting["required"]}
    assert required <= job["settings"].keys() <= {setting["key"] for setting in kind["settings"]}

    # What the Manager's `replaceTwoWayVariables` does with settings.
    office = str(there.parent)
    settings = {
        key: value.replace(office, "{shared}") if isinstance(value, str) else value
        for key, value in job["settings"].items()
    }
    tasks = manager.compile_job(settings)
    assert [task["name"] for task in tasks] == ["pictures 0-2", "pictures 3-5"]
    for task in tasks:
        line = manager.command_line(task, {"blender": blender, "shared": office})
        done = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path, env=elsewhere)
        assert done.returncode == 0, done.stderr
    assert files(there) == files(plan)


@pytest.mark.skipif(os.name == "nt", reason="kill -9 is POSIX's")
def test_a_killed_workers_blender_goes_on_beside_another(plan, blender, tmp_path):
    """Both finish, and each picture is whole and the same."""
    there = copy_plan(plan, tmp_path / "there")
    (task, _) = manager.compile_job({"plan": str(there), "pictures": "0-2,3-5"})
    line = manager.command_line(task, {"blender": blender})
    worker = subprocess.Popen(
        [sys.executable, "-c", "import subprocess, sys; subprocess.run(sys.argv[1:])", *line],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    while not (orphans := psutil.Process(worker.pid).children(recursive=True)):
        assert worker.poll() is None
    worker.send_signal(signal.SIGKILL)
    worker.wait()
    assert all(orphan.is_running() for orphan in orphans)
    beside = subprocess.run(line, capture_output=True, text=True)
    assert beside.returncode == 0, beside.stderr
    assert not psutil.wait_procs(orphans, timeout=120)[1]
    assert files(there) == {name: data for name, data in files(plan).items() if "dawn" in name}


def test_a_task_fails_for_one_picture_and_renders_the_others(plan, blender, tmp_path):
    """Flamenco then gives it to another worker, which skips what is there."""
    there = copy_plan(plan, tmp_path / "there")
    text = there.read_text(encoding="utf-8").replace('"camera 1"', '"camera nobody has"', 1)
    there.write_text(text, encoding="utf-8")
    (task,) = manager.compile_job({"plan": str(there), "pictures": "0-2"})
    line = manager.command_line(task, {"blender": blender})
    done = subprocess.run(line, capture_output=True, text=True)
    assert done.returncode == 1
    assert "camera nobody has" in done.stdout
    assert sorted(files(there)) == [f"dawn/dawn_{n}.{e}" for n in (0, 2) for e in ("exr", "png")]


def test_a_job_for_other_ways_to_a_manager(plan, capsys):
    """Without --manager nothing is sent: the job is printed, and where its type belongs."""
    assert main(["batch", "flamenco", str(plan), "--workers", "2", "--report"]) == 0
    said = capsys.readouterr()
    job = json.loads(said.out)
    assert job["settings"] == {"plan": str(plan), "pictures": "0-2/2,3-5/1", "report": True}
    assert {"name", "type", "priority", "submitter_platform"} <= job.keys()
    assert str(manager.SCRIPT) in said.err


def test_what_cannot_be_submitted_is_said(plan, tmp_path, capsys):
    bare = tmp_path / "plan.jsonl"
    shutil.copy(plan, bare)
    for arguments, said in (
        (
            [str(bare)],
            "prepared/dawn.blend is not prepared; run batch plan STUDY.toml with --prepare",
        ),
        ([str(tmp_path / "none.jsonl")], "cannot be read"),
        ([str(plan), "--together", "0"], "--together: 0 is too small; use 1 or more"),
        ([str(plan), "--workers", "-1"], "--workers: -1 is too small; use 1 or more"),
        ([str(plan), "--manager", "manager:8080"], '"manager:8080" is not an address'),
    ):
        assert main(["batch", "flamenco", *arguments]) == 2
        error = capsys.readouterr().err
        assert said in error and error.count("\n") == 1


def test_what_a_manager_may_answer_is_said(plan, tmp_path):
    job = submit.job_of(plan)
    kind = {"/api/v3/jobs/type/spectral-skylight": lambda _: (200, {"etag": "1"})}
    refusal = {"code": 400, "message": "pictures: no range"}
    refusing = {**kind, "/api/v3/jobs": lambda _: (400, refusal)}
    elsewhere = {"/api/v3/jobs/type/spectral-skylight": lambda _: (302, "http://192.0.2.1/")}
    strange = {"/api/v3/jobs/type/spectral-skylight": lambda _: (200, [])}
    for replies, said in (
        ({}, "does not know the job type .*copy .*_skylight.js"),
        (refusing, r"refuses \(pictures: no range\)"),
        (elsewhere, "refuses .302"),
        (strange, "does not answer as a Flamenco Manager"),
    ):
        with answering(replies) as address, pytest.raises(InputError, match=said):
            submit.submit(address + "/", job)
    with pytest.raises(InputError, match="does not answer as a Flamenco Manager"):
        submit.submit(address, job)  # which is closed now
    with pytest.raises(InputError, match="is not an address"):
        submit.submit("file:///etc/passwd", job)
