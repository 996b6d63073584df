"""The panel writes a study, starts it beside Blender, shows how far it is, and can end it."""

import time
import tomllib

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.batch.study import read_study
from spectral_skylight.addon.ui import batch
from spectral_skylight.tests.ui import stage


@pytest.fixture
def office(scene, tmp_path):
    """The scene saved, with two cameras, and CSVs of two variants."""
    for name in ("South", "Court"):
        camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
        camera.location, camera.rotation_euler = (0, -4, 0), (np.pi / 2, 0, 0)
        scene.collection.objects.link(camera)
        scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = 8
    (tmp_path / "variants").mkdir()
    for name in ("brick", "moss"):
        text = f"material,reflectance\nWall,../brick.csv:{name}\n"
        (tmp_path / "variants" / f"{name}.csv").write_text(text)
    chosen = scene.skylight_batch
    chosen.files, chosen.variants = str(tmp_path / "sky.exr"), "//variants"
    chosen.engine, chosen.samples, chosen.workers = "cycles", 1, 1
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "house.blend"))
    yield tmp_path
    bpy.context.window_manager.skylight_batch.state = ""


def save():
    bpy.ops.wm.save_as_mainfile(filepath=bpy.data.filepath)


@pytest.mark.blender
def test_the_study_is_what_was_chosen(office, scene):
    assert bpy.ops.skylight.batch_write() == {"FINISHED"}
    path = office / "house.study.toml"
    text = path.read_text(encoding="utf-8")
    assert "# folder for everything that the study writes" in text
    assert str(office) not in text  # all paths are relative: the folder can be moved
    study = read_study(path)
    assert study.out == office / "batch" and study.scenes == (office / "house.blend",)
    assert [v.name for v in study.variants] == ["brick", "moss"] and study.cameras is None
    chosen = scene.skylight_batch
    chosen.source, chosen.times, chosen.north = "PLACE", "09:00, 15:30", 12.5
    chosen.latitude, chosen.longitude, chosen.timezone = 48.1, 11.6, "Europe/Berlin"
    chosen.cameras, chosen.names, chosen.variants = "NAMED", "Court, South", ""
    bpy.ops.skylight.batch_write()
    study = read_study(path)
    assert [sky.name for sky in study.skies] == ["2025-06-21_0900", "2025-06-21_1530"]
    assert study.skies[0].north == 12.5 and study.cameras == ("Court", "South")
    assert [v.name for v in study.variants] == ["as-is"]
    written = path.read_bytes()
    chosen.cameras, chosen.source = "ACTIVE", "FILES"
    bpy.ops.skylight.batch_write()
    assert tomllib.loads(path.read_text(encoding="utf-8"))["cameras"] == ["Court"]
    chosen.files = "//nowhere"
    before = path.read_bytes()
    assert before != written
    assert "nowhere" in stage.error_of(bpy.ops.skylight.batch_write)
    assert path.read_bytes() == before


@pytest.mark.blender
def test_what_is_not_saved_is_not_started(office, scene, addon):
    scene.skylight_batch.samples = 2
    scene.name = "Changed"
    bpy.ops.ed.undo_push(message="changed")
    if bpy.data.is_dirty:
        assert "Save the file first" in batch.SKYLIGHT_OT_batch_start.disabled_reason(bpy.context)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert "Save the file first" in batch.SKYLIGHT_OT_batch_write.disabled_reason(bpy.context)
    assert "No study" in batch.SKYLIGHT_OT_batch_cancel.disabled_reason(bpy.context)


@pytest.mark.blender
def test_the_panel_shows_a_run_and_touches_no_file(office, scene, monkeypatch):
    states = [
        {"state": "rendering", "line": "3 min left", "done": 1, "total": 4},
        {"state": "failed", "line": "1 picture(s) failed", "done": 3, "total": 4},
    ]

    class Run:
        out = office
        running = True

        def status(self):
            return states.pop(0)

    monkeypatch.setattr(batch, "_run", Run())
    assert batch.watch() == batch.PACE
    shown = bpy.context.window_manager.skylight_batch
    assert (shown.state, shown.factor) == ("rendering", 0.25)
    monkeypatch.setattr("builtins.open", None)
    drawn = stage.drawn(batch.SKYLIGHT_PT_batch)
    monkeypatch.undo()
    assert ("skylight.batch_cancel" in drawn.operators) and "files" in drawn.properties
    assert [o for kind, _, o in drawn.drawn if kind == "progress"] == [
        {"factor": 0.25, "text": "3 min left"}
    ]
    (office / "report.html").touch()
    Run.running = False
    monkeypatch.setattr(batch, "_run", Run())
    assert batch.watch() is None  # the timer ends with the run
    drawn = stage.drawn(batch.SKYLIGHT_PT_batch)
    assert drawn.operators == ["skylight.batch_start", "skylight.batch_write", "wm.path_open"]
    assert "1 picture(s) failed" in drawn.text
    assert shown.report == str(office / "report.html")


@pytest.mark.slow
def test_a_study_renders_beside_blender(office, scene, monkeypatch):
    """Started, undone, followed to its end; started again with a mistake, which is shown."""
    assert bpy.ops.skylight.batch_start() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="A study is rendering"):
        bpy.ops.skylight.batch_start()
    bpy.ops.ed.undo_push(message="one")
    bpy.ops.ed.undo_push(message="two")
    bpy.ops.ed.undo()
    shown, seen = bpy.context.window_manager.skylight_batch, set()
    until = time.monotonic() + 240
    while batch.watch() is not None and time.monotonic() < until:
        seen.add(shown.state)
        time.sleep(0.05)
    assert (shown.state, shown.factor) == ("done", 1.0), shown.line
    assert {"starting", "preparing", "rendering"} <= seen
    assert len(list((office / "batch" / "pictures").rglob("*.exr"))) == 4
    assert shown.report == str(office / "batch" / "report.html")
    bpy.context.scene.skylight_batch.cameras = "NAMED"
    bpy.context.scene.skylight_batch.names = "Cuort"
    save()
    # After an undo, and without a window, Blender calls every file changed.
    monkeypatch.setattr(batch, "_changed", lambda: "")
    bpy.ops.skylight.batch_start()
    while batch.watch() is not None and time.monotonic() < until:
        time.sleep(0.05)
    assert shown.state == "failed" and 'has no camera "Cuort"' in shown.line


@pytest.mark.slow
def test_cancel_ends_the_run_and_keeps_what_is_done(office, scene):
    scene.skylight_batch.samples = 1 << 20
    save()
    bpy.ops.skylight.batch_start()
    shown, until = bpy.context.window_manager.skylight_batch, time.monotonic() + 240
    while shown.state in ("starting", "preparing") and time.monotonic() < until:
        batch.watch()
        time.sleep(0.05)
    assert bpy.ops.skylight.batch_cancel() == {"FINISHED"}
    assert shown.state == "stopped" and batch.watch() is None
    assert bpy.ops.skylight.batch_start.poll() or bpy.data.is_dirty
