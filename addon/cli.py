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
    _add_sky_options(sky)
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

    evaluate = commands.add_parser("evaluate", help="errors over a day, or under measured light")
    _add_evaluate_options(evaluate)
    evaluate.set_defaults(run=_evaluate)

    render = commands.add_parser("render", help="an EXR and a PNG of a .blend, without a window")
    render.add_argument("scene", metavar="SCENE.blend")
    render.add_argument("--out", required=True, metavar="FILE.exr")
    render.add_argument("--camera", metavar="NAME", help="default: the scene's")
    render.add_argument("--engine", choices=("eevee", "cycles"), help="default: the scene's")
    render.set_defaults(run=_render)
    return parser


def _add_sky_options(sky: argparse.ArgumentParser) -> None:
    sky.add_argument("--sun-elevation", type=float, metavar="DEG", help="-6 to 90")
    sky.add_argument("--sun-azimuth", type=float, metavar="DEG", help="from north; default 180")
    sky.add_argument("--date", metavar="YYYY-MM-DD", help="place the sun by date, time and place")
    sky.add_argument("--time", default="12:00", metavar="HH:MM", help="default: noon")
    sky.add_argument("--latitude", type=float, metavar="DEG", help="north positive")
    sky.add_argument("--longitude", type=float, metavar="DEG", help="east positive")
    sky.add_argument(
        "--timezone", default="UTC", metavar="ZONE", help="Europe/Berlin, or hours east: +2"
    )
    sky.add_argument("--sun-disc", action="store_true", help="with the sun itself in the picture")
    haze = sky.add_mutually_exclusive_group()
    haze.add_argument("--haze", type=float, help="aerosol optical depth at 550 nm; default 0.05")
    haze.add_argument(
        "--turbidity", type=float, metavar="B", help="Ångström's: the same at 1000 nm"
    )
    sky.add_argument("--angstrom", type=float, default=1.3, help="Ångström's exponent of the haze")
    sky.add_argument("--ozone", type=float, default=300.0, metavar="DU", help="Dobson units")
    sky.add_argument("--water", type=float, default=14.0, metavar="MM", help="precipitable")
    sky.add_argument(
        "--ground", default="0.2", metavar="R|FILE.csv[:COLUMN]", help="reflectance of the ground"
    )
    sky.add_argument(
        "--paper", action="store_true", help="the paper's air: λ⁻⁴ alone, nothing absorbs"
    )
    sky.add_argument("--orders", default="all", metavar="N|all", help="scatterings to count")
    sky.add_argument("--quality", choices=("preview", "reference"), default="preview")
    sky.add_argument("--seed", type=int, default=0, help="of the photons' chances")
    sky.add_argument("--width", type=int, default=1024, help="pixels; the height is half of it")
    sky.add_argument("--out", metavar="SKY.exr", help="linear Rec.709; 1 is 10,000 cd/m²")
    sky.add_argument("--spectral", metavar="SPECTRAL.exr", help="W m⁻² sr⁻¹ nm⁻¹, 81 channels")


def _add_evaluate_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", required=True, metavar="DIR", help="figures and tables go here")
    parser.add_argument(
        "--daylight", metavar="FILE.csv", help="spectra of light, instead of a simulated day"
    )
    parser.add_argument(
        "--sun-elevation",
        type=_numbers,
        metavar="DEG[,DEG…]",
        help="of the measured light, one for all spectra or one for each",
    )
    parser.add_argument("--camera", metavar="NAME|FILE", help="what sees the measured light")
    parser.add_argument(
        "--reflectances", nargs="+", metavar="FILE.csv", help="default: the ColorChecker"
    )
    parser.add_argument("--unit", choices=("percent", "fraction"), help="of the reflectances")
    parser.add_argument(
        "--basis", nargs="+", metavar="NAME", help="default: rayleigh daylight atmosphere"
    )
    parser.add_argument("--date", default="2025-03-20", metavar="YYYY-MM-DD")
    parser.add_argument("--latitude", type=float, default=35.68, metavar="DEG", help="of the day")
    parser.add_argument("--longitude", type=float, default=139.77, metavar="DEG")
    parser.add_argument("--timezone", default="+9", metavar="ZONE", help="default: Tokyo's")
    parser.add_argument("--step", type=int, default=30, metavar="MINUTES", help="between skies")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")


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


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not DEG or DEG,DEG,…") from None


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
    from .sky.clear_sky import SCALE, WHITE_LUMINANCE, picture
    from .sky.panorama import write_panorama, write_spectral
    from .sky.simulation import simulate
    from .spectra.grid import WAVELENGTHS
    from .spectra.sensitivities import observer

    if not (options.out or options.spectral):
        raise InputError("sky", "nowhere to write to", "give --out SKY.exr or --spectral FILE.exr")
    if not 8 <= options.width <= 8192:
        raise InputError("--width", f"{options.width} pixels", "give 8 to 8192")
    elevation, azimuth = _sun(options)
    orders = options.orders
    if orders != "all" and not orders.isdecimal():
        raise InputError("--orders", f"'{orders}'", "give 1, 2, … or all")
    sky = simulate(
        elevation,
        _atmosphere(options),
        orders=None if orders == "all" else int(orders),
        quality=options.quality,
        seed=options.seed,
        progress=sys.stderr.isatty(),
    )
    view = options.width // 2, azimuth, options.sun_disc
    if options.out:
        attributes = {
            "whiteLuminance": WHITE_LUMINANCE,
            "comments": f"clear sky, sun elevation {elevation:.4g}, azimuth {azimuth:.4g} degrees",
        }
        write_panorama(options.out, picture(sky, *view, observer() * SCALE), attributes)
    if options.spectral:
        write_spectral(options.spectral, picture(sky, *view), WAVELENGTHS)
    error = (sky.irradiance_error() / sky.irradiance()).max()
    print(
        f"sun at {elevation:.2f}°, azimuth {azimuth:.2f}°; "
        f"standard error of the irradiance at most {100 * error:.2f} % at any wavelength"
    )


