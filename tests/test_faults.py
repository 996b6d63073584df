"""A full disk at ten levels, and kill -9, for commands that write: nothing lost or half-written."""

import os
import signal
import subprocess
import sys
import time

import pytest

from spectral_skylight.addon import cli
from spectral_skylight.tests import full_disk, kills
from spectral_skylight.tests.batch.studies import write_inputs, write_scene

POSIX = pytest.mark.skipif(os.name == "nt", reason="Windows neither limits files so nor kills so")

WRITE = {
    "sky": ("sky --sun-elevation 30 --width 128 --out a.exr --spectral b.exr", "a.exr", "b.exr"),
    "irradiance": ("irradiance sky.exr --out a.exr --map a.png", "a.exr", "a.png"),
    "picture": ("picture paint.csv:red --out a.png", "a.png"),
    "library": ("library . --sheet a.png", "a.png"),
    "apply": (
        "apply house.blend --assign Wall=paint.csv:red --occlusion open --out a.blend "
        "--write-assignments a.csv",
        "a.blend",
        "a.csv",
    ),
    "render": ("render house.blend --engine cycles --out a.exr", "a.exr", "a.png"),
    "plan": ("batch plan study.toml", "out/plan.jsonl"),
    "report": ("batch report out/plan.jsonl", "out/report.html", "out/report.json"),
}


@pytest.fixture(scope="module")
def office(tmp_path_factory):
    folder = tmp_path_factory.mktemp("office")
    pytest.importorskip("bpy", reason="the scene is Blender's")
    from spectral_skylight.tests.batch.studies import write_study

    write_scene(write_inputs(folder) / "house.blend")
    write_study(folder)
    return folder


@POSIX
@pytest.mark.blender
@pytest.mark.slow
@pytest.mark.parametrize("name", WRITE)
def test_a_full_disk_costs_nothing_that_was_there(office, capsys, monkeypatch, name):
    """Each output is the old one or the whole new one, and a line says why it is the old one."""
    command, *written = WRITE[name]
    monkeypatch.chdir(office)
    arguments = command.split()
    code = cli.main(arguments)
    assert code == 0 or name == "report"  # which fails where pictures are missing
    whole = {path: (office / path).read_bytes() for path in written}
    largest = max(map(len, whole.values()))
    for path in written:
        (office / path).write_bytes(b"old") if name not in ("report", "plan") else None
    for level in range(10):
        before = {path: (office / path).read_bytes() for path in written}
        capsys.readouterr()
        with full_disk.full_after(level * largest // 10):
            code = cli.main(arguments)
        found = {path: (office / path).read_bytes() for path in written}
        ours = [
            line for line in capsys.readouterr().err.splitlines() if "spectral-skylight:" in line
        ]
        assert code in (1, 2) and len(ours) == 1, (level, ours)
        assert "fault of this program" not in ours[0] and "Traceback" not in ours[0]
        for path in written:
            assert found[path] == before[path] or len(found[path]) == len(whole[path]), (
                level,
                path,
            )
        assert not [path for path in office.rglob(".*part*")]
    assert cli.main(arguments) == 0 or name == "report"


@POSIX
@pytest.mark.slow
@pytest.mark.parametrize("name", ["sky", "library"])
def test_kill_9_leaves_the_old_or_the_whole_new(tmp_path, name):
    """At three moments; at many by hand, and for what needs Blender: `tests/kills.py`."""
    pytest.importorskip("bpy", reason="the readers of its files import it")
    kills.killed(tmp_path, name, 3)


@POSIX
@pytest.mark.blender
@pytest.mark.slow
def test_a_request_to_end_comes_through_while_blender_starts(office):
    """Blender crashes of an exception in its start, and swallows one in its handlers."""
    command = [sys.executable, "-c", kills.MAIN, *WRITE["apply"][0].split()]
    began = time.monotonic()
    subprocess.run(command, cwd=office, check=True, capture_output=True)
    whole = time.monotonic() - began
    (office / "a.blend").write_bytes(b"old")
    # Of the time that it takes here; at its end it is done, whoever asks.
    for moment in (0.2 * whole, 0.4 * whole, 0.6 * whole, 0.75 * whole):
        running = subprocess.Popen(command, cwd=office, stderr=subprocess.PIPE, text=True)
        time.sleep(moment)
        running.terminate()
        said = running.communicate(timeout=60)[1].splitlines()
        if running.returncode == -signal.SIGTERM:  # it had not begun
            continue
        assert running.returncode == 1 and said[-1] == "spectral-skylight: stopped", said
        assert "Traceback" not in " ".join(said)
        assert (office / "a.blend").read_bytes() == b"old"


@POSIX
@pytest.mark.parametrize("command", ["library .", "sky --sun-elevation 30 --width 64 --out a.exr"])
def test_without_home_and_user_name(tmp_path, command):
    """As in a container: an id that nobody has, and no HOME."""
    write_inputs(tmp_path)
    keep = {key: value for key, value in os.environ.items() if not key.startswith(("HOME", "XDG"))}
    keep.pop("SPECTRAL_SKYLIGHT_CACHE", None)
    nobody = "import pwd\ndef none(_): raise KeyError\npwd.getpwuid = none\n"
    done = subprocess.run(
        [sys.executable, "-c", nobody + kills.MAIN, *command.split()],
        cwd=tmp_path, env=keep, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
