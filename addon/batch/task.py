"""A task is one picture: all that decides it, as plain data that travels to any machine."""

from __future__ import annotations

import hashlib
import json
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path

from ..atomic_file import replacing
from ..scene.output import plan_data

SCRIPT = Path(__file__).parents[1] / "scene" / "output" / "render_task.py"
"""What a plain Blender does tasks with."""

SCRIPTS = (
    Path(__file__).parents[1] / "atomic_file.py",
    SCRIPT.with_name("image_file.py"),
    SCRIPT.with_name("plan_data.py"),
    SCRIPT.with_name("plan_range.py"),
    SCRIPT,
    Path(__file__).with_name("duration.py"),
    Path(__file__).with_name("report_page.py"),
    Path(__file__).with_name("report.py"),
)
"""The same and what writes a report, with what they import: any worker can run them."""


def sources() -> dict[str, bytes]:
    """Return the content of `SCRIPTS` by name, for whoever runs them from a folder of its own."""
    return {script.name: script.read_bytes() for script in SCRIPTS}


def scripts_hash() -> str:
    """Return hash and names of `SCRIPTS`, by which a farm knows copies that nobody has changed."""
    digest = hashlib.sha256(b"".join(sources().values())).hexdigest()
    return " ".join([digest, *(script.stem for script in SCRIPTS)])


def copy_scripts(folder: Path) -> None:
    """Put `SCRIPTS` beside a plan; workers that start meanwhile find whole ones."""
    for script in SCRIPTS:
        with replacing(folder / script.name) as part:
            shutil.copyfile(script, part)


@dataclass(frozen=True)
class Task:
    """One picture of a plan; paths are relative to the plan's folder, with slashes."""

    index: int
    """Place in the plan, from 0."""
    blend: str
    """The prepared file, which needs no add-on."""
    scene: str
    camera: str
    frame: int
    engine: str | None
    """``eevee`` or ``cycles``; None: the scene's."""
    samples: int | None
    resolution: tuple[int, int]
    """[pixels]"""
    exr: str
    """The picture; a PNG through the view transform stands beside it."""
    key: str
    """Hash of all that decides the picture; both files carry it, and others are not kept."""

    @property
    def png(self) -> str:
        """The picture as the eye should see it."""
        return self.exr.removesuffix(".exr") + ".png"

    def line(self) -> str:
        """Return the task as one line of JSON."""
        return json.dumps(asdict(self), ensure_ascii=False)


def task_of(line: str) -> Task:
    """Return the task of a line of JSON; raises ValueError where it is none, or leads elsewhere."""
    values = plan_data.task(line)
    return Task(**{**values, "resolution": tuple(values["resolution"])})
