"""A study from its TOML to its report, in real Blenders; `-c` is the same command."""

import contextlib
import html
import json
import os
import re
import signal
import subprocess
import sys
import time

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import atomic_file, cli
from spectral_skylight.addon.batch import plan, prepare
from spectral_skylight.addon.batch.task import SCRIPTS
from spectral_skylight.addon.scene.output import image_file, render_task
from spectral_skylight.addon.scene.world import hdri as worlds
from spectral_skylight.addon.scene.world import panorama
from spectral_skylight.tests import signals
from spectral_skylight.tests.batch.studies import (
    NOON,
    write_inputs,
    write_scene,
    write_study,
)

pytestmark = pytest.mark.slow

VARIANTS = [{"name": "red", "assign": "red.csv"}, {"name": "grey", "assign": "grey.csv"}]
SKIES = ["sky.exr", {**NOON, "north": 30}]


@pytest.fixture(scope="module")
def office(tmp_path_factory):
    """A scene with a texture and two cameras, and what a study needs."""
    folder = write_inputs(tmp_path_factory.mktemp("office"))
    write_scene(folder / "house.blend", cameras=2)
    image = bpy.data.images.new("Bricks", 4, 4)
    image.filepath_raw, image.file_format = str(folder / "bricks.png"), "PNG"
    image.save()
    image.source, image.use_fake_user = "FILE", True
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "house.blend"))
    return folder


def study(office, out, **changes):
    given = {"out": out, "skies": SKIES, "variants": VARIANTS, "sky_width": 256, **changes}
    return str(write_study(office, **given))


def tasks(office, out):
    return list(plan.read_tasks(office / out / "plan.jsonl"))


def pictures(office, out):
    """Bytes of all pictures by name."""
    root = office / out / "pictures"
    return {str(p.relative_to(root)): p.read_bytes() for p in root.rglob("*") if p.is_file()}


@pytest.fixture(scope="module")
def alone(office):
    """All eight pictures by one worker, with how many skies were analysed; report and output."""
    count, real = [], panorama.analyse
    panorama.analyse = lambda *given, **named: count.append(1) or real(*given, **named)
    try:
        code = cli.main(["batch", "run", study(office, "alone"), "--workers", "1"])
    finally:
        panorama.analyse = real
    assert code == 0
    return office / "alone", len(count)


@pytest.mark.blender
def test_all_pictures_are_there_and_say_what_they_are(alone, office):
    folder, analysed = alone
    assert analysed == 2  # skies; not four files, not eight pictures
    found = pictures(office, "alone")
    assert len(found) == 16
    for task in tasks(office, "alone"):
        assert image_file.whole(folder / task.exr, 16, 16, task.key)
    assert "house_grey_2025-06-21_1200/house_grey_2025-06-21_1200_View 2_0001.exr" in found
    assert len({content for name, content in found.items() if name.endswith(".exr")}) == 8
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert report["counts"] == {"done": 8} and len(report["pictures"]) == 8
    predicted = [m for p in report["prepared"].values() for m in p["materials"]]
    assert len(predicted) == 4 and all(0 <= m["matrix_delta_E"] < 3 for m in predicted)
    for kept in report["prepared"].values():
        assert set(kept) == set(re.findall(r"``(\w+)``", prepare.record.__doc__))
    page = (folder / "report.html").read_text(encoding="utf-8")
    links = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert len(links) == 24 and all((folder / link.replace("%20", " ")).is_file() for link in links)
    assert "//" not in page.replace("<!doctype html>", "")  # nothing from elsewhere
    assert json.loads((folder / "status.json").read_text())["state"] == "done"


