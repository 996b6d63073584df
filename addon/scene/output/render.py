"""One picture of a scene, without a window: scene-linear EXR, and PNG as the eye should see it."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...errors import InputError, parameter
from . import render_task


def engine_id(engine: str) -> str:
    """Blender's identifier for "eevee" or "cycles"; raises InputError for another."""
    if engine.lower() not in render_task.engines():
        raise InputError(parameter("engine"), f'"{engine}" is not known', "use eevee or cycles")
    return render_task.engines()[engine.lower()]


def render(
    scene: bpy.types.Scene,
    path_exr: str | Path,
    camera: str | None = None,
    engine: str | None = None,
) -> tuple[Path, Path]:
    """Render a scene's current frame and return the paths of its EXR and its PNG.

    The EXR holds 32-bit float, scene-linear values at the file's own size; the PNG beside it went
    through the scene's view transform. Either file is whole or absent, and all settings are
    put back. `camera` names an object, `engine` is "eevee" or "cycles" (None: the scene's).
    Raises InputError for an unknown camera or engine, and for pictures that cannot be written.
    """
    exr = Path(path_exr).resolve()
    if engine is not None:
        engine_id(engine)
        engine = engine.lower()
    found = find_camera(scene, camera)
    try:
        render_task.picture(scene, exr, found, engine)
    except (ValueError, OSError, RuntimeError) as error:
        raise InputError(exr, f"cannot be written ({error})", "check the folder") from error
    return exr, exr.with_suffix(".png")


def find_camera(scene: bpy.types.Scene, name: str | None) -> bpy.types.Object:
    """Return a scene's camera of this name, its active one for None; InputError without."""
    place = f'scene "{scene.name}"'
    if name is None:
        if scene.camera is None:
            raise InputError(place, "has no active camera", "name one of its cameras")
        return scene.camera
    found = scene.objects.get(name)
    if found is None or found.type != "CAMERA":
        known = ", ".join(o.name for o in scene.objects if o.type == "CAMERA") or "none"
        raise InputError(place, f'has no camera "{name}"', f"it has {known}")
    return found
