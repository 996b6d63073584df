"""No command writes over what it reads, twice into one file, into a device, or another kind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.commands import matrix
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests import signals

POSIX = pytest.mark.skipif(os.name == "nt", reason="Windows has no such files and signals")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with one file of each kind that commands take."""
    monkeypatch.chdir(tmp_path)
    rows = [f"{x},0.5,0.2" for x in range(380, 781, 10)]
    for name in ("paint.csv", "chart.csv", "figure1.csv"):
        (tmp_path / name).write_text("\n".join(["nm,a,b", *rows]))
    write_panorama(tmp_path / "sky.exr", np.ones((8, 16, 3)))
    (tmp_path / "scene.blend").write_bytes(b"")
    (tmp_path / "scene.exr").write_bytes(b"")
    return tmp_path


def content(folder):
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.name: path.read_bytes() for path in files}


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("apply scene.blend --estimate A --out scene.blend", "--out: scene.blend is an input"),
        ("apply scene.blend --estimate A --out ./x/../scene.blend", "scene.blend is an input"),
        ("apply scene.blend --estimate A --out sky.exr", "is no .blend"),
        ("apply scene.blend --estimate A --out .blend", "is no .blend"),
        ("apply scene.blend --estimate A --out none/a.blend", "none is no folder"),
        (
            "apply scene.blend --assignments paint.csv --write-assignments paint.csv --out a.blend",
            "--write-assignments: paint.csv is an input",
        ),
        (
            "apply scene.blend --assign A=paint.csv:a --write-assignments paint.csv --out a.blend",
            "paint.csv is an input",
        ),
        ("irradiance sky.exr --out sky.exr", "--out: sky.exr is an input"),
        ("irradiance sky.exr --out a.png", "is no .exr"),
        ("irradiance sky.exr --out a.exr --map a.exr", "is no .png"),
        ("sky --sun-elevation 9 --out a.exr --spectral a.exr", "--spectral: a.exr is an output"),
        ("sky --sun-elevation 9 --out a.blend", "is no .exr"),
        ("sky --sun-elevation 9 --ground paint.csv:a --out paint.csv", "is no .exr"),
        ("picture paint.csv:a --out paint.csv", "is no .png"),
        ("library . --sheet paint.csv", "is no .png"),
        ("render scene.blend --out scene.blend", "is no .exr"),
        ("render scene.blend --out here.exr", "here.png is no regular file"),
        ("chart --out . --reflectances chart.csv", "--out: chart.csv is an input"),
        ("evaluate --out . --reflectances figure1.csv", "--out: figure1.csv is an input"),
        ("irradiance sky.exr --out pipe.exr", "pipe.exr is no regular file"),
        ("irradiance sky.exr --out link.exr", "link.exr is an input"),
        ("irradiance link.exr --out sky.exr", "sky.exr is an input"),
        ("irradiance sky.exr --out hard.exr", "hard.exr is an input"),
        ("picture paint.csv --basis=measured=b.png --out b.png", "b.png is an input"),
    ],
)
@POSIX
def test_what_must_not_be_written_is_told_before_any_work(here, capsys, command, said):
    os.mkfifo(here / "pipe.exr")
    (here / "link.exr").symlink_to("sky.exr")
    (here / "hard.exr").hardlink_to(here / "sky.exr")
    (here / "x").mkdir()
    (here / "here.png").mkdir()
    (here / "b.png").write_bytes(b"")
    before = content(here)
    assert cli.main(command.split()) == 2
    line = capsys.readouterr().err
    assert said in line and line.count("\n") == 1
    assert content(here) == before


def test_a_chart_may_stand_beside_other_inputs(here, capsys, monkeypatch):
    """Only names that it writes itself are in danger."""
    assert cli.main(["chart", "--out", ".", "--reflectances", "paint.csv", "--rounds", "0"]) == 2
    assert "--rounds" in capsys.readouterr().err


def test_what_nobody_foresaw_is_one_line(here, capsys, monkeypatch):
    monkeypatch.setattr(matrix, "run", lambda options: {}["a\nb"])
    assert cli.main(["matrix", "paint.csv"]) == 1
    line = capsys.readouterr().err
    assert line.count("\n") == 1 and "Traceback" not in line
    assert line.startswith("spectral-skylight: a fault of this program, KeyError: 'a")
    assert "please report this" in line
    monkeypatch.setenv("SPECTRAL_SKYLIGHT_TRACEBACK", "1")
    cli.main(["matrix", "paint.csv"])
    assert "Traceback" in capsys.readouterr().err


COMMAND = [sys.executable, "-c", "import sys; from spectral_skylight.addon import cli; "]
COMMAND[-1] += "sys.exit(cli.main(sys.argv[1:]))"


@POSIX
@pytest.mark.parametrize("kind", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_request_to_end_is_one_line_and_leaves_nothing(here, kind):
    arguments = ["sky", "--sun-elevation", "9", "--quality", "reference", "--out", "a.exr"]
    env = {**os.environ, "SPECTRAL_SKYLIGHT_CACHE": ""}
    running = subprocess.Popen(
        [*COMMAND, *arguments],
        env=env,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=signals.heard,
    )
    signals.wait_until_caught(running.pid, kind)
    time.sleep(1.0)  # Python itself catches Ctrl-C before the command does
    running.send_signal(kind)
    assert running.communicate(timeout=60)[1] == "spectral-skylight: stopped\n"
    assert running.returncode == 1
    assert not list(here.glob("*a.*"))


@POSIX
def test_a_reader_that_has_enough_or_a_full_disk(here):
    """Python itself would add lines of its own at its end."""
    done = subprocess.run(
        f"{sys.executable} -c '{COMMAND[-1]}' library | head -n 1",
        shell=True, capture_output=True, text=True,
    )  # fmt: skip
    assert len(done.stdout.splitlines()) == 1 and "Error" not in done.stderr
    if not (device := Path("/dev/full")).exists():
        return
    with device.open("w") as full:
        done = subprocess.run(
            [*COMMAND, "matrix", "paint.csv", "--json"], stdout=full, stderr=subprocess.PIPE
        )
    assert done.returncode == 1
    assert done.stderr == b"spectral-skylight: [Errno 28] No space left on device\n"


@POSIX
def test_a_terminal_that_shows_nothing_but_ascii(here):
    """In the language C, without UTF-8, where names of files are bytes of any kind."""
    name = b"wei\xdf.csv"
    try:
        (here / os.fsdecode(name)).write_bytes((here / "paint.csv").read_bytes())
    except OSError:
        pytest.skip("this file system takes UTF-8 alone")
    env = {**os.environ, "LC_ALL": "C", "LANG": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    env.pop("PYTHONIOENCODING", None)
    for arguments in (["matrix", name], ["matrix", name, "--json"], ["library", "."]):
        done = subprocess.run([*COMMAND, *arguments], env=env, capture_output=True, check=True)
        assert b"Traceback" not in done.stderr and (done.stdout + done.stderr).isascii()
