"""The panel's example house as Eevee shows it, and with the add-on:  sh examples/run house

Both have the same sky, the same base colors and the same camera: what the two clicks of the first
minute change. Below the whole stands the court, from the same eye.
"""

import argparse
import math
from pathlib import Path

import bpy
import numpy as np
import pictures
from mathutils import Vector

import spectral_skylight
from spectral_skylight.addon.scene import example_house
from spectral_skylight.addon.scene.output import render

TITLES = {"eevee": "Eevee today", "spectral": "One click later"}
COURT, DETAIL = (-0.4, -1.0, 1.4), math.radians(27.0)
"""What the second picture is aimed at [m], and the angle that it shows."""


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(prog="examples/run house", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "house")
    parser.add_argument("--width", type=int, default=480)
    parser.add_argument("--samples", type=int, default=64)
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    scene = opened(options.width, options.samples)
    images = {}
    for name in TITLES:
        if name == "spectral":
            bpy.ops.skylight.make_spectral()
        images[name] = np.concatenate([_picture(scene, out / f"{name}.exr"), *_detail(scene, out)])
    brightest = images["spectral"].max(axis=2)
    exposure = float(np.log2(0.9 / np.percentile(brightest[np.isfinite(brightest)], 98)))
    pictures.save_comparison(out / "house.png", images, {}, exposure, [], TITLES)


def opened(width: int, samples: int) -> bpy.types.Scene:
    """Open the example house as the panel's button does, for pictures so wide; return its scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    spectral_skylight.register()
    bpy.ops.skylight.open_example()
    scene = bpy.data.scenes[example_house.NAME]
    bpy.context.window.scene = scene  # as the button does in a window of its own
    scene.render.resolution_x, scene.render.resolution_y = width, width * 2 // 3
    scene.eevee.taa_render_samples = samples
    return scene


def _picture(scene: bpy.types.Scene, path: Path) -> np.ndarray:
    render.render(scene, path, engine="eevee")
    return pictures.read(path)


def _detail(scene: bpy.types.Scene, out: Path) -> list[np.ndarray]:
    """A white gap and the court, as wide as the whole."""
    camera = scene.camera
    turn, angle = camera.rotation_euler.copy(), camera.data.angle
    towards = Vector(COURT) - camera.location
    camera.rotation_euler, camera.data.angle = towards.to_track_quat("-Z", "Y").to_euler(), DETAIL
    found = _picture(scene, out / "detail.exr")
    camera.rotation_euler, camera.data.angle = turn, angle
    gap = np.full((max(len(found) // 40, 1), *found.shape[1:]), np.inf)  # white at any exposure
    return [gap, found]


if __name__ == "__main__":
    main()
