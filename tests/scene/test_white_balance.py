"""A World whose sky was balanced: said in the file, and undone where asked for."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.sky.panorama import write_panorama

pytestmark = pytest.mark.blender

TINT = np.array([1.0, 1.7, 1.0])
"""What no sky has: green by half."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("white")
    write_panorama(folder / "tinted.exr", np.ones((32, 64, 3)) / TINT)
    rows = [f"{x},{0.05 if x < 600 else 0.8}" for x in range(380, 781, 10)]
    (folder / "paint.csv").write_text("\n".join(["nm,red", *rows]), encoding="utf-8")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Wall")
    mesh.materials.append(bpy.data.materials.new("Wall"))
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Wall", mesh))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    return folder


def applied(folder, *options):
    """Apply, and return what the file then says of its sky."""
    out = folder / "out.blend"
    sky = ("--sky", folder / "tinted.exr", "--assign", f"Wall={folder / 'paint.csv'}")
    arguments = ["apply", folder / "scene.blend", *sky, "--out", out, *options]
    assert cli.main([str(argument) for argument in arguments]) == 0
    return light_group.record_of(blend_file.open_scene(out).world)


def test_a_tinted_world_is_said_to_be_so(folder, capsys):
    found = applied(folder)
    assert any("appears white-balanced" in note for note in found.notes)
    assert found.rest["outside"]["mostly"]
    assert "appears white-balanced" in capsys.readouterr().out


def test_auto_undoes_the_tint(folder, capsys):
    found = applied(folder, "--white", "auto")
    white = np.array(found.settings["white"])
    # The tint across the locus is known to some per cent, what lies along it is not.
    assert white[1] / np.sqrt(white[0] * white[2]) == pytest.approx(1.7, rel=0.25)
    assert not any("appears white-balanced" in note for note in found.notes)
    assert not found.rest["outside"]["mostly"]
    assert "white balance undone as" in capsys.readouterr().out
