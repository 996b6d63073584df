"""The light meter of the panel: on a button and live, without a window."""

import bpy
import pytest

from spectral_skylight.addon.ui import meter
from spectral_skylight.tests.ui.stage import drawn

pytestmark = [pytest.mark.blender, pytest.mark.slow]


def read(scene):
    """Work as the timer does until the meter has read; return what the panel shows."""
    meter._read.clear()
    for _ in range(2000):
        meter.go_on(bpy.context)
        if scene.name in meter._read and meter._work is None:
            return meter._read[scene.name]
    raise AssertionError("nothing was read")


def lux(lines):
    return float(lines[0].removeprefix("Illuminance: ").split()[0].replace(",", ""))


def test_it_reads_at_the_cursor_and_again_when_that_moves(scene, capsys):
    scene.cursor.location = (0.0, 0.0, 5.0)
    assert "level_lux" in drawn(meter.SKYLIGHT_PT_meter).properties
    bpy.ops.skylight.measure()
    told = drawn(meter.SKYLIGHT_PT_meter)
    assert "Relative: set Lux on the Level" in told.text and "lx" not in told.text
    scene.world.skylight.level_lux = 20_000.0
    assert scene.world.skylight.level_lux == 20_000.0
    up = read(scene)
    assert lux(up) == pytest.approx(20_000.0, rel=0.01) and up[0].endswith(" lx")
    scene.cursor.rotation_euler = (3.14159, 0.0, 0.0)  # it looks at the HDRI's ground
    down = read(scene)
    assert 0.0 < lux(down) < 0.7 * lux(up)
    scene.skylight_meter.place = "CAMERA"
    assert read(scene) == ["Camera: the scene has none; add a camera"]
    with pytest.raises(RuntimeError, match="the scene has none"):
        bpy.ops.skylight.measure()
    scene.world = None
    assert not bpy.ops.skylight.measure.poll()


def test_nothing_is_computed_while_it_draws(scene, monkeypatch):
    from spectral_skylight.addon.scene import use_cases

    monkeypatch.setattr(use_cases, "measuring", lambda *_: pytest.fail("it measures"))
    scene.skylight_meter.live = True
    recorder = drawn(meter.SKYLIGHT_PT_meter)
    assert recorder.operators == ["skylight.measure"]
