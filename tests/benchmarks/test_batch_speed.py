"""A plan of 100,000 pictures in seconds and constant memory; a picture's cost beyond its render.

Figures of rendering: `pytest tests/benchmarks/test_batch_speed.py --benchmark-enable -s`.
"""

import contextlib
import subprocess
import sys
import time
import tracemalloc

import pytest

from spectral_skylight.addon.batch import local_pool, plan, run
from spectral_skylight.addon.batch.scenes import SceneFile
from spectral_skylight.addon.batch.study import read_study
from spectral_skylight.tests.batch.studies import NOON, write_inputs, write_scene, write_study

pytestmark = pytest.mark.slow


def test_planning_a_hundred_thousand(benchmark, tmp_path):
    """40 cameras, 834 hours, 3 variants: under ten seconds, in as much memory as a quarter."""
    (tmp_path / "house.blend").touch()
    times = [f"{hour:02d}:{minute:02d}" for hour in range(6, 20) for minute in range(60)][:834]
    variants = [{"name": name, "assign": "red.csv"} for name in "abc"]
    write_inputs(tmp_path)
    study = read_study(write_study(tmp_path, skies=[{**NOON, "times": times}], variants=variants))

    def write(cameras):
        names = tuple(f"View {number}" for number in range(cameras))
        scene = SceneFile(tmp_path / "house.blend", "c", "Scene", names, 1, "cycles", (16, 16))
        return plan.write_plan(study, (scene,), "program")

    start = time.process_time()
    path = benchmark.pedantic(write, (40,))
    assert plan.read_header(path)["tasks"] == 100_080
    assert time.process_time() - start < 10
    peaks = {}
    tracemalloc.start()
    for cameras in (2, 8):
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        write(cameras)
        peaks[cameras] = tracemalloc.get_traced_memory()[1] - before
    tracemalloc.stop()
    print(f"peak {peaks[8] / 1e6:.2f} MB for {834 * 3 * 8} pictures")
    assert peaks[8] < 1.1 * peaks[2] < 5e6


@pytest.fixture(scope="module")
def office(tmp_path_factory):
    """A prepared study of forty cameras: a wall at 240 x 160 and 32 samples."""
    pytest.importorskip("bpy")
    from spectral_skylight.addon import cli

    folder = write_inputs(tmp_path_factory.mktemp("office"))
    write_scene(folder / "house.blend", cameras=40)
    path = write_study(folder, resolution=[240, 160], samples=32)
    assert cli.main(["batch", "plan", str(path), "--prepare"]) == 0
    return folder / "out" / "plan.jsonl"


def clear(path):
    for picture in path.parent.glob("pictures/*/*"):
        picture.unlink()


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_pictures_a_minute(benchmark, office, workers):
    """The start of the workers' Blenders is in it, as it is at night."""
    if benchmark.disabled:
        pytest.skip("figures only with --benchmark-enable")
    clear(office)

    def all_of_them():
        with contextlib.closing(local_pool.LocalPool(office.parent, workers)) as pool:
            size = local_pool.TOGETHER
            return run.run(office, pool, lambda *_: None, size, workers)

    start = time.monotonic()
    assert benchmark.pedantic(all_of_them).rendered == 40
    print(f"{workers} worker(s): {40 * 60 / (time.monotonic() - start):.0f} pictures a minute")


ALONE = """
import os, sys, time
import bpy
blend, out, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
bpy.ops.wm.open_mainfile(filepath=blend)
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 240, 160, 32
settings = scene.render.image_settings
start = time.process_time()
for number in range(1, count + 1):
    scene.camera = scene.objects[f"View {number}"]
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
    scene.render.filepath = f"{out}/{number}.exr"
    bpy.ops.render.render(write_still=True)
    settings.file_format, settings.color_depth = "PNG", "8"
    bpy.data.images["Render Result"].save_render(f"{out}/{number}.png")
print("took", time.process_time() - start)
sys.stdout.flush()
os._exit(0)
"""


def test_what_a_picture_costs_beyond_its_render(benchmark, office, tmp_path):
    """Processor time of a task against that of a bare script which renders the same files."""
    if benchmark.disabled:
        pytest.skip("figures only with --benchmark-enable")
    task = next(plan.read_tasks(office))
    count, costs = 12, {"bare": [], "ours": []}
    bare = [sys.executable, "-c", ALONE, str(office.parent / task.blend), str(tmp_path), str(count)]
    ours = [sys.executable, "-c", OURS, str(office), str(count)]
    for _ in range(3):
        for name, command in (("bare", bare), ("ours", ours)):
            clear(office)
            out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            costs[name].append(float(out.rpartition("took ")[2].split()[0]) / count)
    least = {name: min(each) for name, each in costs.items()}
    share = least["ours"] / least["bare"] - 1
    print(f"{least['bare']:.3f} s a picture bare, {least['ours']:.3f} s as a task: {share:+.1%}")
    assert share < 0.05
    benchmark.pedantic(lambda: None)


OURS = """
import json, os, sys, time
from pathlib import Path
sys.path.insert(0, str(Path(sys.argv[1]).parent))
import bpy
import render_task
path, count = Path(sys.argv[1]), int(sys.argv[2])
tasks = [json.loads(line) for line in path.open(encoding="utf-8")][1 : 1 + count]
render_task._open(path.parent / tasks[0]["blend"])
start = time.process_time()
for task in tasks:
    assert render_task.perform(task, path.parent)["status"] == "rendered"
print("took", time.process_time() - start)
sys.stdout.flush()
os._exit(0)
"""
