"""One picture, whole or not at all: what `render` calls, and a script for a plain Blender.

A batch puts copies of it and of what it imports beside its plan: it needs no package.

    blender -b --factory-startup -P render_task.py -- PLAN.jsonl --first 0 --count 40
    blender -b --factory-startup -P render_task.py -- PLAN.jsonl --missing
    blender -b --factory-startup -P render_task.py -- PLAN.jsonl --check
    blender -b --factory-startup -P render_task.py -- --serve

The first three are `plan_range`'s. The last reads tasks from stdin, a JSON object a line, and
answers each by a line on stdout that starts with `ANSWER`. bpy as a module: `python
render_task.py …`.
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import json
import os
import queue
import shutil
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

if __package__:
    from ...atomic_file import replacing
    from . import plan_range
    from .image_file import check, whole, without_times
    from .plan_data import inside
    from .plan_range import ANSWER
else:  # a copy beside a plan
    if "plan_data" not in sys.modules:  # a farm loads all of them once it has checked their hash
        sys.path.insert(0, str(Path(__file__).resolve().parent))
    import plan_range  # type: ignore[no-redef]
    from atomic_file import replacing  # type: ignore[no-redef]
    from image_file import check, whole, without_times  # type: ignore[no-redef]
    from plan_data import inside  # type: ignore[no-redef]
    from plan_range import ANSWER  # type: ignore[no-redef]

# In the order in which Blender lets them be set: what may follow depends on what went before.
EXR = {"file_format": "OPEN_EXR", "color_depth": "32", "exr_codec": "ZIP"}
PNG = {"file_format": "PNG", "color_depth": "8", "compression": 15}
# What differs from one render to the next and would make equal pictures differ as files.
STAMPS = ("date", "time", "render_time", "memory", "hostname", "filename")


def engines() -> dict[str, str]:
    """Return Blender's identifiers of engines by the names that tasks have for them."""
    import bpy

    eevee = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0, 0) else "BLENDER_EEVEE"
    return {"eevee": eevee, "cycles": "CYCLES"}


def build() -> str:
    """Return version, commit and platform of this Blender: others write other pictures."""
    import bpy

    commit, platform = bpy.app.build_hash, bpy.app.build_platform
    known = (part.decode(errors="replace") for part in (commit, platform))
    return " ".join(("Blender", bpy.app.version_string, *known))


def picture(scene: Any, exr: Path, camera: Any, engine: str | None = None, note: str = "") -> None:
    """Render a scene's current frame to an EXR and, through its view transform, a PNG beside it.

    Both are checked and then moved into place; all settings are put back. ``engine``: one of
    `engines` (None: the scene's); ``note`` goes into both files. Raises ValueError or OSError for
    pictures that came out damaged or could not be written.
    """
    import bpy

    settings, width, height = scene.render.image_settings, *size(scene)
    with contextlib.ExitStack() as stack:
        put = lambda owner, **values: stack.enter_context(_set(owner, values))  # noqa: E731
        put(scene, camera=camera)
        if engine is not None:
            put(scene.render, engine=engines()[engine])
        put(scene.render, **{f"use_stamp_{stamp}": False for stamp in STAMPS})
        put(scene.render, use_stamp_note=bool(note), stamp_note_text=note)
        if hasattr(settings, "media_type"):
            put(settings, media_type="IMAGE")
        mode = "RGBA" if scene.render.film_transparent else "RGB"
        put(settings, color_management="FOLLOW_SCENE")
        exr.parent.mkdir(parents=True, exist_ok=True)
        bpy.ops.render.render(scene=scene.name)
        result = bpy.data.images["Render Result"]
        for path, form in ((exr.with_suffix(".png"), PNG), (exr, EXR)):  # the EXR last: then done
            put(settings, **form, color_mode=mode)
            with replacing(path) as part:
                result.save_render(str(part), scene=scene)
                content = part.read_bytes()
                check(content, width, height, note)
                part.write_bytes(without_times(content))


