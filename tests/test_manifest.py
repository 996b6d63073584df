"""The manifest, by Blender's own validator, and one version wherever a version is said."""

import re
import subprocess
import sys
import tomllib
import zipfile
from importlib import metadata
from pathlib import Path

import bpy
import pytest

pytestmark = pytest.mark.blender

ROOT = Path(__file__).resolve().parents[1]
MANIFEST = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))


def blender_ext(*arguments):
    """Run Blender's extension tool, which ships in the bpy wheel."""
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    tool = scripts / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    return subprocess.run(
        [sys.executable, str(tool), *map(str, arguments)], capture_output=True, text=True
    )


def test_blender_accepts_the_manifest():
    done = blender_ext("validate", ROOT)
    assert done.returncode == 0, done.stdout + done.stderr


def test_blender_would_refuse_a_bad_one(tmp_path):
    """The validator bites: permission texts end without a full stop and have at most 64 letters."""
    text = (ROOT / "blender_manifest.toml").read_text(encoding="utf-8")
    (tmp_path / "__init__.py").touch()
    for bad in (MANIFEST["permissions"]["files"] + ".", "long " * 13):
        (tmp_path / "blender_manifest.toml").write_text(
            text.replace(MANIFEST["permissions"]["files"], bad), encoding="utf-8"
        )
        assert blender_ext("validate", tmp_path).returncode != 0


def test_the_zip_holds_the_add_on_and_nothing_else(tmp_path):
    done = blender_ext("build", "--source-dir", ROOT, "--output-dir", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    (archive,) = tmp_path.glob("*.zip")
    assert blender_ext("validate", archive).returncode == 0
    names = zipfile.ZipFile(archive).namelist()
    needed = {"__init__.py", "blender_manifest.toml", "LICENSE", "addon/registration.py"}
    assert {*needed, "addon/ui/translations/ja_JP.po"} <= {*names}
    wanted = re.compile(
        r"(addon|node_groups)/.*\.(csv|js|md|npz|po|py)|[A-Za-z_]+\.(md|py|toml)|LICENSE"
    )
    assert [name for name in names if not wanted.fullmatch(name)] == []


def test_one_version():
    version = MANIFEST["version"]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == version
    assert metadata.version("spectral-skylight") == version
    assert project["description"] == MANIFEST["tagline"] + " in Blender"
    changes = ROOT / "CHANGELOG.md"
    if changes.exists():
        latest = re.search(r"^## \[?(\d+\.\d+\.\d+)", changes.read_text(encoding="utf-8"), re.M)
        assert latest is not None and latest[1] == version


def test_the_manifest_is_as_the_platform_asks():
    """Permissions with their reasons, for what the code does and nothing else; no wheels."""
    assert list(MANIFEST["permissions"]) == ["files", "network"]
    sources = [p.read_text(encoding="utf-8") for p in (ROOT / "addon").rglob("*.py")]
    assert not any("clipboard" in text for text in sources)  # it would be a permission more
    assert "wheels" not in MANIFEST and "platforms" not in MANIFEST
    assert {*MANIFEST["tags"]} == {"Lighting", "Material", "Node", "Render"}
    assert MANIFEST["license"] == ["SPDX:GPL-3.0-or-later"]
