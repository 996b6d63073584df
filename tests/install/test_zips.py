"""The zips: what is in them, and that each Blender installs them, finds its wheels and works."""

import json
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = Path(__file__).with_name("in_blender.py")
PLATFORMS = {  # and the end of their wheels' names, `any` apart
    "linux-x64": r"manylinux.*_x86_64",
    "windows-x64": r"win_amd64",
    "macos-arm64": r"macosx_.*_arm64",
    "macos-x64": r"macosx_.*_x86_64",
}
LANES = ("5.3", "5.2", "4.5")
PAINTS = "nm,red,blue\n" + "".join(
    f"{nm},{0.05 + 0.5 * (nm > 590):.3f},{0.1 + 0.3 * (nm < 500):.3f}\n"
    for nm in range(380, 781, 10)
)

pytestmark = [
    pytest.mark.install,
    pytest.mark.slow,
    pytest.mark.skipif(  # zips in dist/ may be of another day's files
        "SKYLIGHT_ZIPS" not in os.environ,
        reason="sh tests/install/run builds the zips and tests them",
    ),
]


def archive(name):
    version = tomllib.loads((ROOT / "blender_manifest.toml").read_text())["version"]
    return ROOT / "dist" / f"spectral_skylight-{version}-{name}.zip"


@pytest.mark.parametrize("platform", PLATFORMS)
def test_each_platform_has_its_wheels_for_both_pythons(platform):
    with zipfile.ZipFile(archive(platform)) as files:
        manifest = tomllib.loads(files.read("blender_manifest.toml").decode())
        names = [name for name in files.namelist() if name.startswith("wheels/")]
    assert manifest["platforms"] == [platform]
    assert sorted(f"./{name}" for name in names) == sorted(manifest["wheels"])
    wheels = [Path(name).stem.split("-") for name in names]
    compiled = {(w[0], w[-3]) for w in wheels if re.fullmatch(PLATFORMS[platform], w[-1])}
    pure = {w[0] for w in wheels if w[-1] == "any"}
    assert len(compiled) + len(pure) == len(wheels)  # nothing of another platform
    pythons = ["cp311"] if platform == "macos-x64" else ["cp311", "cp313"]
    assert compiled == {(name, python) for name in ("scipy", "openexr") for python in pythons}
    assert {"colour_science", "tqdm", "typing_extensions"} <= pure
    assert "numpy" not in pure | {name for name, _ in compiled}
    assert ("blender_version_max" in manifest) == (platform == "macos-x64")


def test_wheels_are_the_locks():
    locked = {
        Path(wheel["url"]).name: wheel["hash"]
        for package in tomllib.loads((ROOT / "uv.lock").read_text(encoding="utf-8"))["package"]
        for wheel in package.get("wheels", ())
    }
    with zipfile.ZipFile(archive("linux-x64")) as files:
        names = [Path(name).name for name in files.namelist() if name.startswith("wheels/")]
    assert names
    assert [name for name in names if name not in locked] == []


def test_the_add_on_is_in_each_and_tests_are_in_none():
    for name in (*PLATFORMS, "without-wheels"):
        with zipfile.ZipFile(archive(name)) as files:
            names = files.namelist()
        assert {"__init__.py", "README.md", "LICENSE", "addon/registration.py"} <= {*names}
        tops = {name.partition("/")[0] for name in names}
        assert not tops & {"tests", "examples", "uv.lock", "pyproject.toml", ".ci"}


@pytest.fixture(scope="module")
def sky(tmp_path_factory):
    """A folder with sky.exr, paints.csv and what the command line computes of them."""
    folder = tmp_path_factory.mktemp("sky")
    command = [Path(sys.executable).with_name("spectral-skylight")]
    subprocess.run(
        [*command, "sky", "--sun-elevation", "45", "--out", folder / "sky.exr"], check=True
    )
    (folder / "paints.csv").write_text(PAINTS)
    said = subprocess.run(
        [*command, "matrix", folder / "paints.csv", "--sky", folder / "sky.exr", "--json"],
        check=True,
        capture_output=True,
    )
    return folder, {m["name"]: m["matrix"] for m in json.loads(said.stdout)["materials"]}


def blender(lane, folder, *arguments):
    """Run the script in a bare Blender with no user settings; what it answers."""
    (python,) = ROOT.glob(f".venvs/bare-{lane}/bin/python") or [None]
    if python is None:
        pytest.skip(f"no bare Blender {lane}: sh tests/install/run makes one")
    answer = folder / "answer.json"
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(folder / "user")}
    environment.pop("PYTHONPATH", None)
    done = subprocess.run(
        [python, SCRIPT, *map(str, arguments), answer],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(answer.read_text())


@pytest.mark.parametrize("lane", LANES)
def test_installed_enabled_and_used(lane, sky, tmp_path):
    """This Python's wheels, from Blender's folder; the same numbers; a file for any Blender."""
    folder, matrices = sky
    answer = blender(
        lane,
        tmp_path,
        *("use", archive("linux-x64"), folder / "sky.exr", folder / "paints.csv"),
    )
    assert answer["missing"] == ""
    site = str(tmp_path / "user" / "extensions" / ".local" / "lib")
    for name in ("colour", "scipy", "OpenEXR"):
        assert answer["modules"][name].startswith(site)
    assert not answer["modules"]["numpy"].startswith(site)
    for name, matrix in matrices.items():
        assert answer["matrices"][name] == pytest.approx(np.array(matrix), abs=1e-6)

    other = tmp_path / "other"
    other.mkdir()
    seen = blender(lane, other, "render", tmp_path / "answer.blend")
    assert np.array(seen["pixels"]).min() > 0.01
    assert np.array(seen["pixels"]) == pytest.approx(np.array(answer["pixels"]), abs=1e-6)


def test_without_wheels_one_sentence_says_what_to_do(tmp_path):
    answer = blender(LANES[0], tmp_path, "look", archive("without-wheels"))
    assert not answer["poll"]
    assert answer["panel"] == answer["missing"]
    assert "install the Spectral Skylight zip made for your platform" in answer["missing"]
