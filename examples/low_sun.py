"""A street at low sun, four times:  sh examples/run low_sun

Eevee as it comes, Cycles' RGB × RGB, ours, and the truth: what each is off by, and how long it has
taken. The README begins with it.
"""

import os
import sys
from pathlib import Path

import judging
import numpy as np
import pictures
from enclosed_scenes import street
from example import Example
from main_job import silenced
from ready import ready
from ways import WAYS

SIZE = 240, 160
EXAMPLE = Example("A street at low sun", 10, 200, street, sunlit=True, samples=128)
SHOWN = {
    "Eevee as it comes": "Eevee today: RGB × RGB",
    "Cycles RGB, 256 samples": "Cycles, RGB × RGB",
    "Ours, all light": "Spectral Skylight in Eevee",
}
TRUTH = "Truth: Cycles at 15 wavelengths"
MOST = 5.0
"""CIEDE2000 that the maps show brightest."""


def main() -> None:
    """Run the example."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "out"
    scene = ready("low_sun", EXAMPLE, out, SIZE)
    images, errors, titles = {}, {}, {}
    for way, title in SHOWN.items():
        with silenced(scene.folder / "blender.log"):
            (shot,) = WAYS[way].shots(scene, False)
        images[way] = shot.picture
        errors[way] = judging.error_map(shot.picture, scene.verdict.spectral, scene.where)
        titles[way] = f"{title}\n{shot.seconds[1]:.0f} s of processor time"
        print(way, *(f"{name} {value:.2f}" for name, value in scene.figures(shot.picture).items()))
    images["truth"] = scene.verdict.spectral
    titles["truth"] = f"{TRUTH}\nnoise {scene.noise()['mean']:.2f}"
    bright = np.percentile((images["truth"] @ judging.LUMINANCE)[scene.where.face >= 0], 98)
    exposure = float(np.log2(0.7 / bright))
    path = scene.folder / "low_sun.png"
    pictures.save_comparison(path, images, errors, exposure, [], titles, MOST)
    print(path)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # bpy before 5.0 can crash while the interpreter takes itself apart
