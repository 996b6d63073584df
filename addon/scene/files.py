"""Opening and saving blend files from a script, and finding in them what a command names."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ..errors import InputError


def open_scene(path: str | Path) -> bpy.types.Scene:
    """Open a blend file, without running its scripts, and return its active scene.

    Raises InputError for a file that is missing or that Blender cannot open.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(path, "there is no such file", "check the path")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1]
        raise InputError(path, f"Blender cannot open it ({reason})", "give a .blend") from error
    return bpy.context.scene


def material(name: str) -> bpy.types.Material:
    """Return the file's own material of this name, else a linked one; InputError without."""
    found = bpy.data.materials.get((name, None)) or bpy.data.materials.get(name)
    if found is None:
        names = ", ".join(f"'{m.name}'" for m in bpy.data.materials[:12]) or "none at all"
        raise InputError(
            bpy.data.filepath or "the file", f"has no material '{name}'", f"there are {names}"
        )
    return found


def save(path: str | Path) -> None:
    """Save the open file as ``path``, whole or not at all; the open file keeps its name.

    Relative paths in it are adapted to the new folder. Raises InputError for a folder that does
    not exist or cannot be written to.
    """
    path = Path(path).resolve()
    part = path.with_name(f".{path.stem}.{os.getpid()}.blend")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(part), copy=True, check_existing=False)
        part.replace(path)
    except (RuntimeError, OSError) as error:
        reason = str(error).strip().splitlines()[-1]
        raise InputError(path, f"cannot be written ({reason})", "check the folder") from error
    finally:
        part.unlink(missing_ok=True)