@pytest.mark.blender
def test_prepared_files_need_nothing_from_elsewhere(alone, office, tmp_path):
    """Sky and textures lie beside them, by relative paths: the folder renders where it is moved."""
    moved = tmp_path / "moved"
    moved.mkdir()
    folder = alone[0]
    task = tasks(office, "alone")[1]
    for name in (task.blend, *(script.name for script in SCRIPTS), "plan.jsonl"):
        (moved / name).parent.mkdir(exist_ok=True)
        (moved / name).write_bytes((folder / name).read_bytes())
    for path in (folder / "prepared").iterdir():
        (moved / "prepared" / path.name).write_bytes(path.read_bytes())
    sources = [office / name for name in ("sky.exr", "bricks.png", "paint.csv", "red.csv")]
    with contextlib.ExitStack() as stack:
        for path in sources:
            stack.callback(path.with_suffix(".away").rename, path)
            path.rename(path.with_suffix(".away"))
        command = [sys.executable, str(moved / "render_task.py"), "--", str(moved / "plan.jsonl")]
        done = subprocess.run([*command, "--first", "1", "--count", "1"], capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    for name in (task.exr, task.png):
        assert (moved / name).read_bytes() == (folder / name).read_bytes()
    check = subprocess.run([*command, "--check"], capture_output=True, text=True)
    assert check.returncode == 1 and check.stdout.count('"failed"') == 7


@pytest.mark.blender
def test_true_north_is_where_the_study_says(office, alone):
    """North 30° clockwise from +Y: at solar noon the sun stands in the south, 30° clockwise of -Y.

    In the file itself the sun's lamp says where it shines from.
    """
    path = next((office / "alone" / "prepared").glob("house_red_2025*.blend"))
    record = json.loads(path.with_suffix(".json").read_text())
    elevation, azimuth = record["sun"]
    assert 130 < azimuth < 150  # 12:00 summer time is an hour and more before noon
    bpy.ops.wm.open_mainfile(filepath=str(path))
    sky = worlds.sky_of(bpy.context.scene.world)
    true = np.radians([elevation, 90.0 - azimuth])
    east_north_up = [
        np.cos(true[0]) * np.cos(true[1]), np.cos(true[0]) * np.sin(true[1]), np.sin(true[0])
    ]  # fmt: skip
    found = worlds.in_world(sky, np.array(east_north_up))
    bearing = np.degrees(np.arctan2(found[0], found[1])) % 360.0  # clockwise from +Y
    assert bearing == pytest.approx(azimuth + 30.0, abs=1e-3)
    lamps = [obj for obj in bpy.context.scene.objects if obj.type == "LIGHT"]
    shines = [np.array(lamp.matrix_world.to_3x3().col[2]) for lamp in lamps]
    assert shines and any(np.dot(each, found) > np.cos(np.radians(3.0)) for each in shines)


def test_a_second_run_mends_what_is_not_whole(alone, office, capsys):
    """Cut short, of another task, gone, or its PNG alone: rendered again, the same bytes."""
    before = pictures(office, "alone")
    first, second, third, fourth = (office / "alone" / t.exr for t in tasks(office, "alone")[:4])
    first.write_bytes(first.read_bytes()[:-100])
    second.write_bytes(third.read_bytes())
    third.with_suffix(".png").write_bytes(b"")
    fourth.unlink()
    name = atomic_file.part_of(fourth).name  # as of a process that is no more
    leftover = fourth.with_name(name.replace(f".{os.getpid()}-", ".99999999-"))
    leftover.touch()
    assert cli.main(["batch", "run", str(office / "alone" / "plan.jsonl"), "--workers", "2"]) == 0
    assert "4 rendered, 4 already done, 0 failed" in capsys.readouterr().out
    assert pictures(office, "alone") == before and not leftover.exists()


def test_killed_half_way_the_second_run_finishes_the_rest(alone, office, capsys):
    path = study(office, "killed")
    (office / "killed").mkdir()
    start = "import sys; from spectral_skylight.addon.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", start, "batch", "run", path, "--workers", "2"]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    until = time.monotonic() + 120
    while len(list(office.glob("killed/pictures/*/[!.]*.exr"))) < 3 and time.monotonic() < until:
        time.sleep(0.02)
    run.send_signal(signal.SIGTERM if os.name == "nt" else signal.SIGKILL)
    run.wait()
    there = len(list(office.glob("killed/pictures/*/[!.]*.exr")))
    assert 3 <= there < 8
    assert cli.main(["batch", "run", path, "--workers", "2"]) == 0
    rendered = int(re.search(r"(\d+) rendered", capsys.readouterr().out).group(1))
    assert 8 - there - 2 <= rendered <= 8 - there  # what was under way may have been finished
    assert pictures(office, "killed") == pictures(office, "alone")
    assert not list((office / "killed").rglob(".*.part*"))


