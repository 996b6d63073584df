"""Opening and saving blend files from a script, and finding in them what a command names."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import bpy

from ...errors import InputError
from .whole_blend import writing_blend


def open_scene(path: str | Path) -> bpy.types.Scene:
    """Open a blend file, without running its scripts, and return its active scene.

    Raises InputError for a file that is missing or that Blender cannot open.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(path, "there is no such file", "check the path")
    try:
        with _prints_aside():
            bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1]
        raise InputError(path, f"Blender cannot open it ({reason})", "give a .blend") from error
    return bpy.context.scene


@contextlib.contextmanager
def _prints_aside() -> Iterator[None]:
    """Send what Blender says of a file to stderr: stdout holds a command's answer, maybe JSON."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError, ValueError, AttributeError):  # no terminal at all
            sys.stdout.flush()
            answers = os.dup(1)
            stack.callback(os.close, answers)
            stack.callback(os.dup2, answers, 1)
            os.dup2(2, 1)
        yield


def material(name: str) -> bpy.types.Material:
    """Return the file's own material of this name, else a linked one; InputError without."""
    found = bpy.data.materials.get((name, None)) or bpy.data.materials.get(name)
    return found or _absent("material", name, [m.name for m in bpy.data.materials])


def lamp(name: str) -> bpy.types.Object:
    """Return the lamp (object) of this name; InputError without."""
    lamps = [obj for obj in bpy.data.objects if obj.type == "LIGHT"]
    found = next((obj for obj in lamps if obj.name == name), None)
    return found or _absent("lamp", name, [obj.name for obj in lamps])


def _absent(kind: str, name: str, known: list[str]) -> NoReturn:
    names = ", ".join(f"'{each}'" for each in known[:12]) or "none at all"
    raise InputError(
        bpy.data.filepath or "the file", f"has no {kind} '{name}'", f"there are {names}"
    )


def check_unread(path: Path) -> None:
    """Raise InputError where the open file reads ``path``: a texture, a library or itself."""
    for read in bpy.utils.blend_paths(absolute=True, packed=False, local=False):
        other = Path(read)
        if path.exists() and other.exists() and path.samefile(other):
            raise InputError(path, "the scene reads this file", "choose another name")


def save(path: str | Path) -> None:
    """Save the open file as ``path``, whole or not at all; the open file keeps its name.

    Relative paths in it are adapted to the new folder. Raises InputError for a folder that does
    not exist or cannot be written to.
    """
    with writing_blend(Path(path).resolve()) as part:
        bpy.ops.wm.save_as_mainfile(filepath=str(part), copy=True, check_existing=False)
