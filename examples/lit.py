"""Examples: a scene lit spectrally in Eevee, today's way, and the referee's.

    sh examples/run NAME ... [--samples N] [--width N]
    sh examples/run random --seed N

Pictures and figures: examples/out/NAME/
"""

import argparse
import contextlib
import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import bands
import bpy
import judging
import numpy as np
import OpenEXR
import paints
import pictures
import random_scene
import referee
import stage as stages
from example import WIDTH, Example, Light
from lit_scenes import SCENES
from main_job import command, silenced
from reference import WAVELENGTHS, sky_directions
from stage import Stage, Sun

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.scene.materials import rgb_comparison
from spectral_skylight.addon.scene.output import render as renders
from spectral_skylight.addon.sky.panorama import write_panorama

TITLES = {
    "rgb": "RGB × RGB in Cycles, every bounce",
    "eevee": "RGB × RGB in Eevee",
    "rgb_same": "RGB × RGB, light as ours",
    "spectral": "Spectral Skylight in Eevee",
}
"""What is judged: today's multiplication in the true light, all of today, the multiplication in our
light with what is wrong with that, and ours."""


def main() -> int:
    """Run one example; exit code as the command line's."""
    parser = argparse.ArgumentParser(prog="examples/run", description=__doc__.splitlines()[0])
    names = [*SCENES, "random"]
    parser.add_argument("names", nargs="+", choices=names, metavar="NAME", help=", ".join(names))
    parser.add_argument("--seed", type=int, default=0, help="of a random scene")
    parser.add_argument("--samples", type=int, help="of the referee, a pixel and seed")
    parser.add_argument("--width", type=int, default=WIDTH, help="pixels")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out")
    options = parser.parse_args()
    examples = {**SCENES, "random": random_scene.example(options.seed)}
    for name in options.names:
        example = examples[name]
        folder = f"random_{options.seed}" if name == "random" else name
        out = (options.out / folder).resolve()
        out.mkdir(parents=True, exist_ok=True)
        try:
            samples = options.samples or example.samples
            run(folder, example, out, samples, (options.width, options.width * 2 // 3))
        except InputError as error:
            print(f"examples/run: {error}", file=sys.stderr)
            return 2
        print(f"Pictures and report: {out}")
    return 0


def run(name: str, example: Example, out: Path, samples: int, size: tuple[int, int]) -> None:
    """Leave the pictures and the report of one example in a folder."""
    seconds: dict[str, float] = {}
    with silenced(out / "blender.log"):
        with timed(seconds, "scene"):
            stage = example.build(light(example, out, size))
            stages.build(stage, referee.Today(), str(out / "sky.exr"))
            rays = judging.cast(stage)
            stages.save(out / "scene.blend", min(64, max(1, samples // 2)))
        with timed(seconds, "referee"):
            verdict = referee.judge_once(stage, samples, out)
        with timed(seconds, "eevee"):
            command("render", out / "scene.blend", "--out", out / "eevee.exr")
        with timed(seconds, "spectral"):
            relight(stage, example, out)
        with timed(seconds, "rgb_same"):
            # In the file that was rendered last: other values, no other light.
            rgb_comparison.show(rgb_comparison.RGB)
            renders.render(bpy.context.scene, out / "rgb_same.exr", engine="eevee")
        beside = {}
        for other, options in example.beside.items():
            folder = out / other.replace(" ", "_")
            folder.mkdir(exist_ok=True)
            with timed(seconds, other):
                relight(stage, replace(example, options=options), out, folder)
            beside[other] = pictures.read(folder / "spectral.exr")
    images = {
        "rgb": verdict.rgb,
        "eevee": pictures.read(out / "eevee.exr"),
        "rgb_same": pictures.read(out / "rgb_same.exr"),
        "spectral": pictures.read(out / "spectral.exr"),
        "reference": verdict.spectral,
    }
    where = judging.pixels(rays, stage, verdict)
    report = {
        "scene": name,
        "shows": example.shows,
        "blender": bpy.app.version_string,
        "how": judging.HOW,
        **{kind: judging.errors(images[kind], verdict, where) for kind in TITLES},
        "beside": {k: judging.errors(image, verdict, where) for k, image in beside.items()},
        "referee": {
            "noise": judging.noise(verdict.spectral_seeds, where),
            "rgb_noise": judging.noise(verdict.rgb_seeds, where),
            "bounced": judging.bounced(verdict, where),
            "bounces": referee.BOUNCES,
            "samples": 2 * samples,
            "knots_nm": bands.KNOTS.tolist(),
        },
        "pixels": {"judged": int(where.judged.sum()), "share_left_out": where.left_out},
        "seconds": seconds,
    }
    (out / "report.json").write_text(json.dumps(report, indent=1), encoding="utf-8")
    save_pictures(out, images, verdict, where, report)
    print("\n".join(told(report)))


def light(example: Example, out: Path, size: tuple[int, int]) -> Light:
    """Make an example's sky: the HDRI that an architect has, and its spectra for the referee."""
    sun = "--sun-elevation", example.elevation, "--sun-azimuth", example.azimuth
    write_csv(out / "ground.csv", {"ground": paints.reflectance(example.ground)})
    sun += "--ground", out / "ground.csv"
    disc = ["--sun-disc"] if example.sunlit else []
    command("sky", *sun, *disc, "--width", 1024, "--out", out / "sky.exr")
    spectra = []
    for width, disc in ((256, []), (64, []), (64, ["--sun-disc"])):
        path = out / f"sky_{width}.spectral.exr"
        command("sky", *sun, *disc, "--width", width, "--spectral", path)
        with OpenEXR.File(str(path)) as file:
            channels = file.channels().values()
            spectra.append(np.stack([c.pixels for c in channels], axis=-1).astype(float))
        path.unlink()
    sky, without, with_disc = spectra
    _, solid = sky_directions(without.shape[0])
    disc = np.maximum(with_disc - without, 0.0) * solid[..., None]
    place = np.radians([example.elevation, 90.0 - example.azimuth])
    direction = np.array(
        [np.cos(place[0]) * np.cos(place[1]), np.cos(place[0]) * np.sin(place[1]), np.sin(place[0])]
    )
    return Light(sky, Sun(direction, disc.sum(axis=(0, 1))), size)


def relight(stage: Stage, example: Example, out: Path, to: Path | None = None) -> None:
    """Make the scene spectral, and render it, by the command line alone; ``to``: into a folder."""
    to = to or out
    make_spectral(stage, example, out, to / "skylight.blend")
    command("render", to / "skylight.blend", "--engine", "eevee", "--out", to / "spectral.exr")


def make_spectral(stage: Stage, example: Example, out: Path, blend: Path) -> None:
    """Give all materials and lamps of the scene in a folder their spectra, by the command line."""
    options = [*example.options, "--sun-elevation", example.elevation]

    def given(option: str, file: str, spectra: dict[str, np.ndarray]) -> None:
        if spectra:
            write_csv(out / file, spectra)
        for name in spectra:
            options.extend([option, f"{name}={out / file}:{name}"])

    matter = {name: m for name, m in stage.matter.items() if not m.unmanaged}
    measured = {name: m.measured for name, m in matter.items() if m.measured is not None}
    panes = {name: m.transmittance for name, m in matter.items() if m.transmittance is not None}
    given("--assign", "paints.csv", measured)
    given("--glass", "panes.csv", panes)
    given("--lamp", "lamps.csv", {name: lamp.spectrum for name, lamp in stage.lamps.items()})
    for name, m in matter.items():
        if m.measured is None and m.reflectance is not None:
            options += ["--estimate", name]
        if m.behind is not None:
            options += ["--behind", f"{name}={out / 'panes.csv'}:{m.behind}"]
        if m.metal is not None:
            file = out / f"{name}.nk.csv"
            write_csv(file, dict(zip("nk", m.metal, strict=True)))
            options += ["--metal", f"{name}={file}"]
    command("apply", out / "scene.blend", *options, "--out", blend)


def write_csv(path: Path, columns: dict[str, np.ndarray]) -> None:
    """Write spectra (81,) as a table that the command line reads."""
    rows = ["wavelength_nm," + ",".join(columns)]
    for values in zip(WAVELENGTHS, *columns.values(), strict=True):
        rows.append(",".join(f"{value:.6g}" for value in values))
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def save_pictures(out, images, verdict, where, report) -> None:
    """Save each picture as EXR and PNG, and all beside the maps of their errors."""
    bright = np.percentile((verdict.spectral @ judging.LUMINANCE)[where.face >= 0], 98)
    exposure = float(np.log2(0.7 / bright))
    for kind, picture in images.items():
        if kind in ("rgb", "reference"):
            write_panorama(out / f"{kind}.exr", picture)
        pictures.save_png(out / f"{kind}.png", picture, exposure)
    errors = {k: judging.error_map(images[k], verdict.spectral, where) for k in TITLES}
    pictures.save_comparison(
        out / f"{report['scene']}.png",
        images,
        errors,
        exposure,
        told(report),
        titles={**TITLES, "reference": "Cycles, wavelength by wavelength"},
        most=5.0,
    )


def told(report: dict) -> list[str]:
    """Return what a report says, in lines."""
    lines = [report["shows"]]
    judged = {name: report[kind] for kind, name in TITLES.items()}
    judged |= {f"Ours, {name}": errors for name, errors in report["beside"].items()}
    for name, errors in judged.items():
        whole, colour = (errors[key] for key in ("delta_E", "colour"))
        lines.append(
            f"{name}: CIEDE2000 mean {whole['mean']:.2f}, p95 {whole['p95']:.2f}, "
            f"worst {whole['worst']:.2f}; colour alone {colour['mean']:.2f}, {colour['p95']:.2f}, "
            f"{colour['worst']:.2f}"
        )
    noise = report["referee"]["noise"]
    lines.append(
        f"Noise of the reference: mean {noise['mean']:.2f}, p95 {noise['p95']:.2f}; "
        f"{report['referee']['bounced']:.0%} of its light has bounced"
    )
    return lines


@contextlib.contextmanager
def timed(seconds: dict[str, float], name: str):
    """Keep how long something took."""
    began = time.perf_counter()
    yield
    seconds[name] = round(time.perf_counter() - began, 1)


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # bpy before 5.0 can crash while the interpreter takes itself apart
