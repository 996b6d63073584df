"""One picture of a scene, without a window: scene-linear EXR, and PNG as the eye should see it."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

from ..errors import InputError

# In the order in which Blender lets them be set: what may follow depends on what went before.
EXR = {"file_format": "OPEN_EXR", "color_depth": "32", "exr_codec": "ZIP"}
PNG = {"file_format": "PNG", "color_depth": "8", "compression": 15}
# What differs from one render to the next and would make equal pictures differ as files.
STAMPS = ("date", "time", "render_time", "memory", "hostname", "filename")


def engine_id(engine: str) -> str:
    """Blender's identifier for "eevee" or "cycles"; raises InputError for another."""
    eevee = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE"
    identifiers = {"eevee": eevee, "cycles": "CYCLES"}
    if engine.lower() not in identifiers:
        raise InputError("--engine", f'"{engine}" is not known', "use eevee or cycles")
    return identifiers[engine.lower()]


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
    Raises InputError for an unknown camera or engine.
    """
    exr = Path(path_exr).resolve()
    png = exr.with_suffix(".png")
    settings = scene.render.image_settings
    with contextlib.ExitStack() as stack:
        put = lambda owner, **values: stack.enter_context(_set(owner, values))  # noqa: E731
        put(scene, camera=_camera(scene, camera))
        if engine is not None:
            put(scene.render, engine=engine_id(engine))
        put(scene.render, **{f"use_stamp_{stamp}": False for stamp in STAMPS})
        if hasattr(settings, "media_type"):
            put(settings, media_type="IMAGE")
        mode = "RGBA" if scene.render.film_transparent else "RGB"
        put(settings, color_management="FOLLOW_SCENE")
        exr.parent.mkdir(parents=True, exist_ok=True)
        bpy.ops.render.render(scene=scene.name)
        result = bpy.data.images["Render Result"]
        for path, form in ((exr, EXR), (png, PNG)):
            put(settings, **form, color_mode=mode)
            _save(result, scene, path)
    return exr, png


def _camera(scene: bpy.types.Scene, name: str | None) -> bpy.types.Object:
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


def _save(image: bpy.types.Image, scene: bpy.types.Scene, path: Path) -> None:
    part = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        image.save_render(str(part), scene=scene)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def _set(owner: Any, values: dict[str, Any]) -> Iterator[None]:
    before = {name: getattr(owner, name) for name in values}
    try:
        for name, value in values.items():
            setattr(owner, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)
