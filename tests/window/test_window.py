"""The add-on in a real Blender's window: installed from its zip, with Esc and undo, the tutorial.

Debian's Blender runs Debian's Python, with numpy alone: nothing of ours is compiled.
"""

import json
import os
import shutil
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

from spectral_skylight.tests import exr
from spectral_skylight.tests.window import tutorial
from spectral_skylight.tests.window.window import Debian, Window

pytestmark = [
    pytest.mark.window,
    pytest.mark.slow,
    pytest.mark.skipif(
        "SKYLIGHT_SID" not in os.environ, reason="sh tests/window/run brings a Blender with window"
    ),
]

ROOT = Path(__file__).resolve().parents[2]
COMMAND = Path(sys.executable).with_name("spectral-skylight")
KEYS = {"Enter": "Return", "Esc": "Escape"}
SCRIPT = """
import bpy, json, sys
import spectral_skylight
from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.tests.window import tutorial
spectral_skylight.register()
bpy.ops.wm.read_homefile(use_factory_startup=True)
answers = []
for step in tutorial.steps():
    exec(step.script)
    found = spectral_material.managed(bpy.data.materials["Material"])
    answers.append(found and [list(row) for row in found.matrix])
open("answers.json", "w").write(json.dumps(answers))
import os
os._exit(0)
"""


def command(*arguments):
    subprocess.run([COMMAND, *map(str, arguments)], check=True)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The folder with the files that the tutorial names."""
    folder = tmp_path_factory.mktemp("files")
    command("sky", "--sun-elevation", "35", "--out", folder / "sky.exr")
    for name, content in tutorial.files().items():
        (folder / name).write_text(content)
    return folder


@pytest.fixture(scope="module")
def equipped(files):
    """Debian with Blender and the add-on, installed from its zip."""
    debian = Debian(Path(os.environ["SKYLIGHT_SID"]), "window")
    for file in files.iterdir():
        shutil.copy(file, debian.folder)
    version = tomllib.loads((ROOT / "blender_manifest.toml").read_text())["version"]
    archive = ROOT / "dist" / f"spectral_skylight-{version}.zip"
    shutil.copy(archive, debian.folder)
    said = debian.run(
        *("blender", "--command", "extension", "install-file", "--repo", "user_default"),
        *("--enable", f"{debian.inside}/{archive.name}"),
        check=False,
    )
    assert "nstalled" in said
    return debian


@pytest.fixture(scope="module")
def bare(files):
    """Debian with Blender, and nothing of ours."""
    return Debian(Path(os.environ["SKYLIGHT_SID"]), "bare")


def test_a_finished_file_renders_without_the_add_on(bare, files):
    """What the command line made here, rendered there by Eevee's neighbour Cycles."""
    scene = files / "scene.blend"
    make = (
        "import bpy; bpy.ops.wm.read_homefile(use_factory_startup=True); s = bpy.context.scene; "
        "s.render.engine = 'CYCLES'; s.cycles.samples = 4; s.cycles.use_denoising = False; "
        "s.render.resolution_x = s.render.resolution_y = 24; "
        f"bpy.ops.wm.save_as_mainfile(filepath={str(scene)!r}); import os; os._exit(0)"
    )
    subprocess.run([sys.executable, "-c", make], check=True, stdout=subprocess.DEVNULL)
    done = files / "done.blend"
    brick = f"Material={files / 'brick.csv'}"
    command("apply", scene, "--sky", files / "sky.exr", "--assign", brick, "--out", done)
    # At the same path, for the World's image is beside it.
    shutil.copytree(files, bare.root / files.relative_to("/"), dirs_exist_ok=True)
    command("render", done, "--engine", "cycles", "--out", files / "here.exr")
    bare.run(
        *("blender", "--background", str(done), "--render-format", "OPEN_EXR"),
        *("--render-output", f"{bare.inside}/there_", "--render-frame", "1"),
    )
    (there,) = bare.folder.glob("there_*.exr")
    here, there = (exr.picture(path)[8:16, 8:16, :3] for path in (files / "here.exr", there))
    assert here.min() > 0.003  # the cube, and no error's magenta or black
    assert there == pytest.approx(here, rel=0.02, abs=0.002)


def test_esc_and_undo(equipped):
    """Esc ends a bake and leaves nothing of it; one Ctrl-Z takes back one click, redo brings it."""
    with Window(equipped) as window:
        window.press_tab("Skylight")
        window.press("Load Sky HDRI...")
        window.press("sky.exr", times=2)
        window.find("Sky: sky.exr")
        window.press("Make Everything Spectral")
        window.wait("matrix('Material') is not None")
        window.ask("solid()")
        given = window.ask("matrix('Material')")
        window.hover(window.box("WINDOW"))
        window.key("ctrl+z")
        window.wait("matrix('Material') is None")
        window.key("ctrl+shift+z")
        window.wait("matrix('Material') is not None")
        assert window.ask("matrix('Material')") == given

        window.ask("setattr(bpy.context.scene.world.skylight, 'occlusion', 'baked')")
        window.wait("not following()", 120)
        # A bake of some seconds: the cube becomes a sphere of many faces.
        window.ask(
            "bpy.data.objects['Cube'].modifiers.new('Fine', 'SUBSURF').__setattr__('levels', 5)"
        )
        before = window.ask("[len(bpy.data.objects), bpy.data.objects['Cube'].modifiers.keys()]")
        window.press("Advanced")
        window.press("Sun, Shadows and Ground")
        window.hover(window.find("Bake Light"))
        window.pointer("click", "1")
        window.wait("at_work()", 60)
        window.shot("baking")
        window.key("Escape")
        window.wait("not at_work()", 60)
        after = window.ask("[len(bpy.data.objects), bpy.data.objects['Cube'].modifiers.keys()]")
        assert after == before

        for language in ("de_DE", "es", "fr_FR", "ja_JP"):
            window.ask(f"setattr(bpy.context.preferences.view, 'language', {language!r})")
            own = set(window.ask(TRANSLATED))
            assert len(own) == 2 and not own & {"Make Everything Spectral", "Wall: emits light"}
            window.shot(language, window.box("UI"))


