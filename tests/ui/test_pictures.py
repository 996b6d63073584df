"""Pictures in panels: asked for while drawing, made after it, kept by what they show."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.scene import portraits
from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.materials import rgb_comparison, spectral_material
from spectral_skylight.addon.ui import pictures, preview_cache
from spectral_skylight.tests.pictures.reading import read_png
from spectral_skylight.tests.ui.stage import drawn, material, write_sky

pytestmark = pytest.mark.blender

OF_MATERIAL = [
    pictures.SKYLIGHT_PT_curve,
    pictures.SKYLIGHT_PT_matrix,
    pictures.SKYLIGHT_PT_curve_properties,
    pictures.SKYLIGHT_PT_matrix_properties,
]


@pytest.fixture
def applied(scene, tmp_path):
    """Wall is brick, whose file begins at 400 nm."""
    file = tmp_path / "short.csv"
    file.write_text("nm,brick\n" + "".join(f"{nm},0.{nm}\n" for nm in range(400, 701, 10)))
    preview_cache.clear()
    bpy.ops.skylight.apply(filepath=str(file))
    return scene


@pytest.fixture
def made(monkeypatch):
    """What is drawn from now on, by its key."""
    drawn_ = []
    keep = preview_cache._keep
    monkeypatch.setattr(
        preview_cache, "_keep", lambda key, rgb: (drawn_.append(rgb), keep(key, rgb))
    )
    return drawn_


@pytest.mark.parametrize("panel", OF_MATERIAL)
def test_a_picture_is_asked_for_and_made_once(applied, made, panel):
    assert panel.poll(bpy.context)
    assert "Drawing..." in drawn(panel).text and not made  # nothing is computed while drawing
    preview_cache.draw_wanted()
    (rgb,) = made
    assert rgb.shape == (480, 480, 3)
    assert "Drawing..." in drawn(panel).text  # in the background Blender numbers no icons
    preview_cache.draw_wanted()
    assert len(made) == 1


def test_blender_holds_the_picture_and_shows_its_icon(applied, made, monkeypatch):
    drawn(pictures.SKYLIGHT_PT_matrix)
    preview_cache.draw_wanted()
    (key,) = preview_cache._names
    held = np.array(preview_cache.pixels(key)).reshape(480, 480, 4)[::-1]
    assert np.abs(held[..., :3] * 255.0 - made[0]).max() < 1.0 and (held[..., 3] == 1.0).all()
    monkeypatch.setattr(preview_cache, "icon", lambda key, draw: 7)
    assert ("template_icon", (), {"icon_value": 7, "scale": 12.5}) in drawn(
        pictures.SKYLIGHT_PT_matrix
    ).drawn


def test_pictures_follow_numbers_and_not_names(applied, made):
    drawn(pictures.SKYLIGHT_PT_curve)
    preview_cache.draw_wanted()
    material().name = "Another"
    bpy.ops.skylight.apply(filepath=material("Another").skylight.filepath, material="Roof")
    bpy.ops.skylight.update()
    drawn(pictures.SKYLIGHT_PT_curve)
    preview_cache.draw_wanted()
    assert len(made) == 1
    bpy.ops.skylight.estimate()
    shown = drawn(pictures.SKYLIGHT_PT_curve)
    preview_cache.draw_wanted()
    assert len(made) == 2 and (made[0] != made[1]).any()
    assert "Estimated" in shown.text


def test_words_stand_beside_the_curve(applied):
    assert "Measured from 400 to 700 nm" in drawn(pictures.SKYLIGHT_PT_curve).text
    found = portraits.portrait(material())
    assert found.measured == (400.0, 700.0) and len(found.spectrum) == 81
    assert not found.estimated


def test_the_matrix_is_ours_also_while_RGB_times_RGB_is_shown(applied):
    found = portraits.portrait(material())
    today = np.array(found.today)
    np.testing.assert_allclose(today, np.diag(np.diag(today)), atol=1e-6)
    rgb_comparison.show(True)
    assert spectral_material.managed(material()).matrix == pytest.approx(today, abs=1e-6)
    assert np.array(portraits.portrait(material()).matrix) == pytest.approx(np.array(found.matrix))
    assert np.array(portraits.portrait(material()).today) == pytest.approx(today)


def test_there_is_none_before_a_material_is_spectral(scene):
    assert not any(panel.poll(bpy.context) for panel in OF_MATERIAL)
    assert portraits.portrait(material()) is None
    assert "No material is spectral" in drawn(pictures.SKYLIGHT_PT_errors).text


def test_the_map_of_the_sky_is_made_anew_for_another_HDRI(applied, made, tmp_path):
    panel = pictures.SKYLIGHT_PT_sky_map
    assert panel.poll(bpy.context)
    drawn(panel)
    preview_cache.draw_wanted()
    drawn(panel)
    preview_cache.draw_wanted()
    assert len(made) == 1
    bpy.ops.skylight.load_sky(filepath=str(write_sky(tmp_path / "green.exr", turquoise=2.0)))
    drawn(panel)
    preview_cache.draw_wanted()
    assert len(made) == 2 and (made[0] != made[1]).any()


def test_a_sky_that_cannot_be_read_says_so(applied, made, tmp_path):
    (tmp_path / "sky.exr").unlink()
    applied.world.node_tree.nodes["Environment Texture"].image.reload()
    drawn(pictures.SKYLIGHT_PT_sky_map)
    preview_cache.draw_wanted()
    assert not made
    assert "cannot be read" in drawn(pictures.SKYLIGHT_PT_sky_map).text


def test_a_world_to_be_baked_waits_until_someone_wants_its_light(applied):
    applied.world = bpy.data.worlds.new("Grey")
    assert portraits.sky_key(applied.world) is None
    assert "Make a material spectral to show the map" in drawn(pictures.SKYLIGHT_PT_sky_map).text
    bpy.ops.skylight.update()
    assert portraits.sky_key(applied.world) is not None
    assert "Drawing..." in drawn(pictures.SKYLIGHT_PT_sky_map).text


def test_errors_are_bars(applied):
    shown = [options for kind, _, options in drawn(pictures.SKYLIGHT_PT_errors).drawn]
    bars = [options for options in shown if "factor" in options and "text" in options]
    ((_, today, ours),) = portraits.expected()
    assert [bar["text"] for bar in bars] == [f"{today:.2f}", f"{ours:.2f}"]
    assert [bar["factor"] for bar in bars] == pytest.approx(
        [today / max(today, 1.0), ours / max(today, 1.0)]
    )


def test_only_so_many_are_kept(applied):
    pixels = np.zeros((4, 4, 3), np.uint8)
    for number in range(preview_cache.KEPT + 5):
        preview_cache.icon(number, lambda: pixels)
        preview_cache.draw_wanted()
    assert len(preview_cache._names) == len(preview_cache._previews) == preview_cache.KEPT
    assert preview_cache.pixels(4) == [] and len(preview_cache.pixels(preview_cache.KEPT)) == 64
    preview_cache.clear()
    assert preview_cache.pixels(preview_cache.KEPT) == [] and preview_cache._previews is None


def test_the_same_from_the_command_line(applied, tmp_path, made):
    blend_file.save(tmp_path / "spectral.blend")
    drawn(pictures.SKYLIGHT_PT_curve)
    preview_cache.draw_wanted()
    scene, out = str(tmp_path / "spectral.blend"), tmp_path / "out.png"

    def run(*options):
        return cli.main(["picture", scene, "--out", str(out), *options])

    assert run("--material", "Wall", "--theme", "dark", "--scale", "1") == 0
    np.testing.assert_array_equal(read_png(out)[44:524, 20:500], made[0])
    assert run() == 0 and read_png(out).shape[1] == 780  # everyone's errors
    assert run("--material", "Roof") == 2 and run("--sky", "a.exr") == 2
