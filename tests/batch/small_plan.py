"""A plan of small pictures, made without a study: two prepared files, one Cycles sample."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path

from spectral_skylight.addon.batch.task import Task, copy_scripts
from spectral_skylight.addon.scene.output import plan_data

BLEND = """
import sys, bpy
for name, colour in (("dawn", (1, 0.5, 0.2, 1)), ("noon", (0.4, 0.6, 1, 1))):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    bpy.ops.mesh.primitive_monkey_add()
    for number in range({cameras}):
        bpy.ops.object.camera_add(location=(0, -4 - number / 9, 0), rotation=(1.5708, 0, 0))
        bpy.context.object.name = f"camera {{number}}"
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = colour
    bpy.ops.wm.save_as_mainfile(filepath=f"{folder}/prepared/{{name}}.blend", compress=False)
sys.stdout.flush()
import os
os._exit(0)
"""


def small_plan(folder: Path, cameras: int = 6, size: int = 32, samples: int = 1) -> Path:
    """Write a plan of 2 x `cameras` pictures and all that it needs; return its path."""
    import subprocess
    import sys

    (folder / "prepared").mkdir(parents=True)
    make = BLEND.format(cameras=cameras, folder=folder.as_posix())
    subprocess.run([sys.executable, "-c", make], check=True, capture_output=True)
    copy_scripts(folder)
    tasks = [
        Task(
            index=cameras * row + camera,
            blend=f"prepared/{sky}.blend",
            scene="Scene",
            camera=f"camera {camera}",
            frame=1,
            engine="cycles",
            samples=samples,
            resolution=(size, size),
            exr=f"pictures/{sky}/{sky}_{camera}.exr",
            key=hashlib.sha256(f"{sky} {camera} {size} {samples}".encode()).hexdigest()[:24],
        )
        for row, sky in enumerate(("dawn", "noon"))
        for camera in range(cameras)
    ]
    header = {
        "format": plan_data.FORMAT,
        "version": plan_data.VERSION,
        "tasks": len(tasks),
        "study": "study.toml",
    }
    plan = folder / "plan.jsonl"
    lines = [json.dumps(header), *(task.line() for task in tasks)]
    plan.write_text("".join(line + "\n" for line in lines), encoding="utf-8")
    return plan


def copy_plan(plan: Path, folder: Path) -> Path:
    """The same plan in another folder, without its pictures."""
    shutil.copytree(plan.parent, folder, ignore=shutil.ignore_patterns("pictures"))
    return folder / plan.name


def files(plan: Path) -> dict[str, bytes]:
    """All that was rendered, but for what a kill left half-written: the next run clears that."""
    folder = plan.parent / "pictures"
    found = (path for path in sorted(folder.rglob("[!.]*.*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}
