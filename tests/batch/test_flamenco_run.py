"""A plan on a farm by Flamenco: submitted over HTTP, compiled by the job type, run as processes."""

import io
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys

import psutil
import pytest

from spectral_skylight.addon.batch.flamenco import submit
from spectral_skylight.addon.batch.flamenco.manager import Manager
from spectral_skylight.addon.batch.task import scripts_hash
from spectral_skylight.addon.cli import main
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.output import image_file, plan_range, render_task
from spectral_skylight.tests.batch import flamenco_manager as manager
from spectral_skylight.tests.batch.flamenco_farm import Farm, answering
from spectral_skylight.tests.batch.small_plan import copy_plan, files, small_plan

pytestmark = [pytest.mark.blender, pytest.mark.slow]


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """SKYLIGHT_BLENDER, or what calls this Python's bpy by Blender's own command line."""
    if blender := os.environ.get("SKYLIGHT_BLENDER"):
        return blender
    folder = tmp_path_factory.mktemp("blender")
    (folder / "blender.py").write_text(
        "import sys\n"
        "before = sys.argv[:sys.argv.index('--')]\n"
        "assert before[1:5] == ['-b', '--factory-startup', '--python-exit-code', '1'], before\n"
        "exec(before[before.index('--python-expr') + 1])\n"
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


def bad(plan, folder):
    """The plan elsewhere, with a picture that cannot be: its camera is not there."""
    there = copy_plan(plan, folder)
    text = there.read_text(encoding="utf-8").replace('"camera 1"', '"camera nobody has"', 1)
    there.write_text(text, encoding="utf-8")
    return there


NAMES = {"dawn": ["camera 0, camera 1", "camera 2"], "noon": ["camera 0", "camera 1", "camera 2"]}

GOOD = [f"{sky}/{sky}_{n}.exr" for sky in ("dawn", "noon") for n in range(3)]
GOOD.remove("dawn/dawn_1.exr")


@pytest.mark.parametrize("version", [(3, 3), (3, 9)])
def test_a_submitted_plan_is_rendered(plan, blender, elsewhere, tmp_path, capsys, version):
    """The paths are the office's; two-way variables make them those of the workers."""
    there = copy_plan(plan, tmp_path / "there")
    variables = {"blender": blender, "shared": str(there.parent)}
    farm = Farm(1, variables, version, cwd=tmp_path, env=elsewhere)
    with answering(farm.replies()) as address:
        send = ["batch", "flamenco", str(there), "--together", "3", "--report"]
        assert main([*send, "--manager", f"{address}/app/jobs/4711?x#tasks"]) == 0
    said = capsys.readouterr()
    assert said.out == f"{address}/app/jobs/d0e5\n"
    assert ("Flamenco 3.3 shows neither previews" in said.err) == (version < (3, 8))
    (job,) = farm.jobs
    assert (job["name"], job["type_etag"]) == ("study, 6 pictures", "4711")
    kind = manager.job_type()
    required = {setting["key"] for setting in kind["settings"] if setting["required"]}
    assert required <= job["settings"].keys() <= {setting["key"] for setting in kind["settings"]}
    assert farm.run() == "completed"
    dawn, noon = "dawn: camera 0, camera 1, camera 2", "noon: camera 0, camera 1, camera 2"
    last = "missing pictures, report, check"
    assert [task["name"] for task in farm.tasks] == [dawn, noon, last]
    assert files(there) == files(plan)
    report = json.loads((there.parent / "report.json").read_text(encoding="utf-8"))
    assert report["counts"] == {"done": 6} and all(p["seconds"] > 0 for p in report["pictures"])
    (made,) = {picture["blender"] for picture in report["pictures"]}
    assert report["blender"] == [made] and made.split()[0][0].isdigit()
    assert farm.tasks[-1]["log"].endswith("All 6 pictures are there\n")
    if version >= (3, 8):
        pictures = there.parent / "pictures"
        shown = [path for task in farm.tasks for path in task["previews"]]
        assert [
            str(pictures / name.replace("exr", "png")) for name in sorted(files(there))[::2]
        ] == shown
        assert [(task["counted"], task["all"]) for task in farm.tasks[:2]] == [(3, 3), (3, 3)]


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_a_bad_picture_costs_no_good_one(plan, blender, tmp_path, workers):
    """Whatever the farm's size all others are rendered, then reported; the check has the list.

    Once the cause is gone, requeueing the job renders what was missing and nothing else.
    """
    there = bad(plan, tmp_path / "there")
    farm = Farm(workers, {"blender": blender})
    with answering(farm.replies()) as address:
        submit.submit(address, submit.job_of(there, 3, 1, report=True))
    farm.run()
    *renders, last = farm.tasks
    assert {task["status"] for task in renders} == {"completed"} and len(renders) == 2
    assert sorted(name for name in files(there) if name.endswith(".exr")) == GOOD
    found = json.loads((there.parent / "report.json").read_text(encoding="utf-8"))
    assert found["counts"] == {"done": 5, "failed": 1}
    (failed,) = [p for p in found["pictures"] if p["status"] == "failed"]
    assert failed["camera"] == "camera nobody has" and "camera nobody has" in failed["error"]
    assert "camera nobody has" in (there.parent / "report.html").read_text(encoding="utf-8")
    assert last["status"] == "failed" and farm.status == "failed"
    assert "1 of 6 pictures are missing:\n" in last["log"]
    assert "dawn_1.exr" in last["log"].splitlines()[-1]
    assert "camera nobody has" in last["log"].splitlines()[-1]
    assert all("camera nobody has" not in task["log"] for task in renders[1:])
    good = files(there)
    there.write_text(plan.read_text(encoding="utf-8"), encoding="utf-8")
    assert farm.requeue() == "completed" and files(there) == files(plan) != good
    assert last["log"].count('"rendered"') == 1
    found = json.loads((there.parent / "report.json").read_text(encoding="utf-8"))
    assert found["counts"] == {"done": 6}


def test_only_the_tags_workers_are_asked_for(plan, tmp_path, capsys):
    farm = Farm(5, {"blender": "none"}, tags={"GPU": {1, 4}, "CPU": {0}})
    with answering(farm.replies()) as address:
        send = ["batch", "flamenco", str(plan), "--manager", address, "--tag"]
        assert main([*send, "GPU"]) == 0
        assert main([*send, "gpu"]) == 2
        assert submit.workers_of(address) == 5 and submit.workers_of(address, "GPU") == 2
    assert farm.jobs[0]["worker_tag"] == "id of GPU" and len(farm.jobs) == 1
    assert farm.jobs[0]["settings"]["pictures"] == "0-2/2,3-5/1"  # as for two workers
    assert 'has no worker tag "gpu"; it has "GPU", "CPU"' in capsys.readouterr().err
    with answering(Farm(1, {}).replies()) as address:
        assert main([*send[:-2], address, "--tag", "GPU"]) == 2
    assert 'has no worker tag "GPU"; it has none' in capsys.readouterr().err
    assert main(["batch", "flamenco", str(plan), "--tag", "GPU"]) == 2
    assert "--tag: is known to a Manager alone; give --manager" in capsys.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="kill -9 is POSIX's")
