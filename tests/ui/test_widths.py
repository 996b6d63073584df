"""What of the interface is cut off in a narrow sidebar, beyond the states of `test_states`."""

import bpy
import pytest

from spectral_skylight.addon.ui import (
    batch,
    follow,
    library,
    library_state,
    look_box,
    material_panel,
    panels,
    place,
    sky_box,
    text_width,
)
from spectral_skylight.tests.lanes import newest
from spectral_skylight.tests.ui import room

pytestmark = [pytest.mark.blender, newest]


def test_a_text_too_wide_is_found(scene, monkeypatch):
    def draw(layout, context):
        layout.label(text="W" * 30)
        layout.label(text="whole")

    found = room.cut_off(monkeypatch, draw)
    assert len(found) == 10 and all("WWW" in line for line in found)  # at 400 pixels it fits


@pytest.mark.parametrize("weather", ["clear", "cie", "epw"])
def test_the_fields_of_a_place(scene, monkeypatch, weather):
    scene.skylight_place.weather = weather
    draw = lambda layout, context: place.draw(layout.box(), scene.skylight_place)  # noqa: E731
    assert room.cut_off(monkeypatch, draw) == []


@pytest.mark.parametrize("kind", ["REFLECTANCE", "GLASS", "METAL"])
def test_a_material_with_a_file(scene, brick, monkeypatch, kind):
    own = bpy.data.materials["Wall"].skylight
    own.kind, own.filepath, own.behind = kind, brick, brick
    draw = lambda layout, context: material_panel.draw(  # noqa: E731
        layout, context, bpy.data.materials["Wall"]
    )
    assert room.cut_off(monkeypatch, draw) == []


@pytest.mark.parametrize("cameras, source", [("NAMED", "FILES"), ("ALL", "PLACE")])
def test_a_study(scene, monkeypatch, cameras, source):
    scene.skylight_batch.cameras, scene.skylight_batch.source = cameras, source
    assert room.cut_off(monkeypatch, room.of_panel(batch.SKYLIGHT_PT_batch)) == []


def test_the_library(scene, monkeypatch):
    library.show_built_in(bpy.context)
    try:
        assert room.cut_off(monkeypatch, room.of_panel(library.SKYLIGHT_PT_library)) == []
    finally:
        library_state.put(None)


def test_light_that_was_stopped(scene, monkeypatch):
    monkeypatch.setattr(follow, "_halt", "Stopped: not all light")
    assert room.cut_off(monkeypatch, look_box.light) == []
    monkeypatch.setattr(follow, "_halt", "")
    monkeypatch.setattr(follow, "_asked", 0.0)
    assert room.cut_off(monkeypatch, look_box.light) == []


def test_before_there_is_a_sky(scene, monkeypatch):
    scene.world = bpy.data.worlds.new("Grey")
    assert room.cut_off(monkeypatch, sky_box.draw) == []


@pytest.mark.parametrize("white_balanced", [False, True])
def test_what_the_numbers_of_a_sky_mean(scene, monkeypatch, white_balanced):
    numbers = scene.world.skylight
    numbers.sun_told, numbers.white_balanced = True, white_balanced
    for name in ("atmosphere", "daylight", "rayleigh"):
        numbers.basis = name
        assert room.cut_off(monkeypatch, room.of_panel(panels.SKYLIGHT_PT_numbers)) == []


def test_lines_are_as_wide_as_their_words():
    text = "Building materials, color checkers, and the measured materials in your folders"
    for wide in (120.0, 200.0, 400.0):
        lines = text_width.wrapped(text, wide)
        assert " ".join(lines) == text
        assert all(text_width.width(line) <= wide for line in lines)
    japanese = (
        "空がこれらのマテリアルから、隠されている割合は 50 % です。RGB × RGB では空全体が見えます。"
    )
    lines = text_width.wrapped(japanese, 130.0)
    assert "".join(lines).replace(" ", "") == japanese.replace(" ", "")
    assert all(text_width.width(line) <= 140.0 for line in lines)  # a comma may stand out
    assert not any(line.startswith(("、", "。")) for line in lines)
    assert any("RGB × RGB" in line for line in lines)
