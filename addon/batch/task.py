"""A task is one picture: all that decides it, as plain data that travels to any machine."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

SCRIPT = Path(__file__).parents[1] / "scene" / "output" / "render_task.py"
"""What a plain Blender does tasks with."""


def copy_scripts(folder: Path) -> None:
    """Put `SCRIPT`, and what it imports, beside a plan."""
    for name in ("image_file.py", SCRIPT.name):
        shutil.copyfile(SCRIPT.with_name(name), folder / name)


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
    """Return the task of a line of JSON; raises ValueError or TypeError where it is none."""
    values: dict[str, Any] = json.loads(line)
    return Task(**{**values, "resolution": tuple(values["resolution"])})