def test_a_killed_workers_blender_goes_on_beside_another(plan, blender, tmp_path):
    """Both finish, and each picture is whole and the same."""
    there = copy_plan(plan, tmp_path / "there")
    task, *_ = manager.compile_job({"plan": str(there), "pictures": "0-2,3-5"})
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


@pytest.mark.skipif(os.name == "nt", reason="kill -9 is POSIX's")
def test_a_killed_workers_blender_ends_where_nobody_reads_it(plan, blender, tmp_path):
    """A worker reads its Blender: once it is gone the picture under way is the last one."""
    there = copy_plan(plan, tmp_path / "there")
    slow = there.read_text(encoding="utf-8").replace('"samples": 1,', '"samples": 500,')
    there.write_text(slow, encoding="utf-8")
    (task, *_) = manager.compile_job({"plan": str(there), "pictures": "0-5"})
    line = manager.command_line(task, {"blender": blender})
    orphan = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert any(said.startswith(b"skylight-task ") for said in orphan.stdout)
    orphan.stdout.close()
    assert orphan.wait(60) == 1
    assert 2 <= len(files(there)) < 12 and len(files(there)) % 2 == 0
    assert plan_range.check(plan_range.planned(there, 0, 1), there.parent, io.StringIO()) == 0


def test_exit_code_1_is_for_what_no_other_picture_survives(plan, tmp_path, monkeypatch):
    """A full disk, a plan that cannot be read, a file of a newer Blender: on this machine."""
    script = plan.with_name("render_task.py")
    run = lambda *given: subprocess.run(  # noqa: E731
        [sys.executable, script, "--", *given], capture_output=True, text=True
    )
    assert run(tmp_path / "none.jsonl").returncode == 1
    cut = tmp_path / "cut.jsonl"
    cut.write_bytes(plan.read_bytes()[:-20])
    assert run(cut, "--root", plan.parent).returncode == 1
    task = json.loads(plan.read_text(encoding="utf-8").splitlines()[1])
    for mark in ("no_space", "wrong_blender"):
        said = io.StringIO()
        failing = {"index": 0, "status": "failed", "error": "why", "seconds": 1.0, mark: True}
        assert plan_range.render([task, task], tmp_path, lambda _, a=failing: a, said) == 1
        assert said.getvalue().endswith("}\nwhy\n") and said.getvalue().count("skylight-task") == 1


