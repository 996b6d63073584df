"""The panel's example house as Eevee shows it, and with the add-on:  sh examples/run house

Both have the same sky, the same base colors and the same camera: what the two clicks of the first
minute change.
"""

import argparse
from pathlib import Path

import bpy
import numpy as np
import pictures

import spectral_skylight
from spectral_skylight.addon.scene import example_house
from spectral_skylight.addon.scene.output import render

TITLES = {"eevee": "Eevee today", "spectral": "One click later"}
SAMPLES = 64


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(prog="examples/run house", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "house")
    parser.add_argument("--width", type=int, default=480)
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    spectral_skylight.register()
    bpy.ops.skylight.open_example()
    scene = bpy.data.scenes[example_house.NAME]
    bpy.context.window.scene = scene  # as the button does in a window of its own
    scene.render.resolution_x, scene.render.resolution_y = options.width, options.width * 2 // 3
    scene.eevee.taa_render_samples = SAMPLES
    images = {}
    for name in TITLES:
        if name == "spectral":
            bpy.ops.skylight.make_spectral()
        path = out / f"{name}.exr"
        render.render(scene, path, engine="eevee")
        images[name] = pictures.read(path)
    exposure = float(np.log2(0.9 / np.percentile(images["spectral"].max(axis=2), 98)))
    pictures.save_comparison(out / "house.png", images, {}, exposure, [], TITLES)


if __name__ == "__main__":
    main()