def _sun(options: argparse.Namespace) -> tuple[float, float]:
    """Return where the sun stands: given, or by date and place."""
    given = options.sun_elevation is not None
    if given == (options.date is not None):
        cure = "give either --sun-elevation or --date with --latitude and --longitude"
        raise InputError("sky", "where is the sun?", cure)
    if given:
        return options.sun_elevation, 180.0 if options.sun_azimuth is None else options.sun_azimuth
    from .sky.sun_position import sun_position

    if options.latitude is None or options.longitude is None:
        raise InputError("--date", "no place", "give --latitude and --longitude too")
    elevation, azimuth = sun_position(
        options.date, options.time, options.latitude, options.longitude, options.timezone
    )
    return elevation, azimuth if options.sun_azimuth is None else options.sun_azimuth


def _atmosphere(options: argparse.Namespace) -> Any:
    """Return the air over the ground that the options describe."""
    from dataclasses import replace

    from .sky.atmosphere import Atmosphere
    from .sky.simulation import PAPER
    from .spectra.reflectance import read_assigned

    try:
        ground = float(options.ground)
    except ValueError:
        _, ground = read_assigned(options.ground)
    if options.paper:
        return replace(PAPER, ground=ground)
    haze = 0.05 if options.haze is None else options.haze
    if options.turbidity is not None:
        haze = options.turbidity * 0.55**-options.angstrom
    return Atmosphere(
        haze=haze,
        angstrom=options.angstrom,
        ozone=options.ozone,
        water=options.water,
        ground=ground,
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


def _evaluate(options: argparse.Namespace) -> None:
    from pathlib import Path

    import numpy as np

    from .spectra.light import read_light
    from .spectra.reflectance import read_reflectances
    from .transfer.evaluation import colorchecker
    from .transfer.report import report_day, report_light

    bases = options.basis or ["rayleigh", "daylight", "atmosphere"]
    names, values = colorchecker()
    if options.reflectances:
        read = [read_reflectances(file, options.unit) for file in options.reflectances]
        names = tuple(name for one in read for name in one.names)
        values = np.concatenate([one.values for one in read])
    if options.daylight:
        result = report_light(
            Path(options.out),
            read_light(options.daylight),
            values,
            bases,
            sun_elevation=options.sun_elevation,
            camera=options.camera,
        )
        groups = {options.daylight: result["methods"]}
    else:
        place = (options.date, options.latitude, options.longitude, options.timezone)
        result = report_day(
            Path(options.out),
            place,
            (names, values),
            bases,
            step=options.step,
            progress=sys.stderr.isatty(),
        )
        groups = {air: sky["methods"] for air, sky in result["skies"].items()}
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
        return
    for title, methods in groups.items():
        print(f"{title:34} CIEDE2000  mean    p95     max   relative  mean    p95     max")
        for method in methods:
            numbers = [
                " ".join(f"{method[measure][key]:7.{digits}f}" for key in ("mean", "p95", "max"))
                for measure, digits in (("delta_E", 3), ("relative_error", 4))
            ]
            print(f"  {method['method']:38} {numbers[0]}           {numbers[1]}")
    for path in result["files"]:
        print(path)


def _render(options: argparse.Namespace) -> None:
    from .scene import files, render

    scene = files.open_scene(options.scene)
    for path in render.render(scene, options.out, options.camera, options.engine):
        print(path)
