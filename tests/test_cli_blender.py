"""`apply` and `render` on real blend files, and that what they write needs no add-on."""

import subprocess
import sys

import bpy
import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.materials.assigned import assigned
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama
from spectral_skylight.tests import exr

pytestmark = [pytest.mark.blender, pytest.mark.slow]

SIZE = 24


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A sky, a CSV of two materials and a scene: a floor seen from above, half red, half grey."""
    folder = tmp_path_factory.mktemp("cli")
    view = directions(32, 64)
    blue = np.array([0.2, 0.4, 1.0]) * (1.2 + view[..., 2:])
    write_panorama(folder / "sky.exr", np.where(view[..., 2:] > 0, blue, 0.1))
    rows = [f"{x},{0.05 if x < 600 else 0.8},0.5" for x in range(380, 781, 10)]
    (folder / "paint.csv").write_text("\n".join(["nm,red,grey", *rows]), encoding="utf-8")
    gold = ["nm,n,k", *(f"{x},0.3,3.0" for x in range(380, 781, 20))]
    (folder / "gold.csv").write_text("\n".join(gold), encoding="utf-8")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE"
    scene.eevee.taa_render_samples = 1
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.filter_size = 0.01
    for name, x in (("Wall", -1), ("Floor", 1)):
        mesh = bpy.data.meshes.new(name)
        corners = [(x - 1, -1, 0), (x + 1, -1, 0), (x + 1, 1, 0), (x - 1, 1, 0)]
        mesh.from_pydata(corners, [], [[0, 1, 2, 3]])
        mesh.materials.append(bpy.data.materials.new(name))
        scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    camera = bpy.data.objects.new("Above", bpy.data.cameras.new("Above"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 2, (0, 0, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    return folder


@pytest.fixture(scope="module")
def applied(folder):
    out = folder / "out.blend"
    code = cli.main([
        *("apply", str(folder / "scene.blend"), "--sky", str(folder / "sky.exr")),
        *("--assign", f"Wall={folder / 'paint.csv'}:red"),
        *("--assign", f"Floor={folder / 'paint.csv'}:grey"),
        *("--out", str(out)),
    ])  # fmt: skip
    assert code == 0
    return out


def read(path):
    assert all(plane.dtype == np.float32 for plane in exr.planes(path).values())
    return exr.picture(path)[..., :3]


@pytest.fixture(scope="module")
def rendered(applied):
    path = applied.with_name("picture.exr")
    assert cli.main(["render", str(applied), "--out", str(path), "--engine", "eevee"]) == 0
    return path


def test_picture_is_matrix_times_irradiance(rendered, folder):
    from spectral_skylight.addon.sky.irradiance import exact_irradiance
    from spectral_skylight.addon.sky.light import analyse
    from spectral_skylight.addon.sky.panorama import read_panorama
    from spectral_skylight.addon.spectra.reflectance import read_reflectances
    from spectral_skylight.addon.transfer.matrices import transfer

    image = read(rendered)
    assert image.shape == (SIZE, SIZE, 3) and rendered.with_suffix(".png").stat().st_size > 0
    sky = analyse(read_panorama(folder / "sky.exr"))
    E = exact_irradiance(sky.sky, [[0, 0, 1]])[0]
    known = {"sun_elevation": sky.sun_elevation(), "sky_rgb": sky.faces}
    M = transfer("atmosphere", **known).matrices(read_reflectances(folder / "paint.csv").values)
    # The polynomial may leave 1 %; half floats in the picture 0.05 %.
    for column, matrix in ((SIZE // 4, M[0]), (3 * SIZE // 4, M[1])):
        np.testing.assert_allclose(image[SIZE // 2, column], matrix @ E, rtol=0.011)


def test_renders_the_same_without_the_add_on(applied, rendered):
    """A fresh process that holds bpy alone: pixel for pixel."""
    alone = applied.with_name("alone")
    script = f"""
import os, sys, bpy
bpy.ops.wm.open_mainfile(filepath={str(applied)!r})
settings = bpy.context.scene.render.image_settings
if hasattr(settings, "media_type"):
    settings.media_type = "IMAGE"
settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
bpy.context.scene.render.filepath = {str(alone)!r}
bpy.ops.render.render(write_still=True)
assert not any(name.startswith("spectral_skylight") for name in sys.modules)
os._exit(0)
"""
    subprocess.run([sys.executable, "-c", script], check=True, capture_output=True)
    np.testing.assert_array_equal(read(alone.with_suffix(".exr")), read(rendered))


def test_applied_twice_is_applied_once(applied):
    blend_file.open_scene(applied)
    assert sorted(m.name for m in spectral_material.managed_materials()) == ["Floor", "Wall"]
    groups = len(bpy.data.node_groups)
    again = applied.with_name("again.blend")
    csv = applied.with_name("paint.csv")
    arguments = ["apply", str(applied), "--assign", f"Wall={csv}:grey", "--out", str(again)]
    assert cli.main(arguments) == 0
    blend_file.open_scene(again)
    assert len(bpy.data.node_groups) == groups and len(bpy.data.worlds) == 1
    wall = spectral_material.managed(bpy.data.materials["Wall"])
    np.testing.assert_allclose(wall.matrix, 0.5 * np.eye(3), atol=1e-6)


WRONG = {
    "no such scene": (["none.blend"], "none.blend"),
    "no such material": (["scene.blend", "--assign", "Roof=paint.csv:red"], "'Wall'"),
    "no such column": (["scene.blend", "--assign", "Floor=paint.csv:blue"], "'red', 'grey'"),
    "twice": (["scene.blend", "--assign", "Wall=paint.csv:grey"], "twice"),
    "World without an HDRI": (["scene.blend"], "World"),
    "other working space": (["scene.blend", "--space", "ACEScg"], "working space"),
    "no sky": (["scene.blend", "--sky", "paint.csv"], "paint.csv"),
    "not a blend": (["paint.csv"], "paint.csv"),
    "no such lamp": (["scene.blend", "--lamp", "Sconce=A"], "lamp 'Sconce'"),
    "estimate what is given": (["scene.blend", "--estimate", "Wall"], "twice"),
    "glass that is given": (["scene.blend", "--glass", "Wall=paint.csv:red"], "twice"),
    "behind what is not given": (["scene.blend", "--behind", "Floor=paint.csv:red"], "--assign"),
    "no file of n and k": (["scene.blend", "--metal", "Floor=none.csv"], "none.csv"),
    "no metal": (["scene.blend", "--metal", "Floor=gold.csv"], "Metallic"),
}


@pytest.mark.parametrize(("arguments", "part"), WRONG.values(), ids=WRONG.keys())
def test_bad_input_is_one_line_and_writes_nothing(folder, capfd, monkeypatch, arguments, part):
    monkeypatch.chdir(folder)
    scene, *options = arguments
    out = folder / "never.blend"
    code = cli.main(["apply", scene, "--assign", "Wall=paint.csv:red", *options, "--out", str(out)])
    error = capfd.readouterr().err
    ours = [line for line in error.splitlines() if line.startswith("spectral-skylight: ")]
    assert code == 2 and len(ours) == 1 and part in ours[0]
    assert not list(folder.glob("*never*"))


@pytest.mark.parametrize("command", ["animate", "sunlight"])
def test_a_city_is_a_place_for_every_command(folder, capfd, monkeypatch, command):
    monkeypatch.chdir(folder)
    on = [command, "none.blend", "--date", "2025-06-21"]
    on += ["--out", "day.blend"] if command == "animate" else []
    assert cli.main([*on, "--city", "munchen"]) == 2  # as there is no such scene
    out, error = capfd.readouterr()
    assert out.startswith("München, Germany: 48.14°, 11.58°, Europe/Berlin\n")
    assert "none.blend" in error
    for options, part in ((["--city", "Oz"], "--city: 'Oz'"), ([], "give --city, or --latitude")):
        assert cli.main([*on, *options]) == 2
        error = capfd.readouterr().err
        assert part in error and error.count("\n") == 1


def test_output_folder_that_is_not_there(folder, capfd, monkeypatch):
    monkeypatch.chdir(folder)
    arguments = ["apply", "scene.blend", "--sky", "sky.exr", "--assign", "Wall=paint.csv:red"]
    assert cli.main([*arguments, "--out", "none/out.blend"]) == 2
    assert "none" in capfd.readouterr().err


def test_a_table_of_assignments_is_written_and_read(folder, monkeypatch):
    """A closed block of glass, an estimate and a reflectance, by options and by a table."""
    monkeypatch.chdir(folder)
    first = ["apply", "scene.blend", "--sky", "sky.exr", "--estimate", "Floor"]
    first += ["--glass-block", "Wall=paint.csv:red", "--write-assignments", "table.csv"]
    assert cli.main([*first, "--out", "block.blend"]) == 0
    table = (folder / "table.csv").read_text().splitlines()
    assert table[1:] == ["Floor,estimate,,,,,", "Wall,,paint.csv:red,,,block,fraction"]
    again = ["apply", "scene.blend", "--sky", "sky.exr", "--assignments", "table.csv"]
    assert cli.main([*again, "--out", "again.blend"]) == 0
    seen = []
    for name in ("block.blend", "again.blend"):
        blend_file.open_scene(folder / name)
        pane = assigned(bpy.data.materials["Wall"])
        assert pane.faces == 2 and pane.values[0] == pytest.approx(0.05)
        seen.append(spectral_material.managed(bpy.data.materials["Floor"]).matrix)
    assert seen[0] == seen[1]