def test_a_picture_of_another_build_is_not_ours(plan, tmp_path, monkeypatch):
    """The build that renders is in both files; a check takes any, a render its own alone."""
    there = copy_plan(plan, tmp_path / "there")
    task = json.loads(there.read_text(encoding="utf-8").splitlines()[1])
    ours = render_task.perform(task, there.parent)
    assert (
        ours["status"] == "rendered"
        and render_task.perform(task, there.parent)["status"] == "skipped"
    )
    exr = there.parent / task["exr"]
    assert image_file.made_by(exr, task["key"]) == render_task.build() == ours["build"]
    monkeypatch.setattr(render_task, "build", lambda: "Blender 9.9 abc Plan9")
    assert plan_range.check([task], there.parent, io.StringIO()) == 0
    assert render_task.perform(task, there.parent)["status"] == "rendered"
    assert image_file.made_by(exr, task["key"]) == "Blender 9.9 abc Plan9"


def test_a_job_for_other_ways_to_a_manager(plan, capsys):
    """Without --manager nothing is sent: the job is printed, and where its type belongs."""
    assert main(["batch", "flamenco", str(plan), "--workers", "2", "--report"]) == 0
    said = capsys.readouterr()
    job = json.loads(said.out)
    names = [f"{sky}: {cameras}" for sky in ("dawn", "noon") for cameras in NAMES[sky]]
    assert job["settings"] == {
        "plan": str(plan),
        "pictures": "0-2/2,3-5/1",
        "names": "\n".join(names),
        "report": True,
        "scripts": scripts_hash(),
    }
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


KIND = "/api/v3/jobs/type/spectral-skylight"


def test_what_a_manager_may_answer_is_said(plan, tmp_path):
    job = submit.job_of(plan)
    kind = {KIND: lambda _: (200, {"etag": "1"})}
    refusal = {"code": 400, "message": "pictures: no range"}
    refusing = {**kind, "/api/v3/jobs": lambda _: (400, refusal)}
    elsewhere = {KIND: lambda _: (302, "http://192.0.2.1/")}
    strange = {KIND: lambda _: (200, [])}
    older = {KIND: lambda _: (200, {"etag": "1", "settings": [{"key": "plan"}]})}
    page = {KIND: lambda _: (200, b"<!doctype html>")}
    no_page = {KIND: lambda _: (404, b"<h1>404</h1>")}
    for replies, said in (
        ({}, "does not know the job type .*copy .*_skylight.js"),
        (refusing, r"refuses \(pictures: no range\)"),
        (elsewhere, "refuses .302"),
        (strange, "does not answer as a Flamenco Manager"),
        (older, "job type spectral-skylight of another version; copy .*_skylight.js"),
        (page, r"does not answer as a Flamenco Manager \(its answer is no JSON"),
        (no_page, r"\(404: it has no page /api/v3/jobs/type.*give the Manager's address"),
    ):
        with answering(replies) as address, pytest.raises(InputError, match=said) as error:
            submit.submit(address + "/", job)
        assert "\n" not in str(error.value)
    with pytest.raises(InputError, match="does not answer as a Flamenco Manager .nothing runs"):
        submit.submit(address, job)  # which is closed now
    with pytest.raises(InputError, match="is not an address"):
        submit.submit("file:///etc/passwd", job)


@pytest.mark.parametrize(
    ("message", "said"),
    [
        ({"message": "too busy"}, "too busy"),
        ({"message": {"message": "code=400, message=no JSON"}}, "code=400, message=no JSON"),
        ({"message": json.dumps({"code": 400, "message": "inner"})}, "inner"),
        (
            {"message": "request body has an error: priority must be an integer\nSchema:\n  {}\n"},
            "request body has an error: priority must be an integer",
        ),
        (
            {"message": 'Error: "x" is no absolute path at absolute (spectral.js:77:15(12))'},
            '"x" is no absolute path',
        ),
        ({"message": ["a"]}, "400 Bad Request"),
        ({}, "400 Bad Request"),
    ],
)
def test_messages_within_messages_are_one_line(plan, message, said):
    kind = {KIND: lambda _: (200, {"etag": "1"})}
    with answering({**kind, "/api/v3/jobs": lambda _: (400, message)}) as address:
        with pytest.raises(InputError) as error:
            submit.submit(address, {"settings": {}})
        assert error.value.problem == f"refuses ({said})"


@pytest.mark.parametrize(
    "given",
    [
        "http://farm:8080",
        "http://farm:8080/",
        " http://farm:8080/app\n",
        "HTTP://farm:8080/app/jobs/47f1?tab=1#top",
        "http://farm:8080/app/workers/12",
        '"http://farm:8080/api/v3/version"',
        "<http://farm:8080/app/>",
    ],
)
def test_an_address_from_a_browser_is_a_managers(given):
    assert Manager(given).address == "http://farm:8080"
    assert Manager("https://host/flamenco/app/jobs").address == "https://host/flamenco"
    assert Manager("http://host/application").address == "http://host/application"


@pytest.mark.parametrize(
    "given", ["", "farm:8080", "http://", "http://a:x", "http://a:0", "ftp://a"]
)
def test_what_is_no_address_is_said(given):
    with pytest.raises(InputError, match="is not an address; write http://HOST:8080"):
        Manager(given)
