"""A day of the panel's example house, from midnight to midnight, in Eevee:  sh examples/run film

The sun's elevation and azimuth and the moments of baked light are keyframes, all else follows them.
Every second hour is rendered, small, and each is exposed by itself, as stands under it.
"""

import argparse
import time
from pathlib import Path

import bpy
import numpy as np
import pictures
from house import opened

from spectral_skylight.addon.pictures.canvas import Canvas
from spectral_skylight.addon.pictures.png_file import write_png
from spectral_skylight.addon.pictures.theme import LIGHT
from spectral_skylight.addon.scene.day import day_world
from spectral_skylight.addon.scene.output import render

HOURS = range(1, 24, 2)
ROWS = 2
FRAMES = 24 * 6 + 1
SAMPLES = 16
LARGEST = 10.0
"""[stops] of exposure: a sky that asks for more is night's."""


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(prog="examples/run film", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "film")
    parser.add_argument("--width", type=int, default=200)
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    scene = opened(options.width, SAMPLES)
    scene.world.skylight.occlusion = "open"  # the day bakes its own light
    bpy.ops.skylight.make_spectral()
    scene.world.skylight.occlusion = "auto"
    place = scene.skylight_place
    place.year, place.month, place.day, place.timezone = 2025, 6, 21, "Europe/Berlin"
    place.latitude, place.longitude = 48.14, 11.58
    start = time.process_time()
    bpy.ops.skylight.animate(start=0.0, end=24.0, frames=FRAMES)
    print(f"animated in {time.process_time() - start:.0f} s of processor time")
    print(day_world.kept_of(scene.world)["line"])
    bpy.ops.wm.save_as_mainfile(filepath=str(out / "house.blend"), copy=True)
    print(f"a frame is set in {1000 * _pace(scene):.1f} ms")
    for hour in HOURS:
        scene.frame_set(scene.frame_start + 6 * hour)
        render.render(scene, out / f"{hour:02}.exr", engine="eevee")
    print(draw(out))


def draw(out: Path) -> Path:
    """Lay the hours' pictures out as a strip, and return its path."""
    shots = [pictures.read(out / f"{hour:02}.exr") for hour in HOURS]
    height, width = shots[0].shape[:2]
    columns = len(HOURS) // ROWS
    across, down = width + 4, height + 24
    strip = Canvas(columns * across - 4, ROWS * down, 1.0, LIGHT.paper)
    for k, (hour, rgb) in enumerate(zip(HOURS, shots, strict=True)):
        bright = float(np.percentile(rgb.max(axis=2), 97))
        stops = float(np.log2(0.9 / max(bright, 1e-9)))
        shown = np.clip(rgb * 2.0 ** min(stops, LARGEST), 0.0, 1.0)
        srgb = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)
        x, y = k % columns * across, k // columns * down
        strip.image(srgb, x, y, x + width, y + height)
        exposure = f"exposure {stops:+.1f}" if stops <= LARGEST else "night"
        strip.text(x + 4, y + height + 16, f"{hour}:00, {exposure}", 12.0, LIGHT.ink)
    path = out / "film.png"
    write_png(path, strip.pixels)
    return path


def _pace(scene: bpy.types.Scene) -> float:
    """Seconds that a step of the time slider takes, without drawing."""
    frames = range(scene.frame_start, scene.frame_end, 3)
    start = time.perf_counter()
    for frame in frames:
        scene.frame_set(frame)
    return (time.perf_counter() - start) / len(frames)


if __name__ == "__main__":
    main()
