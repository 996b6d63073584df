"""The platforms that a zip is made for, and which wheels of the lock fit each."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[2]

NOT_BUNDLED = {
    "numpy",  # Blender's own: another beside it, for all extensions, breaks them
    "imageio",  # colour-science reads pictures by it, which we never ask for,
    "pillow",  # and imageio needs this
}


@dataclass(frozen=True)
class Platform:
    """One of Blender's platforms, and how Python's packages name it."""

    name: str  # as the manifest has it
    tags: tuple[str, ...]  # of wheels, the newest system that Blender itself asks for first
    sys_platform: str
    pythons: tuple[str, ...] = ("3.11", "3.13")  # of Blender 4.5 and 5.0, and of 5.1 and 5.2
    blender_version_max: str | None = None  # the first that it does not run in


PLATFORMS = (
    Platform("linux-x64", tuple(f"manylinux_2_{n}_x86_64" for n in (28, 27, 17)), "linux"),
    Platform("windows-x64", ("win_amd64",), "win32"),
    Platform("macos-arm64", ("macosx_12_0_arm64",), "darwin"),
    # Blender 4.5 is the last for Intel's Macs.
    Platform("macos-x64", ("macosx_10_15_x86_64",), "darwin", ("3.11",), "5.0.0"),
)


def locked() -> list[str]:
    """What the add-on needs, as the lock pins it: requirements with their markers and hashes."""
    command = "uv export --frozen --no-dev --no-emit-project --no-annotate --no-header --quiet"
    text = subprocess.run(
        command.split(), cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout
    return text.replace("\\\n", " ").splitlines()


def wanted(platform: Platform, python: str) -> Iterator[str]:
    """The locked requirements that a platform's Python is to be given, without their markers."""
    environment = {
        "python_version": python,
        "python_full_version": f"{python}.0",
        "sys_platform": platform.sys_platform,
    }
    for line in locked():
        text, *hashes = line.split(" --hash=")
        requirement = Requirement(text)
        if requirement.name in NOT_BUNDLED:
            continue
        if requirement.marker is None or requirement.marker.evaluate(environment):
            pinned = f"{requirement.name}{requirement.specifier}"
            yield " ".join([pinned, *(f"--hash={digest.strip()}" for digest in hashes)])


def fetch(platform: Platform, folder: Path) -> list[Path]:
    """Bring a platform's wheels to a folder, for every Python, checked by the lock's hashes.

    Raises CalledProcessError where one is not to be had, or is not what was locked.
    """
    folder.mkdir(parents=True)
    file = folder / "requirements.txt"
    for python in platform.pythons:
        file.write_text("\n".join(wanted(platform, python)) + "\n", encoding="utf-8")
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
        command += ["--only-binary=:all:", "--require-hashes", "--requirement", str(file)]
        command += ["--dest", str(folder), "--implementation", "cp", "--python-version", python]
        for tag in platform.tags:
            command += ["--platform", tag]
        subprocess.run(command, check=True)
    file.unlink()
    return sorted(folder.glob("*.whl"))