TRANSLATED = """[
    bpy.app.translations.pgettext_iface('Make Everything Spectral', 'Operator'),
    ours('addon.ui.translation').translated('Wall: emits light'),
]"""
"""What Blender looks up, and what is composed."""


def test_the_light_follows(equipped):
    """Four clicks after N bring all light; what moves gets its own without another click, and Esc
    stops. Nothing of ours holds up the window meanwhile."""
    with Window(equipped) as window:
        window.ask("bpy.ops.mesh.primitive_plane_add(size=12, location=(0, 0, -1))")
        window.ask("bpy.context.object.data.materials.append(bpy.data.materials['Material'])")
        window.press_tab("Skylight")
        window.step("load a sky")
        window.press("Load Sky HDRI...")
        window.press("sky.exr", times=2)
        window.find("Sky: sky.exr")
        window.step("make spectral")
        window.press("Make Everything Spectral")
        assert window.ask("shading()") in ("MATERIAL", "RENDERED")
        window.ask("solid()")
        window.step("all light")
        window.wait("light('Plane') is not None and not following()", 240)
        assert window.clicks == 4 and window.ask("matrix('Material')") is not None
        first = window.ask("light('Plane')")
        window.step("an object is moved")
        window.ask("setattr(bpy.data.objects['Cube'], 'location', (0, 0, 2))")
        window.wait("following()", 20)
        window.wait("not following()", 120)
        lifted = window.ask("light('Plane')")
        assert lifted > 1.02 * first  # the cube hides less of the sky
        window.hover(window.box("WINDOW"))
        window.ask(
            "bpy.data.objects['Cube'].modifiers.new('Fine', 'SUBSURF').__setattr__('levels', 6)"
        )
        window.wait("following()", 20)
        window.shot("following")
        window.step("Esc")
        window.key("Escape")
        window.wait("not following()", 5)
        window.find("Stopped")
        window.no_freeze()


def test_the_first_minute(equipped):
    """Two clicks from the tab to the example house in spectral light; then a village of 400 houses,
    and nothing of ours holds up the window."""
    with Window(equipped) as window:
        window.press_tab("Skylight")
        window.step("open the example")
        clicks = window.clicks
        window.press("Open Example House")
        window.step("make spectral")
        window.press("Make Everything Spectral")
        assert window.ask("shading()") in ("MATERIAL", "RENDERED")
        window.ask("solid()")
        window.step("all light")
        window.wait("light('House') is not None", 240)
        assert window.clicks - clicks == 2 and window.ask("matrix('Plaster')") is not None
        window.shot("example")
        window.hover(window.box("WINDOW"))
        window.step("Esc")
        window.key("Escape")
        window.wait("not following()", 5)
        window.step("a village of 400")
        window.ask("village(20)")
        window.ask("solid()")
        window.press("Make Everything Spectral")
        window.ask("solid()")
        window.wait("len(lit()) > 400", 400)
        window.step("Esc among 400")
        window.hover(window.box("WINDOW"))
        window.key("Escape")
        window.wait("not following()", 5)
        window.no_freeze()


def test_the_tutorial(equipped, files):
    """Pressed in the window as it says, it gives what its scripts give, and keeps its pictures."""
    subprocess.run([sys.executable, "-c", SCRIPT], cwd=files, check=True)
    expected = json.loads((files / "answers.json").read_text())
    with Window(equipped) as window:
        for step, matrix in zip(tutorial.steps(), expected, strict=True):
            for kind, text in step.actions:
                act(window, kind, text)
            if step.picture:
                view = window.box("WINDOW")
                window.hover(view)
                time.sleep(1)
                window.shot(Path(step.picture).stem, view)
            window.wait(f"near('Material', {matrix})")


def act(window, kind, text):
    if kind == "key":
        if text == "N":
            return  # the sidebar is opened with its tab
        if text != "Enter":
            window.hover(window.box("WINDOW"))
        window.key(KEYS.get(text, text))
        time.sleep(1.5)
    elif kind == "type":
        window.type(text)
        time.sleep(1.5)
    elif kind == "choose":
        time.sleep(1)
        window.press(text, times=2)
    elif kind == "see":
        window.find(text)
    elif text == "Skylight":
        window.press_tab(text)
    else:
        window.press(text)
        if text == "Make Everything Spectral":
            window.wait_for_shaders()
