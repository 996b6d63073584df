"""Build the extension's zip and a static repository of it into dist/, by Blender's own tool."""

from __future__ import annotations

import argparse
import importlib.util
import io
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DIST = ROOT / "dist"
MANIFEST = "blender_manifest.toml"
PUBLISHER = Path(__file__).with_name("publisher.toml")
LARGEST = 3_000_000
"""[bytes] of the zip: no wheels, no data beyond the tables."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="sh .ci/release/run", description=__doc__)
    parser.add_argument("--uncommitted", action="store_true", help="as the tracked files are now")
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
        archive = build(commit, Path(folder))
    repository(archive)
    return 0


def build(commit: str, folder: Path) -> Path:
    """The zip of a commit, judged by Blender's validator; dist/ holds what was judged good."""
    source = folder / "source"
    source.mkdir()
    files = subprocess.run(["git", "archive", commit], cwd=ROOT, check=True, capture_output=True)
    with tarfile.open(fileobj=io.BytesIO(files.stdout)) as tracked:
        tracked.extractall(source, filter="data")
    manifest = source / MANIFEST
    manifest.write_text(published(manifest.read_text(encoding="utf-8")), encoding="utf-8")
    version = tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]
    target = DIST / f"spectral_skylight-{version}.zip"
    part = folder / target.name
    blender_ext("build", "--source-dir", source, "--output-filepath", part)
    blender_ext("validate", part)
    if part.stat().st_size > LARGEST:
        sys.exit(f"{target.name} has {part.stat().st_size / 1e6:.1f} MB: 3 is the limit")
    part.replace(target)
    print(f"{target.relative_to(ROOT)}  {target.stat().st_size / 1e6:.2f} MB")
    return target


def published(manifest: str) -> str:
    """A manifest with what `publisher.toml` says of its publisher."""
    given = tomllib.loads(PUBLISHER.read_text(encoding="utf-8"))
    lines = []
    for line in manifest.splitlines():
        key = line.partition("=")[0].strip()
        if key == "maintainer" and given["maintainer"]:
            line = f'maintainer = "{given["maintainer"]}"'
        lines.append(line)
        if key == "maintainer" and given["website"]:
            lines.append(f'website = "{given["website"]}"')
    return "\n".join(lines) + "\n"


def repository(archive: Path) -> None:
    """A static extension repository with a page, in dist/repository: any web server serves it."""
    folder = DIST / "repository"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    shutil.copy(archive, folder)
    blender_ext("server-generate", "--repo-dir", folder, "--html")
    address = tomllib.loads(PUBLISHER.read_text(encoding="utf-8"))["repository"]
    where = address or "set its address in .ci/release/publisher.toml"
    print(f"{folder.relative_to(ROOT)}  ({where})")


def blender_ext(*arguments: object) -> None:
    """Run Blender's extension tool, which ships in the bpy wheel; exits on its no."""
    found = importlib.util.find_spec("bpy")
    if found is None or not found.submodule_search_locations:
        sys.exit("the zip is built by Blender's own tool: this Python has no bpy")
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
