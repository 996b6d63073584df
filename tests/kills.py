"""kill -9 at random moments of commands that write: what stood there stays, or the new is whole.

By hand, some minutes: `.venv/bin/python -m tests.kills --count 20 [--only apply]`.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from spectral_skylight.addon.scene.files import whole_blend
from spectral_skylight.addon.scene.output import image_file
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.spectra import cache
from spectral_skylight.tests.batch.studies import write_inputs, write_study

MAIN = "import sys; from spectral_skylight.addon import cli; sys.exit(cli.main(sys.argv[1:]))"

SCENE = """
import sys, os
from pathlib import Path
from spectral_skylight.tests.batch.studies import write_scene
write_scene(Path("house.blend"), cameras=3)
sys.stdout.flush(); os._exit(0)
"""


@dataclass(frozen=True)
class Command:
    """A command line, what it writes, and whether what lies there is whole."""

    arguments: tuple[str, ...]
    written: str
    is_whole: Callable[[Path], object]
    others: Callable[[Path], None] = lambda folder: None


def _png(path: Path) -> None:
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG") and content.endswith(b"IEND\xaeB`\x82")


def _caches(folder: Path) -> None:
    """A cache is whole or not there."""
    assert all(cache.load(path) is not None for path in (folder / "cache").glob("[!.]*.npz"))


def _pictures(folder: Path) -> None:
    """Pictures and prepared files are whole; what lies beside them stays."""
    assert (folder / "out" / "prepared" / "mine.blend").read_bytes() == b"mine"
    for path in folder.glob("out/prepared/[!.m]*.blend"):
        whole_blend.check(path)
    for path in folder.glob("out/pictures/*/[!.]*.exr"):
        image_file.check(path.read_bytes(), 16, 16)


APPLY = ("apply", "house.blend", "--assign", "Wall=paint.csv:red", "--out", "new.blend")
SKY = ("sky", "--sun-elevation", "30", "--width", "1024", "--out", "new.exr")
COMMANDS = {
    "sky": Command(SKY, "new.exr", read_panorama, _caches),
    "library": Command(("library", ".", "--sheet", "new.png"), "new.png", _png, _caches),
    "apply": Command(APPLY, "new.blend", whole_blend.check),
    "bake": Command((*APPLY, "--occlusion", "baked"), "new.blend", whole_blend.check),
    "batch": Command(("batch", "run", "study.toml"), "out/report.html", Path.read_text, _pictures),
}


def prepare(folder: Path, name: str) -> None:
    """Write what a command reads, and a file of a person's where it writes."""
    write_inputs(folder)
    write_study(folder)
    (folder / "out" / "prepared").mkdir(parents=True)
    (folder / "out" / "prepared" / "mine.blend").write_bytes(b"mine")
    if name in ("apply", "bake", "batch"):
        subprocess.run([sys.executable, "-c", SCENE], cwd=folder, check=True, capture_output=True)


def start(folder: Path, command: Command) -> subprocess.Popen[bytes]:
    """Start a command in a folder, with a cache of its own there."""
    return subprocess.Popen(
        [sys.executable, "-c", MAIN, *command.arguments],
        cwd=folder,
        env={**os.environ, "SPECTRAL_SKYLIGHT_CACHE": str(folder / "cache")},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def killed(folder: Path, name: str, count: int, seed: int = 0) -> int:
    """Kill a command ``count`` times and check what it left; return how often it was at work.

    The run after all of them is whole, and nothing half-written is left. Raises AssertionError,
    or what a reader says of a file that is not whole.
    """
    prepare(folder, name)
    command, moments = COMMANDS[name], random.Random(seed)
    for _ in range(2):  # the second time with what is kept of the first
        begun = time.monotonic()
        assert start(folder, command).wait() == 0
        length = time.monotonic() - begun
    path, at_work = folder / command.written, 0
    for _ in range(count):
        before = path.read_bytes()
        if name == "batch":  # or all is done already
            for picture in folder.glob("out/pictures/*/*.exr"):
                picture.unlink()
        running = start(folder, command)
        time.sleep(moments.uniform(0.2, 1.0) * length)
        at_work += running.poll() is None
        with contextlib.suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        if path.read_bytes() != before:
            command.is_whole(path)
        command.others(folder)
    assert start(folder, command).wait() == 0
    command.is_whole(path)
    command.others(folder)
    left = [found.name for found in folder.rglob(".*part*")]
    assert left == [], left
    return at_work


def main() -> None:
    """Kill each command, and print how often."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=tuple(COMMANDS))
    options = parser.parse_args()
    for name in [options.only] if options.only else COMMANDS:
        with tempfile.TemporaryDirectory() as folder:
            found = killed(Path(folder), name, options.count, options.seed)
        print(f"{name}: {found} of {options.count} killed at work, nothing lost", flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # as tests with Blender do: before 5.0 it can crash at exit
