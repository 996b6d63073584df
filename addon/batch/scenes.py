"""What a study's blend files hold of what it asks for, looked up before the night."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..source_hash import ROOT, source_hash
from .study import Study, content_hash, file_hash


@dataclass(frozen=True)
class SceneFile:
    """A blend file's active scene, with what a plan needs to know of it."""

    path: Path
    content: str
    """Hash of the file, and of all that it reads from elsewhere."""
    scene: str
    cameras: tuple[str, ...]
    """Those that the study asks for."""
    frame: int
    engine: str
    resolution: tuple[int, int]
    span: tuple[int, int] = (1, 1)
    """Its first and its last frame."""


def look_into(study: Study) -> tuple[SceneFile, ...]:
    """Open each scene of a study in turn and check it.

    Raises `InputError` for a file that Blender cannot open, that a newer Blender wrote or that
    misses its textures; and for cameras and materials that it does not have.
    """
    _need_blender()
    return tuple(_look(study, path) for path in study.scenes)


def _need_blender() -> None:
    try:
        import bpy  # noqa: F401
    except ImportError:
        cure = "run it in Blender: blender -c skylight batch …, or install bpy"
        raise InputError("batch", "there is no Blender in this Python", cure) from None


def _look(study: Study, path: Path) -> SceneFile:
    import bpy

    from ..scene.files import blend_file
    from ..scene.materials import spectral_material
    from ..scene.output import render_task

    scene = blend_file.open_scene(path)
    if bpy.data.version[:2] > bpy.app.version[:2]:
        made = ".".join(map(str, bpy.data.version[:2]))
        raise InputError(
            path,
            f"was saved by Blender {made}, but this is {bpy.app.version_string}",
            f"use Blender {made}",
        )
    if missing := render_task.missing_files():
        raise InputError(path, f"lacks {', '.join(missing)}", "restore or pack them")
    cameras = [obj.name for obj in scene.objects if obj.type == "CAMERA"]
    for name in study.cameras or ():
        if name not in cameras:
            raise _absent(path, "camera", name, cameras)
    if not cameras:
        raise InputError(path, "has no camera", "add one")
    known = [material.name for material in bpy.data.materials]
    for variant in study.variants:
        for name in variant.given:
            if name not in known:
                raise _absent(f"{path}, variant {variant.name}", "material", name, known)
            spectral_material.check_editable(blend_file.material(name))
    names = {identifier: name for name, identifier in render_task.engines().items()}
    engine = study.engine or names.get(scene.render.engine)
    if engine is None:
        raise InputError(path, f"renders with {scene.render.engine}", "give engine in the study")
    return SceneFile(
        path=path,
        content=content_hash([file_hash(path), _others()]),
        scene=scene.name,
        cameras=study.cameras or tuple(sorted(cameras)),
        frame=scene.frame_current,
        engine=engine,
        resolution=study.resolution or render_task.size(scene),
        span=(scene.frame_start, scene.frame_end),
    )


def _absent(place: Any, kind: str, name: str, known: list[str]) -> InputError:
    near = difflib.get_close_matches(name, known, 1, 0.5)
    held = ", ".join(f'"{each}"' for each in known[:12]) or "none at all"
    cure = f'did you mean "{near[0]}"?' if near else f"it has {held}"
    return InputError(place, f'has no {kind} "{name}"', cure)


def _others() -> list[str]:
    """Return hashes of the files that the open one reads."""
    import bpy

    paths = {bpy.path.abspath(library.filepath) for library in bpy.data.libraries}
    for image in bpy.data.images:
        if image.source == "FILE" and image.users and not image.packed_files and image.filepath:
            paths.add(bpy.path.abspath(image.filepath, library=image.library))
    return sorted(file_hash(Path(path)) for path in paths)


NOT_IN_PICTURES = {"ui", "commands", "evaluation", "cli.py", "registration.py"}
"""What of `addon` decides no picture: panel, command line and laboratory. All else may."""


def files_hash(root: Path) -> str:
    """Return a hash of all files of the package at ``root`` that may decide pictures."""
    rooms = [path for path in (root / "addon").iterdir() if path.name not in NOT_IN_PICTURES]
    return source_hash(*rooms, root / "node_groups", root=root)


def program_hash() -> str:
    """Return a hash of our files and this Blender's build, which make prepared files."""
    import bpy

    build = f"{bpy.app.version_string} {bpy.app.build_hash!r}"
    return content_hash([build, files_hash(ROOT)])
