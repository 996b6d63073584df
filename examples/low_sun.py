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
from ready import Ready, ready
from way import Shot
from ways import WAYS

SIZE = 240, 160
EXAMPLE = Example("A street at low sun", 10, 200, street, sunlit=True, samples=128)
SHOWN = {
    "Eevee as it comes": "Eevee today",
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
    shots = {}
    for way in SHOWN:
        with silenced(scene.folder / "blender.log"):
            (shots[way],) = WAYS[way].shots(scene, False)
        figures = scene.figures(shots[way].picture)
        print(way, *(f"{name} {value:.2f}" for name, value in figures.items()))
    path = scene.folder / "low_sun.png"
    draw(path, scene, shots)
    print(path)


def draw(path: Path, scene: Ready, shots: dict[str, Shot]) -> None:
    """Save the pictures and the truth in a row, errors and seconds under each, and their maps."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    truth = scene.verdict.spectral
    bright = np.percentile((truth @ judging.LUMINANCE)[scene.where.face >= 0], 98)
    exposure = float(np.log2(0.7 / bright))
    figure, axes = pyplot.subplots(
        2, len(shots) + 1, figsize=(16, 6.4), dpi=110, layout="constrained"
    )
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.08)
    for axis in axes.flat:
        axis.set_axis_off()
    for (top, below), (way, shot) in zip(axes.T, shots.items(), strict=False):
        error = judging.error_map(shot.picture, truth, scene.where)
        mean, p95, _ = judging.figures(error).values()
        top.imshow(pictures.show(shot.picture, exposure), interpolation="nearest")
        top.set_title(SHOWN[way], fontsize=16)
        shown = below.imshow(error, cmap="magma", vmin=0, vmax=MOST, interpolation="nearest")
        below.set_title(
            f"mean ΔE {mean:.1f}, 95 % under {p95:.1f}\n{shot.seconds[1]:.0f} s of processor time",
            fontsize=14,
        )
    axes[0, -1].imshow(pictures.show(truth, exposure), interpolation="nearest")
    axes[0, -1].set_title(TRUTH, fontsize=16)
    axes[1, -1].set_title(f"mean ΔE {scene.noise()['mean']:.1f} by chance", fontsize=14)
    scale = axes[1, -1].inset_axes([0.04, 0.62, 0.92, 0.1])
    bar = figure.colorbar(shown, cax=scale, extend="max", orientation="horizontal")
    bar.ax.tick_params(labelsize=14)
    bar.set_label("Maps: ΔE (CIEDE2000)", fontsize=14)
    figure.savefig(path)
    pyplot.close(figure)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # bpy before 5.0 can crash while the interpreter takes itself apart