def test_ctrl_c_ends_all_and_keeps_what_is_done(office):
    path = study(office, "stopped", skies=SKIES[1:])
    start = "import sys; from spectral_skylight.addon.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", start, "batch", "run", path, "--workers", "2"]
    run = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=None if os.name == "nt" else signals.heard,
    )
    until = time.monotonic() + 120
    while not list(office.glob("stopped/pictures/*/[!.]*.exr")) and time.monotonic() < until:
        time.sleep(0.02)
    run.send_signal(signal.SIGINT)
    _, error = run.communicate(timeout=30)
    assert run.returncode == 1 and error.splitlines()[-1].endswith("stopped")
    assert json.loads((office / "stopped" / "status.json").read_text())["state"] == "stopped"
    report = json.loads((office / "stopped" / "report.json").read_text())
    assert 1 <= report["counts"]["done"] < 4 and report["counts"]["missing"]


def test_one_that_cannot_be_written_fails_and_the_others_go_on(office, capsys):
    path = study(office, "blocked", skies=["sky.exr"])
    assert cli.main(["batch", "plan", path, "--prepare"]) == 0
    assert "1 skies computed for 4 pictures; 2 files prepared" in capsys.readouterr().out
    first = office / "blocked" / tasks(office, "blocked")[0].exr
    (first / "a folder").mkdir(parents=True)  # where the picture should be
    assert cli.main(["batch", "run", path, "--workers", "1"]) == 1
    said = capsys.readouterr()
    assert "3 rendered, 0 already done, 1 failed" in said.out and first.name in said.err
    report = json.loads((office / "blocked" / "report.json").read_text())
    assert report["counts"] == {"failed": 1, "done": 3}
    assert first.name in report["pictures"][0]["error"]
    page = (office / "blocked" / "report.html").read_text(encoding="utf-8")
    assert report["pictures"][0]["error"] in html.unescape(page)


@pytest.mark.skipif(os.name == "nt", reason="limits of file sizes are POSIX's")
def test_a_disk_that_is_full_is_told_and_leaves_nothing_half(office, tmp_path, capsys):
    """A limit on the size of files stands in for a small disk, which needs rights to make.

    Writing stops in the middle of a file, as it does on a full disk.
    """
    path = study(office, "full", skies=["sky.exr"], variants=VARIANTS[:1], cameras=["View 1"])
    blender = tmp_path / "blender"
    blender.write_text(
        '#!/bin/sh\nulimit -f 1\nwhile [ "$1" != "-P" ]; do shift; done\nshift\n'
        f'exec {sys.executable} "$@"\n'
    )
    blender.chmod(0o755)
    assert cli.main(["batch", "run", path, "--blender", str(blender)]) == 1
    error = capsys.readouterr().err.splitlines()
    assert any("View 1_0001" in line and "cut short" in line for line in error), error
    assert not [p for p in (office / "full" / "pictures").rglob("*") if p.is_file()]
    assert cli.main(["batch", "run", path]) == 0


def test_no_space_is_seen_before_rendering(alone, office, monkeypatch):
    """Less space than a picture takes: the render of an hour is not begun."""
    monkeypatch.setattr(render_task.shutil, "disk_usage", lambda _: shutil_usage(0))
    task = json.loads(tasks(office, "alone")[0].line()) | {"exr": "pictures/none.exr"}
    answer = render_task.perform(task, office / "alone")
    assert answer["status"] == "failed" and answer["no_space"]
    assert "no space left" in answer["error"]


def shutil_usage(free):
    return type("usage", (), {"free": free})()


def test_workers_say_what_is_missing_or_newer(alone, office, tmp_path):
    """A sky that was taken away, and a prepared file of a Blender that is not here."""
    import shutil

    root = tmp_path / "out"
    shutil.copytree(alone[0], root)
    task = json.loads(tasks(office, "alone")[0].line()) | {"exr": "again.exr"}
    sky = next((root / "prepared").glob("sky.*.exr"))
    sky.rename(sky.with_suffix(".away"))
    answer = render_task.perform(task, root)
    assert "misses image" in answer["error"] and sky.name in answer["error"]
    answer = render_task.perform({**task, "blend": "prepared/none.blend"}, root)
    assert "none.blend is missing" in answer["error"]
    sky.with_suffix(".away").rename(sky)
    assert render_task.perform({**task, "camera": "View 9"}, root)["error"].endswith("View 9")
    assert render_task.perform(task, root)["status"] == "rendered"


def test_two_runs_into_one_folder_the_second_says_no(alone, office, capsys):
    from spectral_skylight.addon.batch.lock import locked

    with locked(alone[0]):
        for step in ("run", "plan"):
            assert cli.main(["batch", step, study(office, "alone")]) == 2
            assert f"process {os.getpid()}" in capsys.readouterr().err
