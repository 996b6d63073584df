"""What the commands of numbers import: numpy and Python's own, as a bare Blender has them."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from spectral_skylight.addon.cli import COMMANDS
from spectral_skylight.tests.skies import sky_pixels, write_hdr

NOT_IN_BLENDER = {
    *("colour", "scipy", "matplotlib", "pandas", "PIL", "tqdm", "OpenEXR", "imageio"),
    *("distributed", "pvlib"),
}
"""What Blender's Python has not; the first take seconds to import."""

SLOW = NOT_IN_BLENDER | {"bpy", "asyncio", "multiprocessing"}
"""What Blender imports itself, and numbers do not need."""

SKIES = {"numpy.ma", "concurrent.futures", "spectral_skylight.addon.sky.panorama"}
"""What a matrix without a sky leaves alone, beside those."""

RUN = """
import sys
from spectral_skylight.addon import cli
status = cli.main(sys.argv[1:])
print("imported:", *sorted(sys.modules), file=sys.stderr)
sys.exit(status)
"""


@pytest.fixture(scope="module")
def paints(tmp_path_factory):
    """24 reflectances in a folder of their own."""
    path = tmp_path_factory.mktemp("paints") / "paints.csv"
    rows = np.random.default_rng(0).uniform(0.05, 0.9, (41, 24))
    table = np.column_stack([np.arange(380, 781, 10), rows])
    header = ",".join(["wavelength", *(f"paint {k}" for k in range(24))])
    np.savetxt(path, table, "%.4f", ",", header=header, comments="")
    return path


@pytest.fixture(scope="module")
def hdri(tmp_path_factory):
    return write_hdr(tmp_path_factory.mktemp("sky") / "sky.hdr", sky_pixels(64))


def run(*arguments):
    """Run a command in a Python of its own; return what it printed and what it imported."""
    done = subprocess.run(
        [sys.executable, "-c", RUN, *map(str, arguments)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout, set(done.stderr.rpartition("imported:")[2].split())


def test_a_matrix_imports_numpy_and_no_more(paints):
    out, imported = run("matrix", paints, "--json")
    assert len(json.loads(out)["materials"]) == 24
    assert "numpy" in imported
    assert imported & (SLOW | SKIES) == set()


def test_a_command_imports_no_other_command(paints):
    _, imported = run("matrix", paints)
    commands = {name.split(".")[3] for name in imported if ".addon.commands." in name}
    assert commands == {"matrix", "under_sky", "arguments", "outputs"}


@pytest.mark.parametrize(
    "words",
    [
        ["matrix", "{paints}", "--sky", "{sky}", "--json"],
        ["library", "{folder}", "--sky", "{sky}", "--json"],
        ["library"],
        ["irradiance", "{sky}", "--out", "{out}/E.exr", "--map", "{out}/map.png"],
        ["picture", "{paints}:paint 3", "--sky", "{sky}", "--out", "{out}/p.png"],
    ],
    ids=lambda words: " ".join(words[:3]),
)
def test_skies_libraries_and_pictures_need_no_more(words, paints, hdri, tmp_path):
    places = {"paints": paints, "folder": paints.parent, "sky": hdri, "out": tmp_path}
    _, imported = run(*(word.format(**places) for word in words))
    assert imported & SLOW == set()


@pytest.mark.blender
def test_a_scene_is_made_spectral_without_more(paints, hdri, tmp_path):
    pytest.importorskip("bpy")
    scene = Path(__file__).parent / "files" / "base.blend"
    _, imported = run(
        *("apply", scene, "--sky", hdri, "--assign", f"Brick={paints}:paint 3"),
        *("--out", tmp_path / "out.blend"),
    )
    assert "bpy" in imported and (tmp_path / "out.blend").is_file()
    assert imported & NOT_IN_BLENDER == set()


@pytest.mark.parametrize("words, status", [(["--help"], 0), (["nonsense"], 2), ([], 2)])
def test_help_and_wrong_usage_know_every_command(words, status):
    done = subprocess.run([sys.executable, "-c", RUN, *words], capture_output=True, text=True)
    assert done.returncode == status
    said = done.stdout + done.stderr.partition("imported:")[0]
    if words:
        assert all(name in said for name in COMMANDS)
