"""Build the extension's zips into dist/, and let Blender's own validator judge each."""

from __future__ import annotations

import argparse
import importlib.util
import io
import json
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from pathlib import Path

from platforms import PLATFORMS, ROOT, Platform, fetch

DIST = ROOT / "dist"
MANIFEST = "blender_manifest.toml"


def main() -> int:
    parser = argparse.ArgumentParser(prog="sh .ci/release/run", description=__doc__)
    parser.add_argument("--uncommitted", action="store_true", help="as the tracked files are now")
    parser.add_argument("--only", choices=[p.name for p in PLATFORMS], help="one platform's zips")
    options = parser.parse_args()
    changed = git("status", "--porcelain")
    if changed and not options.uncommitted:
        print(f"not a clean tree, commit first or say --uncommitted:\n{changed}", file=sys.stderr)
        return 1
    # A commit of tracked files as they are, on no branch; empty where nothing has changed.
    stash = ("-c", "user.name=nobody", "-c", "user.email=nobody@localhost", "stash", "create")
    commit = (git(*stash) if options.uncommitted else "") or "HEAD"
    DIST.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=DIST) as folder:
        for platform in PLATFORMS:
            if options.only in (None, platform.name):
                build(commit, platform, Path(folder))
        build(commit, None, Path(folder))
    return 0


def build(commit: str, platform: Platform | None, folder: Path) -> None:
    """One zip of a commit: with a platform's wheels, or for a Python that has the modules."""
    name = platform.name if platform else "without-wheels"
    source = folder / name
    source.mkdir(parents=True)
    archive = subprocess.run(
        ["git", "archive", commit], cwd=ROOT, check=True, capture_output=True
    ).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        files.extractall(source, filter="data")
    if platform:
        declare(source / MANIFEST, platform, fetch(platform, source / "wheels"))
    version = tomllib.loads((source / MANIFEST).read_text(encoding="utf-8"))["version"]
    target = DIST / f"spectral_skylight-{version}-{name}.zip"
    part = folder / target.name
    blender_ext("build", "--source-dir", source, "--output-filepath", part)
    blender_ext("validate", part)
    part.replace(target)  # dist/ holds what was judged good, whole
    print(f"{target.relative_to(ROOT)}  {target.stat().st_size / 1e6:.1f} MB")


def declare(manifest: Path, platform: Platform, wheels: list[Path]) -> None:
    """Write a platform and its wheels into a manifest, before its first table."""
    text = manifest.read_text(encoding="utf-8")
    lines = [f'platforms = ["{platform.name}"]']
    if platform.blender_version_max:
        lines.append(f'blender_version_max = "{platform.blender_version_max}"')
    lines.append(f"wheels = {json.dumps([f'./wheels/{w.name}' for w in wheels], indent=4)}")
    head, table, rest = text.partition("\n[")
    manifest.write_text("\n".join([head, *lines, table + rest]), encoding="utf-8")


def blender_ext(*arguments: object) -> None:
    """Run Blender's extension tool, which ships in the bpy wheel; CalledProcessError on its no."""
    found = importlib.util.find_spec("bpy")
    if found is None or not found.submodule_search_locations:
        sys.exit("the zips are built by Blender's own tool: this Python has no bpy")
    (package,) = found.submodule_search_locations
    (tool,) = Path(package).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    done = subprocess.run(
        [sys.executable, str(tool), *map(str, arguments)], capture_output=True, text=True
    )
    if done.returncode:
        sys.exit(f"{done.stdout}{done.stderr}")


def git(*arguments: str) -> str:
    """What git says, in the checkout."""
    done = subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
