"""The command line: ``spectral-skylight …`` and, in Blender, ``blender -c skylight …``.

Each command gathers its arguments, calls one function of another room and prints what came back.
Exit codes: 0 done, 1 failed, 2 wrong usage or bad input (one line on stderr).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from .errors import InputError


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; ``arguments`` as in ``sys.argv[1:]``. Returns the exit code."""
    parser = _parser()
    try:
        options = parser.parse_args(arguments)
    except SystemExit as stop:  # --help, wrong usage
        return int(stop.code or 0)
    try:
        options.run(options)
    except InputError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"{parser.prog}: stopped", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="spectral-skylight", description="Spectrally correct colours under skies."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    matrix = commands.add_parser("matrix", help="reflectance CSVs to 3x3 matrices")
    matrix.add_argument("files", nargs="+", metavar="FILE.csv", help="one or more materials each")
    source = matrix.add_mutually_exclusive_group()
    source.add_argument("--sky", metavar="HDRI", help="predict the errors under this sky")
    source.add_argument(
        "--sky-rgb", type=_three, metavar="R,G,B", help="the skylight's colour, in the space"
    )
    _add_matrix_options(matrix)
    matrix.add_argument("--space", default="Linear Rec.709", help="working space of the scene")
    matrix.add_argument("--json", action="store_true", help="print JSON")
    matrix.set_defaults(run=_matrix)

    sky = commands.add_parser("sky", help="a clear sky as a lat-long HDRI")
    sky.add_argument("--sun-elevation", type=float, required=True, metavar="DEG", help="-6 to 90")
    sky.add_argument("--sun-azimuth", type=float, default=180.0, metavar="DEG", help="from north")
    sky.add_argument("--sun-disc", action="store_true", help="with the sun itself in the picture")
    sky.add_argument("--haze", type=float, default=0.05, help="aerosol optical depth at 550 nm")
    sky.add_argument("--width", type=int, default=1024, help="pixels; the height is half of it")
    sky.add_argument("--out", metavar="SKY.exr", help="linear Rec.709; 1 is 10,000 cd/m²")
    sky.add_argument("--spectral", metavar="SPECTRAL.exr", help="W m⁻² sr⁻¹ nm⁻¹, 81 channels")
    sky.set_defaults(run=_sky)

    irradiance = commands.add_parser("irradiance", help="irradiance of an HDRI, without its sun")
    irradiance.add_argument("sky", metavar="HDRI")
    irradiance.add_argument("--out", required=True, metavar="E.exr", help="lat-long, over normals")
    irradiance.add_argument("--width", type=int, default=64, help="pixels of E.exr")
    irradiance.add_argument("--degree", type=int, choices=range(7), help="of the polynomial")
    irradiance.add_argument("--white", type=_three, metavar="R,G,B", help="undo white balance")
    irradiance.add_argument("--json", action="store_true", help="print coefficients and errors")
    irradiance.set_defaults(run=_irradiance)

    apply = commands.add_parser("apply", help="make materials of a .blend spectral")
    apply.add_argument("scene", metavar="SCENE.blend")
    apply.add_argument("--sky", metavar="HDRI", help="default: the World's own")
    apply.add_argument(
        "--assign",
        action="append",
        required=True,
        type=_assignment,
        metavar="MATERIAL=FILE.csv[:COLUMN]",
        help="may be given many times",
    )
    _add_matrix_options(apply)
    apply.add_argument("--space", help="checked against the file's working space")
    apply.add_argument("--out", required=True, metavar="OUT.blend")
    apply.set_defaults(run=_apply)

    render = commands.add_parser("render", help="an EXR and a PNG of a .blend, without a window")
    render.add_argument("scene", metavar="SCENE.blend")
    render.add_argument("--out", required=True, metavar="FILE.exr")
    render.add_argument("--camera", metavar="NAME", help="default: the scene's")
    render.add_argument("--engine", choices=("eevee", "cycles"), help="default: the scene's")
    render.set_defaults(run=_render)
    return parser


def _add_matrix_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--basis",
        default="rayleigh",
        metavar="NAME",
        help="rayleigh, daylight, atmosphere or 'measured FILE.csv'",
    )
    parser.add_argument(
        "--sun-elevation", type=float, metavar="DEG", help="default: where the HDRI has it"
    )
    parser.add_argument("--camera", metavar="NAME|FILE", help="what took a raw HDRI")
    parser.add_argument(
        "--white", type=_three, metavar="R,G,B", help="neutral light before white balance"
    )
    parser.add_argument("--unit", choices=("percent", "fraction"), help="of the reflectances")


def _three(text: str) -> tuple[float, float, float]:
    try:
        r, g, b = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not three numbers R,G,B") from None
    return r, g, b


def _assignment(text: str) -> tuple[str, str]:
    material, equals, reflectance = text.partition("=")
    if not (material and equals and reflectance):
        raise argparse.ArgumentTypeError(f"'{text}' is not MATERIAL=FILE.csv[:COLUMN]")
    return material, reflectance


