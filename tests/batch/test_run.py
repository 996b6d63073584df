"""What a run does with failures, clocks and locks; workers are made up, without Blender."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from spectral_skylight.addon import atomic_file
from spectral_skylight.addon.batch import plan, run
from spectral_skylight.addon.batch.lock import locked
from spectral_skylight.addon.batch.run_status import STATUS, RunStatus
from spectral_skylight.addon.batch.scenes import SceneFile
from spectral_skylight.addon.batch.study import read_study
from spectral_skylight.addon.errors import InputError
from spectral_skylight.tests.batch.studies import write_inputs, write_study


@pytest.fixture
def path(tmp_path):
    """The plan of ten cameras in two variants."""
    (tmp_path / "house.blend").touch()
    variants = [{"name": name, "assign": f"{name}.csv"} for name in ("red", "grey")]
    study = read_study(write_study(write_inputs(tmp_path), variants=variants))
    cameras = tuple(f"View {number}" for number in range(10))
    scene = SceneFile(tmp_path / "house.blend", "c", "Scene", cameras, 1, "cycles", (16, 16))
    return plan.write_plan(study, (scene,), "program")


class Workers:
    """One at a time; ``answer`` says what comes of a task at its first, second … try."""

    def __init__(self, answer):
        self.answer, self.tried, self.waiting = answer, [], None

    def room(self):
        return self.waiting is None

    def submit(self, chunk):
        self.waiting = chunk

    def finished(self):
        chunk, self.waiting = self.waiting, None
        answers = []
        for task in chunk:
            self.tried.append(task.index)
            outcome = self.answer(task.index, self.tried.count(task.index))
            answers.append({"index": task.index, "seconds": 1.0, **outcome})
            getattr(self, "note", lambda *_: None)(task, answers[-1])
        return chunk, answers


class LiveWorkers(Workers):
    """Those of this machine tell of each picture as it is done."""

    note = None


RENDERED = {"status": "rendered"}


@pytest.mark.parametrize("kind", [Workers, LiveWorkers])
def test_failures_are_tried_twice_more_and_the_others_go_on(path, kind):
    def answer(index, times):
        if index == 3 or (index == 5 and times < 3):
            return {"status": "failed", "error": f"picture {index}: try {times}"}
        return {"status": "skipped"} if index == 8 else RENDERED

    workers, told = kind(answer), []
    outcome = run.run(path, workers, lambda outcome, left: told.append((outcome.left, left)))
    assert (outcome.total, outcome.rendered, outcome.skipped) == (20, 18, 1)
    assert outcome.failures == ["picture 3: try 3"] and not outcome.complete and not outcome.left
    assert workers.tried.count(3) == workers.tried.count(5) == 3 and len(workers.tried) == 24
    assert [left for left, _ in told] == sorted((left for left, _ in told), reverse=True)
    assert told[-1][1] == 0
    lines = [json.loads(line) for line in (path.parent / run.RESULTS).read_text().splitlines()]
    keys = {task.index: task.key for task in plan.read_tasks(path)}
    assert all(line["key"] == keys[line["index"]] for line in lines)
    assert sum(line["status"] == "failed" for line in lines) == (5 if kind is LiveWorkers else 1)


def test_without_space_nothing_more_is_rendered(path):
    def answer(index, times):
        full = {"status": "failed", "error": "a.exr: No space left on device", "no_space": True}
        return full if index >= 4 else RENDERED

    workers = LiveWorkers(answer)
    outcome = run.run(path, workers, lambda *_: None)
    assert outcome.rendered == 4 and workers.tried == [0, 1, 2, 3, 4]
    assert "No space left" in outcome.stopped and outcome.left == 16 and not outcome.complete


def test_a_clock_that_jumps_changes_nothing(path, monkeypatch, capsys):
    """Back an hour and forth a day, at each picture: time left and status follow another clock."""
    now, real = [0.0], time.monotonic
    jumps = iter(range(1000))
    monkeypatch.setattr(time, "time", lambda: 1e9 + (-1) ** (n := next(jumps)) * n * 86400.0)
    monkeypatch.setattr(run.time, "monotonic", lambda: now[0])

    def answer(index, times):
        now[0] += 30.0
        return RENDERED

    lefts = []
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with RunStatus(path.parent) as shown:

        def tell(outcome, left):
            lefts.append(left)
            shown.tell(outcome, left)

        outcome = run.run(path, LiveWorkers(answer), tell)
        shown.end("done", outcome)
    monkeypatch.setattr(time, "monotonic", real)
    assert lefts == [pytest.approx(30.0 * left) for left in range(19, -1, -1)]
    status = json.loads((path.parent / STATUS).read_text())
    assert (status["state"], status["done"], status["total"]) == ("done", 20, 20)
    drawn = capsys.readouterr().err
    assert "10/20" in drawn and "5 min left" in drawn


def test_two_runs_in_one_folder(tmp_path):
    with (
        locked(tmp_path),
        pytest.raises(InputError, match=f"process {os.getpid()} on .* at work"),
        locked(tmp_path, patience=0.1),
    ):
        pytest.fail("both hold it")
    with locked(tmp_path):  # it is free again
        pass


def test_a_killed_run_holds_no_folder(tmp_path):
    script = (
        "import sys, time; from pathlib import Path\n"
        "from spectral_skylight.addon.batch.lock import locked\n"
        f"with locked(Path({str(tmp_path)!r})):\n    print('held', flush=True); time.sleep(600)"
    )
    holder = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(InputError, match=f"process {holder.pid}"), locked(tmp_path, patience=0):
        pytest.fail("both hold it")
    holder.send_signal(signal.SIGTERM if os.name == "nt" else signal.SIGKILL)
    holder.wait()
    with locked(tmp_path, patience=0.5):
        pass


def test_only_our_leftovers_are_cleared(path, monkeypatch):
    folder = path.parent / "pictures" / "a"
    folder.mkdir(parents=True)
    alive = atomic_file.part_of(folder / "b.exr")
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    monkeypatch.setattr(os, "getpid", lambda: dead.pid)
    ours = atomic_file.part_of(folder / "a.exr")
    others = folder / ours.name.replace(atomic_file.host(), "elsewhere")
    kept = [others, folder / "a.exr", folder / "a.part.exr", alive, path]
    for each in (ours, *kept[:4], part := atomic_file.part_of(path)):
        each.touch()
    run.clear_leftovers(path.parent)
    assert not ours.exists() and not part.exists() and all(each.exists() for each in kept)
