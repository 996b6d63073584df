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
from geometry import BUILDING_CAMERA, BUILDING_MATERIALS, CHECKER_CAMERA
from tqdm import tqdm

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.light import SkyLight, analyse
from spectral_skylight.addon.sky.panorama import read_panorama, write_panorama
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import predict, rgb_albedo

SUN_ELEVATION = 45.0
SCENES = {"checker": CHECKER_CAMERA, "building": BUILDING_CAMERA}


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
            *((f"render {name}", lambda name=name: self.render(name)) for name in SCENES),
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
        self.albedos = rgb_albedo(self.checker.values)
        self.prediction = predict(self.transfer, self.checker.values, KnownLight.of(self.light))

    def build_scenes(self) -> None:
        import scenes

        parts = list(BUILDING_MATERIALS)
        self.assigned = {
            "checker": {name: name for name in self.checker.names},
            "building": BUILDING_MATERIALS,
        }
        of_parts = [self.index(BUILDING_MATERIALS[part]) for part in parts]
        with silenced(self.log):
            shown = self.exposure, not self.simulated  # our own sky is made without its sun's disc
            scenes.save_checker(
                self.blend("checker"), list(self.checker.names), self.albedos, *shown
            )
            scenes.save_building(self.blend("building"), parts, self.albedos[of_parts], *shown)

    def render(self, name: str) -> None:
        """Render a scene spectrally, and as RGB times RGB.

        The second with the same light on the same faces, times the base colour: Eevee's own diffuse
        light would add its 20 % of luminance to the difference, where a diagonal matrix shows what
        multiplying in RGB alone costs.
        """
        import bpy

        from spectral_skylight.addon.scene.materials import spectral_material
        from spectral_skylight.addon.scene.output.render import render

        spectral = self.out / f"{name}_spectral.blend"
        assignments = [
            part
            for material, reflectance in self.assigned[name].items()
            for part in ("--assign", f"{material}={self.csv}:{reflectance}")
        ]
        with silenced(self.log):
            # The reference's light from below is the sky's own lower half.
            options = "--sky", self.sky, *assignments, "--ground", "hdri"
            command("apply", self.blend(name), *options, "--out", spectral)
            command("render", spectral, "--out", self.out / f"{name}_spectral.exr")
            for material, reflectance in self.assigned[name].items():
                albedo = self.albedos[self.index(reflectance)]
                spectral_material.update(bpy.data.materials[material], np.diag(albedo))
            render(bpy.context.scene, self.out / f"{name}_rgb.exr")

    def compute_reference(self) -> None:
        """Without Blender: which surface each pixel shows, and under our own sky its colour."""
        self.surfaces = {
            "checker": reference.checker_normals(),
            "building": reference.building_normals(),
        }
        self.references = {}
        if not self.simulated:
            return
        from spectral_skylight.addon.sky.clear_sky import clear_sky

        sky = clear_sky(SUN_ELEVATION, 128, orders=1)
        for name, camera in SCENES.items():
            rows = [self.index(reflectance) for reflectance in self.assigned[name].values()]
            image, white = reference.picture(
                sky, *self.surfaces[name], self.checker.values[rows], camera
            )
            write_panorama(self.out / f"{name}_reference.exr", image)
            pictures.save_png(self.out / f"{name}_reference.png", image, self.exposure)
            self.references[name] = image, white

    def report(self) -> None:
        images = {}
        for name in SCENES:
            images[name] = {
                kind: pictures.read(self.out / f"{name}_{kind}.exr") for kind in ("rgb", "spectral")
            }
            if name in self.references:
                images[name]["reference"] = self.references[name][0]
        rows = patches.measure(
            self.checker.names,
            self.prediction,
            self.surfaces["checker"],
            images["checker"],
            self.references.get("checker"),
        )
        summary = patches.write_report(self.out, rows, self.light, self.sky.name)
        for name in SCENES:
            pictures.save_comparison(
                self.out / f"{name}.png",
                images[name],
                self.error_maps(name, images[name]),
                self.exposure,
                [*summary, self.light.caption],
            )
        print("\n".join([*summary, self.light.caption]))

    def error_maps(self, name: str, images: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return CIEDE2000 of the rendered pictures on surfaces, NaN on sky and edges."""
        if name not in self.references:
            return {}
        from scipy.ndimage import binary_erosion

        true, white = self.references[name]
        shown = self.surfaces[name][0]
        # Blender's pixel filter reaches a pixel beyond an edge.
        inside = np.any(
            [
                binary_erosion(reference.pixel_means(shown == k) == 1)
                for k in range(len(self.assigned[name]))
            ],
            axis=0,
        )
        return {
            kind: np.where(inside, delta_E(images[kind], true, white), np.nan)
            for kind in ("rgb", "spectral")
        }

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
