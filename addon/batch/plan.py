"""A plan: the tasks of a study as text, one JSON object a line, behind a header.

Neither writing nor reading holds more than one task at a time.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene.output import plan_data
from ..whole_files import writing
from .file_names import file_names
from .owner import check_links
from .scenes import SceneFile
from .study import Study, StudySky, Variant, content_hash
from .task import Task, copy_scripts, task_of


@dataclass(frozen=True)
class Prepared:
    """One blend file to be made ready: a scene under a sky with a variant's materials."""

    blend: str
    """Relative to the plan, as in `Task`."""
    name: str
    scene: SceneFile
    sky: StudySky
    variant: Variant
    key: str
    """Hash of all that decides the file."""


def prepared_files(study: Study, scenes: tuple[SceneFile, ...], program: str) -> Iterator[Prepared]:
    """Give the files that a study's tasks render from, scene by scene and sky by sky."""
    scene_names = file_names([scene.path.stem for scene in scenes])
    sky_names = file_names([sky.name for sky in study.skies])
    variant_names = file_names([variant.name for variant in study.variants])
    parts = [
        ((scene_name, variant_name, sky_name), (scene, sky, variant))
        for scene_name, scene in zip(scene_names, scenes, strict=True)
        for sky_name, sky in zip(sky_names, study.skies, strict=True)
        for variant_name, variant in zip(variant_names, study.variants, strict=True)
    ]
    names = file_names(["_".join(part) for part, _ in parts])
    for name, (_, (scene, sky, variant)) in zip(names, parts, strict=True):
        simulated = [study.sky_width, study.quality] if sky.sun is not None else []
        decides = [scene.content, scene.scene, sky.content, sky.north, *simulated]
        key = content_hash([*decides, variant.content, study.settings, program])
        yield Prepared(f"prepared/{name}.{key[:8]}.blend", name, scene, sky, variant, key)


def tasks(study: Study, scenes: tuple[SceneFile, ...], program: str) -> Iterator[Task]:
    """Give the tasks of a study, those of one prepared file together."""
    camera_names = {scene.path: file_names(list(scene.cameras)) for scene in scenes}
    index = 0
    for prepared in prepared_files(study, scenes, program):
        scene = prepared.scene
        for camera, file_name in zip(scene.cameras, camera_names[scene.path], strict=True):
            for frame in frames_of(study, scene):
                what = [camera, frame, scene.engine, study.samples, scene.resolution]
                decides = f"{prepared.key} {json.dumps(what)}"
                yield Task(
                    index=index,
                    blend=prepared.blend,
                    scene=scene.scene,
                    camera=camera,
                    frame=frame,
                    engine=scene.engine,
                    samples=study.samples,
                    resolution=scene.resolution,
                    exr=f"pictures/{prepared.name}/{prepared.name}_{file_name}_{frame:04d}.exr",
                    key=hashlib.sha256(decides.encode()).hexdigest()[:24],
                )
                index += 1


def frames_of(study: Study, scene: SceneFile) -> Sequence[int]:
    """Return the frames of a scene that a study asks for."""
    if study.all_frames:
        return range(scene.span[0], scene.span[1] + 1)
    return study.frames or (scene.frame,)


def write_plan(study: Study, scenes: tuple[SceneFile, ...], program: str) -> Path:
    """Write the plan of a study whose scenes are known, and the script beside it; return its path.

    The plan is replaced as a whole, or stays as it was. Raises `InputError` where it cannot be.
    """
    header = {
        "format": plan_data.FORMAT,
        "version": plan_data.VERSION,
        "study": os.path.relpath(study.path, study.out).replace(os.sep, "/"),
        "tasks": _count(study, scenes),
        "scenes": len(scenes),
        "skies": len(study.skies),
        "variants": len(study.variants),
        "program": program,
    }
    path = study.plan
    with writing(path) as part:
        path.parent.mkdir(parents=True, exist_ok=True)
        copy_scripts(path.parent)
        with part.open("w", encoding="utf-8", errors="backslashreplace", newline="\n") as file:
            file.write(json.dumps(header, ensure_ascii=False) + "\n")
            for task in tasks(study, scenes, program):
                file.write(task.line() + "\n")
    return path


def _count(study: Study, scenes: tuple[SceneFile, ...]) -> int:
    pictures = sum(len(scene.cameras) * len(frames_of(study, scene)) for scene in scenes)
    return pictures * len(study.skies) * len(study.variants)


def read_header(path: str | Path) -> dict[str, Any]:
    """Return a plan's header; InputError for a file that is no plan, or of another version."""
    try:
        header = plan_data.header(Path(path))
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "check the path") from None
    except ValueError as error:
        raise InputError(path, str(error), "make one with batch plan STUDY.toml") from None
    check_links(Path(path).parent)
    return header


def read_tasks(path: str | Path, first: int = 0, count: int | None = None) -> Iterator[Task]:
    """Give the tasks of a plan, ``count`` of them from number ``first`` on.

    Raises `InputError` as `read_header` does, and for a line that is no task.
    """
    read_header(path)
    with Path(path).open(encoding="utf-8", errors="replace") as file:
        stop = None if count is None else 1 + first + count
        for number, line in enumerate(islice(file, 1 + first, stop), 2 + first):
            try:
                yield task_of(line)
            except ValueError as error:
                place, cure = f"{path}, line {number}", "plan the study again"
                raise InputError(place, f"is not a task: {error}", cure) from None
