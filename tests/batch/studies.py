"""A small office: scenes, CSVs and skies on disk, and studies over them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import write_panorama

WALL = "material,reflectance\nWall,paint.csv:red\n"
GREY = "material,reflectance\nWall,paint.csv:grey\n"


def write_inputs(folder: Path) -> Path:
    """Write sky.exr, paint.csv (red, grey) and the assignments red.csv and grey.csv."""
    view = directions(16, 32)
    blue = np.array([0.2, 0.4, 1.0]) * (1.2 + view[..., 2:])
    write_panorama(folder / "sky.exr", np.where(view[..., 2:] > 0, blue, 0.1))
    rows = [f"{x},{0.05 if x < 600 else 0.8},0.5" for x in range(380, 781, 10)]
    (folder / "paint.csv").write_text("\n".join(["nm,red,grey", *rows]), encoding="utf-8")
    (folder / "red.csv").write_text(WALL, encoding="utf-8")
    (folder / "grey.csv").write_text(GREY, encoding="utf-8")
    return folder


def write_scene(path: Path, cameras: int = 1, **scene_settings) -> Path:
    """Save a scene under sky.exr: a wall before cameras named View 1, View 2 …; Cycles, fast."""
    import bpy

    from spectral_skylight.addon.scene.world import hdri as worlds
    from spectral_skylight.tests import faces

    scene = faces.empty_scene()
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.render.resolution_percentage = 100
    for name, value in scene_settings.items():
        setattr(scene, name, value)
    world = worlds.set_sky(scene, path.with_name("sky.exr"))
    world.cycles.sampling_method = "NONE"  # else Cycles takes 1.6 s to map any World, each time
    mesh = bpy.data.meshes.new("Wall")
    mesh.from_pydata([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], [], [[0, 1, 2, 3]])
    mesh.materials.append(bpy.data.materials.new("Wall"))
    scene.collection.objects.link(bpy.data.objects.new("Wall", mesh))
    for number in range(1, cameras + 1):
        camera = bpy.data.objects.new(f"View {number}", bpy.data.cameras.new(f"View {number}"))
        camera.location, camera.rotation_euler = (0.1 * number, -4, 0), (np.pi / 2, 0, 0)
        scene.collection.objects.link(camera)
        scene.camera = camera
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    return path


def write_study(folder: Path, **changes) -> Path:
    """Write study.toml: one scene, one camera, one sky file, one variant; ``changes`` replace."""
    values = {
        "out": "out",
        "scenes": ["house.blend"],
        "cameras": "all",
        "skies": ["sky.exr"],
        "variants": [{"name": "red", "assign": "red.csv"}],
        "engine": "cycles",
        "samples": 1,
        "resolution": [16, 16],
        **changes,
    }
    lines = [f"{key} = {toml(value)}" for key, value in values.items() if value is not None]
    path = folder / "study.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def toml(value) -> str:
    """A value as TOML writes it."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml(item) for item in value) + "]"
    return json.dumps(value)


NOON = {
    "date": "2025-06-21",
    "times": ["12:00"],
    "latitude": 48.1,
    "longitude": 11.6,
    "timezone": "Europe/Berlin",
    "north": 0,
}
"""A sky table."""
