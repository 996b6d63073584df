"""Pictures are whole, repeatable and what the file says, also without the add-on."""

import os
import subprocess
import sys

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli, tags
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.output import render
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.tests import exr, faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]


@pytest.fixture
def scene(tmp_path):
    scene = faces.empty_scene()
    world = faces.light(scene, tmp_path)
    material = bpy.data.materials.new("Matt")
    spectral_material.apply(material, world, spectral_material.Surface(np.eye(3)))
    light_group.set_coefficients(world, [[0.2, 0.4, 0.8], *np.full((3, 3), 0.1)])
    faces.add_faces(scene, faces.directions(16)).material_slots[0].material = material
    return scene


def settings_of(scene):
    owners = (scene, scene.render, scene.render.image_settings, scene.view_settings)
    return [
        {
            p.identifier: str(getattr(o, p.identifier))
            for p in o.bl_rna.properties
            if not p.is_readonly
        }
        for o in owners
    ]


def test_files_settings_and_repeats(scene, tmp_path):
    scene.render.engine = "CYCLES"
    scene.render.image_settings.file_format = "JPEG"
    scene.render.image_settings.quality = 33
    scene.render.resolution_percentage = 200
    before = settings_of(scene)
    one, png = render.render(scene, tmp_path / "new" / "one.exr", engine="eevee")
    assert settings_of(scene) == before
    assert sorted(f.name for f in one.parent.iterdir()) == ["one.exr", "one.png"]
    assert sorted(exr.planes(one)) == ["B", "G", "R"]
    assert exr.picture(one).shape == (24, 24, 3) and exr.picture(one).dtype == np.float32
    again, _ = render.render(scene, tmp_path / "two.exr", engine="eevee")
    assert again.read_bytes() == one.read_bytes()  # no date, no time, no host
    assert png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_png_goes_through_the_view_transform(scene, tmp_path):
    def brightness():
        _, png = render.render(scene, tmp_path / "view.exr", engine="eevee")
        image = bpy.data.images.load(str(png))
        values = np.array(image.pixels[:]).reshape(-1, 4)[:, :3]
        bpy.data.images.remove(image)
        return values

    scene.view_settings.view_transform = "Standard"
    linear = exr.picture(render.render(scene, tmp_path / "l.exr")[0])
    linear = linear[::-1].reshape(-1, 3)
    encoded = np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )
    # 8 bits, dithered by up to one step.
    np.testing.assert_allclose(brightness(), np.clip(encoded, 0, 1), atol=2.1 / 255)
    scene.view_settings.exposure = -2.0
    assert brightness().mean() < 0.7 * np.clip(encoded, 0, 1).mean()


def test_cameras_and_engines_by_name(scene, tmp_path):
    other = bpy.data.objects.new("Other", bpy.data.cameras.new("Other"))
    other.location = (0, 0, -10)
    scene.collection.objects.link(other)
    used = scene.camera
    render.render(scene, tmp_path / "other.exr", camera="Other", engine="cycles")
    assert scene.camera == used
    with pytest.raises(InputError, match='no camera "Third"; it has Camera, Other'):
        render.render(scene, tmp_path / "no.exr", camera="Third")
    with pytest.raises(InputError, match='"luxcore" is not known; use eevee or cycles'):
        render.render(scene, tmp_path / "no.exr", engine="luxcore")
    scene.camera = None
    with pytest.raises(InputError, match="has no active camera"):
        render.render(scene, tmp_path / "no.exr")
    assert not (tmp_path / "no.exr").exists()


PLAIN = """
import os, sys
sys.modules["spectral_skylight"] = None  # an import would raise
import bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
scene = bpy.context.scene
scene.render.engine = sys.argv[3]
scene.render.filepath = sys.argv[2]
if hasattr(scene.render.image_settings, "media_type"):
    scene.render.image_settings.media_type = "IMAGE"
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.image_settings.color_mode = "RGB"
bpy.ops.render.render(write_still=True)
os._exit(0)
"""


@pytest.mark.parametrize("engine", ["eevee", "cycles"])
def test_the_same_without_the_add_on(scene, tmp_path, engine):
    nodes = scene.world.node_tree.nodes
    nodes["Mapping"].inputs["Rotation"].default_value = (0.1, 0.2, 0.3)
    nodes["Background"].inputs["Strength"].default_value = 1.5
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"), copy=True)
    ours = faces.picture(scene, tmp_path, engine)
    command = [sys.executable, "-c", PLAIN, str(tmp_path / "saved.blend")]
    plain = tmp_path / "plain.exr"
    subprocess.run(
        [*command, str(plain), render.engine_id(engine)],
        check=True,
        capture_output=True,
        cwd=tmp_path,
        env={k: v for k, v in os.environ.items() if k != "PYTHONPATH"},
    )
    theirs = exr.picture(plain)
    assert ours.max() > 0.5 and np.ptp(ours) > 0.05
    np.testing.assert_array_equal(theirs, ours)


def test_the_command_says_what_shows_rgb_and_what_a_command_can_do(
    scene, tmp_path, capsys, monkeypatch
):
    """Whoever has no window cannot press the panel's button."""
    bpy.data.materials["Matt"][tags.SHOWS_RGB] = "[]"
    blend_file.save(tmp_path / "compared.blend")
    monkeypatch.setattr(render, "render", lambda *_: ())  # the pictures are others' matter
    assert cli.main(["render", f"{tmp_path}/compared.blend", "--out", f"{tmp_path}/a.exr"]) == 0
    said = capsys.readouterr().err
    assert said.startswith("WARNING: Matt: rendered as RGB × RGB") and "apply" in said
    assert "press" not in said
