"""The zip and its repository: what is in them, and that bare Blenders install and use them."""

import functools
import http.server
import json
import os
import shutil
import subprocess
import sys
import threading
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = Path(__file__).with_name("in_blender.py")
LANES = ("5.3", "5.2", "4.5")
LARGEST = 3_000_000
"""[bytes] of the zip."""
PAINTS = "nm,red,blue\n" + "".join(
    f"{nm},{0.05 + 0.5 * (nm > 590):.3f},{0.1 + 0.3 * (nm < 500):.3f}\n"
    for nm in range(380, 781, 10)
)

pytestmark = [
    pytest.mark.install,
    pytest.mark.slow,
    pytest.mark.skipif(  # what lies in dist/ may be of another day's files
        "SKYLIGHT_ZIPS" not in os.environ,
        reason="sh tests/install/run builds the zip and tests it",
    ),
]

VERSION = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))["version"]
ARCHIVE = ROOT / "dist" / f"spectral_skylight-{VERSION}.zip"


def test_one_zip_for_every_blender():
    """No wheels, no compiled module, no platform: it fits each Python and each system."""
    with zipfile.ZipFile(ARCHIVE) as files:
        names = files.namelist()
        manifest = tomllib.loads(files.read("blender_manifest.toml").decode())
    assert ARCHIVE.stat().st_size <= LARGEST
    assert {"__init__.py", "README.md", "LICENSE", "addon/registration.py"} <= {*names}
    tops = {name.partition("/")[0] for name in names}
    assert not tops & {"tests", "examples", "uv.lock", "pyproject.toml", ".ci", "wheels"}
    assert not [name for name in names if name.endswith((".whl", ".so", ".pyd", ".dylib"))]
    assert not manifest.keys() & {"wheels", "platforms", "blender_version_max"}


def test_the_repository_lists_it_with_a_page():
    folder = ROOT / "dist" / "repository"
    listing = json.loads((folder / "index.json").read_text(encoding="utf-8"))
    (one,) = listing["data"]
    assert (one["id"], one["version"]) == ("spectral_skylight", VERSION)
    assert (folder / ARCHIVE.name).read_bytes() == ARCHIVE.read_bytes()
    assert "Spectral Skylight" in (folder / "index.html").read_text(encoding="utf-8")


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


def python_of(lane):
    (python,) = ROOT.glob(f".venvs/bare-{lane}/bin/python") or [None]
    if python is None:
        pytest.skip(f"no bare Blender {lane}: sh tests/install/run makes one")
    return python


def blender(lane, folder, *arguments):
    """Run the script in a bare Blender with the user's settings of a folder; what it answers."""
    answer = folder / f"{arguments[0]}.json"
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(folder / "user")}
    environment.pop("PYTHONPATH", None)
    done = subprocess.run(
        [python_of(lane), SCRIPT, *map(str, arguments), answer],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0 and answer.exists(), done.stdout + done.stderr
    return json.loads(answer.read_text())


@pytest.mark.parametrize("lane", LANES)
def test_installed_from_disk_and_used(lane, sky, tmp_path):
    """With numpy alone the same numbers as here; a file for any Blender."""
    folder, matrices = sky
    answer = blender(lane, tmp_path, "use", ARCHIVE, folder / "sky.exr", folder / "paints.csv")
    assert answer["heavy"] == [] and answer["version"] == VERSION
    for name, matrix in matrices.items():
        assert answer["matrices"][name] == pytest.approx(np.array(matrix), abs=1e-6)
    other = tmp_path / "other"
    other.mkdir()
    seen = blender(lane, other, "render", tmp_path / "use.blend")
    assert np.array(seen["pixels"]).min() > 0.01
    assert np.array(seen["pixels"]) == pytest.approx(np.array(answer["pixels"]), abs=1e-6)


def extension_tool(*arguments):
    """Blender's own, which ships in the bpy wheel."""
    (tool,) = ROOT.glob(
        ".venvs/bare-5.3/lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"
    )
    subprocess.run([sys.executable, tool, *map(str, arguments)], check=True, capture_output=True)


@pytest.fixture
def server(tmp_path):
    """Two repositories on this machine's own address: an older version's, and this one's."""
    source = tmp_path / "source"
    with zipfile.ZipFile(ARCHIVE) as files:
        files.extractall(source)
    manifest = source / "blender_manifest.toml"
    text = manifest.read_text(encoding="utf-8").replace(f'"{VERSION}"', '"0.0.1"')
    manifest.write_text(text, encoding="utf-8")
    served = tmp_path / "served"
    for name in ("older", "newer"):
        (served / name).mkdir(parents=True)
    extension_tool("build", "--source-dir", source, "--output-dir", served / "older")
    shutil.copy(ARCHIVE, served / "newer")
    for name in ("older", "newer"):
        extension_tool("server-generate", "--repo-dir", served / name)
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(served))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{serving.server_port}"
        yield [f"{address}/{name}/index.json" for name in ("older", "newer")]
        serving.shutdown()


def test_installed_from_a_repository_and_updated_with_a_scene(server, sky, tmp_path):
    python_of(LANES[0])
    folder, matrices = sky
    given = (*server, folder / "sky.exr", folder / "paints.csv")
    first, then = blender(LANES[0], tmp_path, "upgrade", *given)
    assert (first["version"], then["version"]) == ("0.0.1", VERSION)
    for name, matrix in matrices.items():
        assert then["matrices"][name] == pytest.approx(np.array(matrix), abs=1e-6)
    assert np.array(then["pixels"]) == pytest.approx(np.array(first["pixels"]), abs=1e-6)


def test_nothing_leaves_the_machine_while_blender_is_offline(tmp_path):
    said = blender(LANES[0], tmp_path, "offline", ARCHIVE)
    assert "Allow Online Access" in said["http://farm.example:8080"]
    assert "does not answer as a Flamenco Manager" in said["http://127.0.0.1:9"]