def size(scene: Any) -> tuple[int, int]:
    """Return width and height of a scene's pictures [pixels]."""
    render = scene.render
    share = render.resolution_percentage
    width, height = (n * share // 100 for n in (render.resolution_x, render.resolution_y))
    if render.use_border and render.use_crop_to_border:
        x = (int(render.border_min_x * width), int(render.border_max_x * width))
        y = (int(render.border_min_y * height), int(render.border_max_y * height))
        return max(1, x[1] - x[0]), max(1, y[1] - y[0])
    return width, height


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


def missing_files() -> list[str]:
    """Return what the open file reads from elsewhere and cannot find: images and libraries."""
    import bpy

    missing = []
    for image in bpy.data.images:
        if image.source == "FILE" and image.users and not image.packed_files and image.filepath:
            path = bpy.path.abspath(image.filepath, library=image.library)
            missing += [] if Path(path).is_file() else [f'image "{image.name}" ({path})']
    for library in bpy.data.libraries:
        path = bpy.path.abspath(library.filepath)
        missing += [] if Path(path).is_file() else [f'library "{library.name}" ({path})']
    return missing


class WrongBlender(ValueError):
    """Another Blender could render this, and this one none of its pictures."""


def _open(path: Path) -> None:
    """Open a task's blend file, unless it is open already."""
    import bpy

    if not path.is_file():
        raise ValueError(f"{path} is missing: prepare the batch")
    if bpy.data.filepath == str(path):
        return
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    if bpy.data.version[:2] > bpy.app.version[:2]:
        made = ".".join(map(str, bpy.data.version))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        raise WrongBlender(f"{path} is of Blender {made}, and this is {bpy.app.version_string}")
    if missing := missing_files():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        raise ValueError(f"{path} misses {', '.join(missing)}")


def perform(task: dict[str, Any], root: Path, threads: int = 0) -> dict[str, Any]:
    """Do one task and return its answer: index, status, seconds and, where it failed, error.

    ``status``: ``rendered``, ``skipped`` (it was there, whole, by this `build`) or ``failed``;
    ``no_space`` and ``wrong_blender`` mark failures that others on this machine will share. Paths
    of the task are relative to ``root``.
    """
    import bpy

    start = time.monotonic()
    answer = {"index": task["index"], "blender": bpy.app.version_string, "build": build()}
    note = f"{task['key']} {answer['build']}"
    width, height = task["resolution"]
    exr = root
    try:
        exr = inside(root, task["exr"], ".exr")
        inside(root, task["exr"].removesuffix(".exr") + ".png", ".png")
        if whole(exr, width, height, note):
            return {**answer, "status": "skipped", "seconds": time.monotonic() - start}
        exr.parent.mkdir(parents=True, exist_ok=True)
        if _full(exr.parent, width, height):
            raise OSError(errno.ENOSPC, "less than a picture may take")
        _open(inside(root, task["blend"], ".blend"))
        scene = bpy.data.scenes[task["scene"]]
        camera = scene.objects.get(task["camera"])
        if camera is None:
            raise ValueError(f"{task['blend']} has no camera {task['camera']}")
        _set_up(scene, task, threads)
        picture(scene, exr, camera, task["engine"], note)
    except Exception as error:  # whatever it is, the other tasks go on
        reason = " ".join(str(error).split()) or type(error).__name__
        code = getattr(error, "errno", None)
        full = code in (errno.ENOSPC, errno.EDQUOT) or _full(exr.parent, width, height)
        answer |= {"no_space": full, "wrong_blender": isinstance(error, WrongBlender)}
        reason = f"no space left on the disk ({reason})" if full else reason
        answer |= {"status": "failed", "error": f"{exr}: {reason}"}
    else:
        answer["status"] = "rendered"
    return {**answer, "seconds": time.monotonic() - start}


def _full(folder: Path, width: int, height: int) -> bool:
    """Whether a picture's two files might find no room."""
    try:
        return shutil.disk_usage(folder).free < 20 * width * height + (1 << 20)
    except OSError:
        return False


def _set_up(scene: Any, task: dict[str, Any], threads: int) -> None:
    render = scene.render
    render.resolution_x, render.resolution_y = task["resolution"]
    render.resolution_percentage = 100
    render.use_border = False
    if task["samples"]:
        scene.eevee.taa_render_samples = task["samples"]
        if hasattr(scene, "cycles"):
            scene.cycles.samples = task["samples"]
    if threads:
        render.threads_mode, render.threads = "FIXED", threads
    cycles = task["engine"] == "cycles" or (not task["engine"] and render.engine == "CYCLES")
    if cycles and scene.cycles.device == "GPU":
        import bpy

        choose_gpu(bpy.context.preferences.addons["cycles"].preferences)
    scene.frame_set(task["frame"])


def choose_gpu(preferences: Any) -> str:
    """Have Cycles use all GPUs of one kind, which factory settings do not, and return the kind.

    ``preferences``: Cycles' own. NONE where there is no GPU: then it renders on the processor. A
    kind that is chosen already stays.
    """
    if preferences.compute_device_type != "NONE":
        return preferences.compute_device_type
    for kind in ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI", "NONE"):
        with contextlib.suppress(TypeError):  # a kind that this platform does not have
            preferences.compute_device_type = kind
            preferences.refresh_devices()
            for device in preferences.devices:
                device.use = device.type == kind
            if any(device.use for device in preferences.devices):
                break
    return preferences.compute_device_type


def _served() -> Iterator[dict[str, Any]]:
    """Give the tasks of stdin; where it closes, whoever asked is gone and so is this process."""
    lines: queue.Queue[str] = queue.Queue()

    def listen() -> None:
        for line in sys.stdin:
            lines.put(line)
        os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    while True:
        yield json.loads(lines.get())


def main(arguments: list[str]) -> int:
    """Do the tasks that the arguments name; return the exit code."""
    parser = argparse.ArgumentParser(prog="render_task.py")
    parser.add_argument("plan", nargs="?", type=Path, help="tasks, from the second line on")
    parser.add_argument("--first", type=int, default=0, help="number of the first task")
    parser.add_argument("--count", type=int, help="how many; default: all")
    parser.add_argument("--serve", action="store_true", help="tasks from stdin, answers to stdout")
    parser.add_argument("--missing", action="store_true", help="only those that are not there")
    parser.add_argument("--check", action="store_true", help="render nothing, list what is missing")
    parser.add_argument("--root", type=Path, help="of the tasks' paths; default: the plan's folder")
    parser.add_argument("--threads", type=int, default=0, help="of a render; default: all cores")
    options = parser.parse_args(arguments)
    here = Path(__file__) if options.plan is None else options.plan
    root = (options.root or here.parent).resolve()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what Blender prints goes where warnings go
    if options.serve:
        for task in _served():
            answer = perform(task, root, options.threads)
            print(ANSWER + json.dumps(answer), file=answers, flush=True)
    if options.plan is None:
        parser.error("give a plan or --serve")
    tasks = plan_range.planned(options.plan, options.first, options.count)
    if options.missing:
        tasks = (task for task in tasks if plan_range.lacks(task, root))
    if options.check:
        return plan_range.check(tasks, root, answers)
    return plan_range.render(tasks, root, lambda t: perform(t, root, options.threads), answers)


if __name__ == "__main__":
    code = 1
    try:
        code = main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
    except SystemExit as stop:
        code = int(stop.code or 0)
    except BaseException as error:
        print(f"render_task.py: {error}", file=sys.stderr)
    finally:
        with contextlib.suppress(OSError):  # whoever started this may be gone
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)  # Blender before 5.0 can crash at exit, and does not pass a code on
