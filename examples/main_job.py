"""The main job: reflectances and a sky in, spectrally correct pictures of two scenes out.

    sh examples/run [--sky FILE] [--out FOLDER]

Everything goes through the command line's own functions, as a studio's script would have it.
"""

import argparse
import contextlib
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import colour
import numpy as np
import patches
import pictures
import reference
from geometry import BUILDING_MATERIALS
from tqdm import tqdm

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.light import SkyLight, analyse
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import predict

SUN_ELEVATION = 45.0
SAMPLES = 16
"""Of Eevee, a pixel."""
REFEREE_SAMPLES = 32
"""A pixel and seed."""

OPTIONS = {
    # Nothing stands beside the checker's spheres: the sky as it is, its lower half too.
    "checker": ("--occlusion", "open", "--ground", "hdri"),
    "building": (),
}
"""Of `apply`, by scene."""


def main() -> int:
    """Run the example; exit code as the command line's."""
    parser = argparse.ArgumentParser(prog="examples/run", description=__doc__.splitlines()[0])
    parser.add_argument("--sky", type=Path, help="a photographed HDRI instead of the simulated sky")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out")
    options = parser.parse_args()
    try:
        return MainJob(options.out.resolve(), options.sky).run()
    except InputError as error:
        print(f"examples/run: {error}", file=sys.stderr)
        return 2