def _matrix(options: argparse.Namespace) -> None:
    import numpy as np

    from .sky.light import analyse
    from .sky.panorama import read_panorama
    from .spectra.reflectance import read_reflectances
    from .spectra.working_spaces import rec709_to_working
    from .transfer.matrices import transfer
    from .transfer.prediction import predict

    lights = None
    elevation = options.sun_elevation
    if options.sky_rgb is not None:
        lights = np.array([options.sky_rgb])
    elif options.sky is not None:
        light = analyse(read_panorama(options.sky))
        lights = light.faces
        if options.camera is None:
            lights = lights @ rec709_to_working(options.space).T
        if elevation is None and light.sun is not None:
            elevation = light.sun.elevation
    mapping = transfer(
        options.basis,
        camera=options.camera,
        white=options.white,
        space=options.space,
        sun_elevation=elevation,
        sky_rgb=lights,
    )
    materials: list[dict[str, Any]] = []
    for file in options.files:
        read = read_reflectances(file, options.unit)
        prediction = None if lights is None else predict(mapping, read.values, lights)
        for k, (name, M) in enumerate(zip(read.names, mapping.matrices(read.values), strict=True)):
            material: dict[str, Any] = {
                "name": name,
                "matrix": M.tolist(),
                "file": str(file),
                "unit": read.unit,
                "notes": list(read.notes),
            }
            if prediction is not None:
                if prediction.known:
                    material["predicted_delta_E"] = {
                        "rgb": float(prediction.rgb[k]),
                        "matrix": float(prediction.matrix[k]),
                    }
                material["colour"] = prediction.colour[k].tolist()
                material["out_of_gamut"] = bool(prediction.out_of_gamut[k])
            materials.append(material)
    result = {
        "materials": materials,
        "basis": options.basis,
        "space": options.space,
        "camera": options.camera,
        "white": options.white,
        "sun_elevation": elevation,
        "sky": options.sky,
        "sky_rgb": options.sky_rgb,
    }
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
        return
    for material in materials:
        print(material["name"])
        for row in material["matrix"]:
            print("  " + " ".join(f"{value:10.6f}" for value in row))
        if "predicted_delta_E" in material:
            predicted = material["predicted_delta_E"]
            print(
                f"  RGB is off by ΔE {predicted['rgb']:.2f}, spectral by {predicted['matrix']:.2f}"
            )
            if material["out_of_gamut"]:
                print("  its colour under this sky is out of gamut: Blender clamps it")
    for note in dict.fromkeys(f"{m['file']}: {note}" for m in materials for note in m["notes"]):
        print(note, file=sys.stderr)


def _sky(options: argparse.Namespace) -> None:
    from .sky.atmosphere import Atmosphere
    from .sky.panorama import write_panorama, write_spectral
    from .sky.scattering import WHITE_LUMINANCE, clear_sky, sky_rgb
    from .spectra.grid import WAVELENGTHS

    if not (options.out or options.spectral):
        raise InputError("sky", "nowhere to write to", "give --out SKY.exr or --spectral FILE.exr")
    settings: dict[str, Any] = {
        "sun_azimuth": options.sun_azimuth,
        "sun_disc": options.sun_disc,
        "atmosphere": Atmosphere(haze=options.haze),
    }
    height = options.width // 2
    if options.out:
        rgb = sky_rgb(options.sun_elevation, height, **settings)
        attributes = {
            "whiteLuminance": WHITE_LUMINANCE,
            "comments": f"clear sky, sun elevation {options.sun_elevation:g} degrees",
        }
        write_panorama(options.out, rgb, attributes)
    if options.spectral:
        write_spectral(
            options.spectral, clear_sky(options.sun_elevation, height, **settings), WAVELENGTHS
        )


def _irradiance(options: argparse.Namespace) -> None:
    from .sky.irradiance import irradiance_map
    from .sky.light import analyse
    from .sky.panorama import read_panorama, write_panorama
    from .transfer.matrices import check_white

    if options.width < 4 or options.width % 2:
        raise InputError("--width", f"{options.width} pixels", "give an even number of at least 4")
    panorama = read_panorama(options.sky)
    if options.white is not None:
        panorama.rgb[...] *= check_white(options.white).astype(panorama.rgb.dtype)
    light = analyse(panorama, options.degree)
    write_panorama(options.out, irradiance_map(light.sky, options.width))
    if options.json:
        print(json.dumps({"sky": options.sky, "white": options.white, **light.report()}, indent=1))
        return
    fit = light.fit
    print(f"degree {fit.degree} leaves {100 * fit.errors[fit.degree].worst:.2f} % at worst")
    if light.negatives:
        print(f"{light.negatives} negative value(s) were set to zero")
    print(light.caption)


def _apply(options: argparse.Namespace) -> None:
    from .scene import files, spectral, working_space
    from .spectra.reflectance import read_assigned

    reflectances = {}
    for material, text in options.assign:
        if material in reflectances:
            raise InputError(f"--assign {material}", "is given twice", "give each material once")
        reflectances[material] = read_assigned(text, options.unit)
    settings = spectral.Settings(
        basis=options.basis,
        camera=options.camera,
        white=options.white,
        sun_elevation=options.sun_elevation,
    )
    scene = files.open_scene(options.scene)
    if options.space not in (None, working_space.name()):
        raise InputError(
            options.scene,
            f"its working space is {working_space.name()}, not {options.space}",
            "leave --space out",
        )
    if options.sky is not None:
        spectral.set_sky(scene, options.sky, settings)
    targets = {files.material(name): given for name, given in reflectances.items()}
    world = spectral.develop(scene, settings)
    light, results = spectral.make_spectral(world, targets, settings)
    files.save(options.out)
    for result in results:
        print(result.line)
    print(light.caption)


def _render(options: argparse.Namespace) -> None:
    from .scene import files, render

    scene = files.open_scene(options.scene)
    for path in render.render(scene, options.out, options.camera, options.engine):
        print(path)