class MainJob:
    """Its steps in order; each leaves files in ``out`` that the next one reads."""

    def __init__(self, out: Path, sky: Path | None) -> None:
        self.out = out
        self.simulated = sky is None
        self.sky = out / "sky.exr" if sky is None else sky.resolve()
        self.csv = out / "colorchecker.csv"
        self.log = out / "blender.log"

    def run(self) -> int:
        self.out.mkdir(parents=True, exist_ok=True)
        steps = [
            ("sky", self.make_sky),
            ("matrices", self.compute_matrices),
            ("scenes", self.build_scenes),
            *((f"render {name}", lambda name=name: self.render(name)) for name in OPTIONS),
            ("reference", self.compute_reference),
            ("report", self.report),
        ]
        with tqdm(steps, file=sys.stderr, bar_format="{desc:<20} {bar:20} {elapsed}") as progress:
            for name, step in progress:
                progress.set_description(name)
                step()
        print(f"Pictures and report: {self.out}")
        return 0

    def make_sky(self) -> None:
        if self.simulated:
            height = 256
            command(
                *("sky", "--sun-elevation", SUN_ELEVATION, "--orders", 1),
                *("--width", 4 * height, "--out", self.sky),
            )
        self.light: SkyLight = analyse(read_panorama(self.sky))
        self.exposure = pictures.exposure(self.light.faces)

    def compute_matrices(self) -> None:
        checker = colour.SDS_COLOURCHECKERS["BabelColor Average"]
        wavelengths = next(iter(checker.values())).wavelengths
        columns = [sd[wavelengths] for sd in checker.values()]
        rows = ["wavelength_nm," + ",".join(checker)]
        for wavelength, *values in zip(wavelengths, *columns, strict=True):
            rows.append(",".join(f"{value:g}" for value in (wavelength, *values)))
        self.csv.write_text("\n".join(rows) + "\n", encoding="utf-8")
        self.checker = read_reflectances(self.csv)
        elevation = self.light.sun_elevation()
        self.transfer = transfer("atmosphere", sun_elevation=elevation, sky_rgb=self.light.faces)
        matrices = self.transfer.matrices(self.checker.values)
        (self.out / "matrices.json").write_text(
            json.dumps(dict(zip(self.checker.names, matrices.tolist(), strict=True)), indent=1)
        )
        self.prediction = predict(self.transfer, self.checker.values, KnownLight.of(self.light))

    def build_scenes(self) -> None:
        import bpy
        import scenes
        import stage
        from referee import Today

        from spectral_skylight.addon.sky.clear_sky import clear_sky

        self.assigned = {
            "checker": {name: name for name in self.checker.names},
            "building": BUILDING_MATERIALS,
        }
        reflectances = dict(zip(self.checker.names, self.checker.values, strict=True))
        sky = clear_sky(SUN_ELEVATION, 128, orders=1) if self.simulated else None
        self.stages = {
            "checker": scenes.checker_stage(reflectances, sky),
            "building": scenes.building_stage(reflectances, sky),
        }
        with silenced(self.log):
            for name, each in self.stages.items():
                stage.build(each, Today(), str(self.sky))
                bpy.context.scene.world.probe_resolution = "128"  # nothing here mirrors the World
                # Our own sky is made without its sun's disc.
                stage.save(self.blend(name), SAMPLES, self.exposure, shadows=not self.simulated)

    def render(self, name: str) -> None:
        """Render a scene spectrally, and as RGB times RGB with the same light on the same faces.

        Eevee's own diffuse light would add its 20 % of luminance to the difference, where RGB times
        RGB in our light shows what multiplying alone costs.
        """
        import bpy

        from spectral_skylight.addon.scene.materials import rgb_comparison
        from spectral_skylight.addon.scene.output.render import render

        spectral = self.out / f"{name}_spectral.blend"
        assignments = [
            part
            for material, reflectance in self.assigned[name].items()
            for part in ("--assign", f"{material}={self.csv}:{reflectance}")
        ]
        with silenced(self.log):
            options = "--sky", self.sky, *assignments, *OPTIONS[name]
            command("apply", self.blend(name), *options, "--out", spectral)
            command("render", spectral, "--out", self.out / f"{name}_spectral.exr")
            rgb_comparison.show(True)
            render(bpy.context.scene, self.out / f"{name}_rgb.exr")

    def compute_reference(self) -> None:
        """Under our own sky: the checker without Blender, the building by the referee."""
        self.surfaces = reference.checker_normals()
        self.truth: dict[str, patches.Truth] = {}
        if not self.simulated:
            return
        self.truth = {"checker": self.checker_truth(), "building": self.building_truth()}
        for name, truth in self.truth.items():
            write_panorama(self.out / f"{name}_reference.exr", truth.picture)
            pictures.save_png(self.out / f"{name}_reference.png", truth.picture, self.exposure)

    def checker_truth(self) -> patches.Truth:
        """Return the sum over all wavelengths and all of the sky: nothing stands beside."""
        stage = self.stages["checker"]
        true, white = reference.picture(stage.sky, *self.surfaces, self.checker.values)
        inside = reference.well_inside(self.surfaces[0])
        return patches.Truth(
            true, white, lambda image: np.where(inside, delta_E(image, true, white), np.nan)
        )

    def building_truth(self) -> patches.Truth:
        """Return the referee's picture: walls, roof and paving light one another."""
        import judging
        import referee

        stage, face = self.stages["building"], reference.building_faces()
        with silenced(self.log):
            verdict = referee.judge_once(stage, REFEREE_SAMPLES, self.out)
        rays = judging.Rays(face, np.zeros((0, *face.shape), bool), face >= 0)
        where = judging.pixels(rays, stage, verdict)
        return patches.Truth(
            verdict.spectral,
            verdict.white,
            lambda image: judging.error_map(image, verdict.spectral, where),
            judging.noise(verdict.spectral_seeds, where),
        )

    def report(self) -> None:
        import judging

        images = {
            name: {
                kind: pictures.read(self.out / f"{name}_{kind}.exr") for kind in ("rgb", "spectral")
            }
            for name in OPTIONS
        }
        errors = {
            name: {kind: truth.error(image) for kind, image in images[name].items()}
            for name, truth in self.truth.items()
        }
        rows = patches.measure(
            self.checker.names,
            self.prediction,
            self.surfaces,
            images["checker"],
            self.truth["checker"] if self.truth else None,
        )
        building = {
            kind: judging.figures(error) for kind, error in errors.get("building", {}).items()
        }
        lines: dict[str, list[str]] = {"building": []}
        if self.truth:
            building["noise"] = self.truth["building"].noise
            lines["building"] = [
                f"Noise of the reference: mean CIEDE2000 {building['noise']['mean']:.2f}"
            ]
        summary = patches.write_report(self.out, rows, self.light, self.sky.name, building)
        lines["checker"] = [*summary, self.light.caption]
        for name in OPTIONS:
            shown = images[name]
            if self.truth:
                shown = {**shown, "reference": self.truth[name].picture}
            pictures.save_comparison(
                self.out / f"{name}.png",
                shown,
                errors.get(name, {}),
                self.exposure,
                lines[name],
                titles=pictures.TITLES[name],
            )
        print("\n".join([*summary, self.light.caption]))

    def blend(self, name: str) -> Path:
        return self.out / f"{name}.blend"

    def index(self, reflectance: str) -> int:
        return self.checker.names.index(reflectance)


def command(*arguments: object) -> None:
    """Run one ``spectral-skylight`` command; stop where it fails."""
    if code := cli.main([str(argument) for argument in arguments]):
        raise SystemExit(code)


@contextlib.contextmanager
def silenced(log: Path) -> Iterator[None]:
    """Send what Blender prints, from C too, to the end of a log file."""
    sys.stdout.flush()
    screen = os.dup(1)
    with log.open("ab") as file:
        os.dup2(file.fileno(), 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(screen, 1)
        os.close(screen)


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # bpy before 5.0 can crash while the interpreter takes itself apart
