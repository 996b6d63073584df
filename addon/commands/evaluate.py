"""`evaluate`: errors over a day, under measured light, or under a sky that knows its spectra."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from ..choices import BASES, BASIS
from ..errors import InputError
from .arguments import Commands, add_unit, chosen_reflectances, folder, positive
from .outputs import output_folder


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "evaluate", help="errors over a day, under measured light or a known sky"
    )
    parser.add_argument(
        "--out",
        type=output_folder("table_*", "figure*", "daylight.*", "predicted.json"),
        metavar="DIR",
        help="folder for figures and tables",
    )
    parser.add_argument(
        "--daylight",
        nargs="+",
        metavar="FILE.csv",
        help="measured spectra of light; default: a simulated day",
    )
    parser.add_argument(
        "--sky",
        metavar="SKY",
        help="a sky that holds its own spectra, as `sky` writes it, a spectral .exr or an .hsr",
    )
    parser.add_argument(
        "--predicted",
        action="store_true",
        help="check predicted errors under that light: each column is a sky, or all columns "
        "SKY@FACE are one sky; one file per site",
    )
    parser.add_argument(
        "--tolerance",
        type=positive,
        default=0.5,
        metavar="CIEDE2000",
        help="tolerance of the models that --predicted chooses; default 0.5",
    )
    parser.add_argument(
        "--sun-elevation",
        type=_numbers,
        metavar="DEG[,DEG…]",
        help="sun elevations of the measured light in degrees: one for all spectra or one for each",
    )
    parser.add_argument(
        "--camera", metavar="NAME|FILE", help="camera that records the measured light"
    )
    parser.add_argument(
        "--reflectances", nargs="+", metavar="FILE.csv", help="default: the ColorChecker"
    )
    add_unit(parser)
    parser.add_argument("--basis", nargs="+", metavar="NAME", help=f"default: {' '.join(BASES)}")
    parser.add_argument(
        "--date", default="2025-03-20", metavar="YYYY-MM-DD", help="date of the day"
    )
    parser.add_argument(
        "--latitude", type=float, default=35.68, metavar="DEG", help="in degrees; default: Tokyo"
    )
    parser.add_argument(
        "--longitude", type=float, default=139.77, metavar="DEG", help="default: Tokyo"
    )
    parser.add_argument("--timezone", default="+9", metavar="ZONE", help="default: +9, Tokyo")
    parser.add_argument(
        "--step", type=int, default=30, metavar="MINUTES", help="minutes between skies"
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    parser.set_defaults(run=run)


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not DEG or DEG,DEG,…") from None


def run(options: argparse.Namespace) -> None:
    """Write figures and tables; print the summary."""
    from ..evaluation.charts import new_figure
    from ..evaluation.report import report_day, report_light
    from ..spectra.light import read_light

    if options.sky is not None:
        _print_sky(options)
        return
    if not options.predicted:
        # Before colour-science is imported, which puts a dummy where matplotlib is missing.
        new_figure(1.0, 1.0)
    bases = options.basis or list(BASES)
    names, values = chosen_reflectances(options)
    if options.predicted:
        _print_predicted(options, values)
        return
    if options.out is None:
        raise InputError("--out", "is missing", "set a folder for figures and tables")
    out = folder(options.out)
    if options.daylight:
        if len(options.daylight) > 1:
            raise InputError("--daylight", "more than one file", "give one, or --predicted")
        result = report_light(
            out,
            read_light(options.daylight[0]),
            values,
            bases,
            sun_elevation=options.sun_elevation,
            camera=options.camera,
        )
        groups = {options.daylight[0]: result["methods"]}
    else:
        place = (options.date, options.latitude, options.longitude, options.timezone)
        result = report_day(
            out,
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
    _print(groups)
    for path in result["files"]:
        print(path)


def _print(groups: Mapping[str, Sequence[Mapping[str, Any]]]) -> None:
    """Print the summaries of methods under titles."""
    for title, methods in groups.items():
        print(f"{title:34} CIEDE2000  mean    p95     max   relative  mean    p95     max")
        for method in methods:
            numbers = [
                " ".join(f"{method[measure][key]:7.{digits}f}" for key in ("mean", "p95", "max"))
                for measure, digits in (("delta_E", 3), ("relative_error", 4))
            ]
            print(f"  {method['method']:38} {numbers[0]}           {numbers[1]}")


def _print_sky(options: argparse.Namespace) -> None:
    """Print the errors of every method under one sky."""
    from ..evaluation.known_sky import evaluate_sky
    from ..scene.files.exr_decoder import read_sky
    from ..sky.light import analyse

    for name in ("daylight", "predicted", "camera", "sun_elevation", "out"):
        if getattr(options, name):
            option = f"--{name.replace('_', '-')}"
            raise InputError(option, "does not go with --sky", "leave one of the two out")
    _, values = chosen_reflectances(options)
    errors = evaluate_sky(analyse(read_sky(options.sky)), values, options.basis or list(BASES))
    methods = [method.summary() for method in errors]
    if options.json:
        print(json.dumps({"sky": options.sky, "methods": methods}, indent=1, allow_nan=False))
    else:
        _print({options.sky: methods})


def _print_predicted(options: argparse.Namespace, rho: Any) -> None:
    """Print how well predictions hold, of each site and of all together."""
    from pathlib import Path

    from ..evaluation.calibration import calibrate, joined
    from ..spectra.light import read_light
    from ..whole_files import write_json

    if not options.daylight:
        raise InputError("--predicted", "there is no measured light", "give --daylight FILE.csv")
    if len(options.basis or []) > 1:
        raise InputError("--basis", "more than one with --predicted", "give one")
    basis = (options.basis or [BASIS])[0]
    out = None if options.out is None else folder(options.out)
    sites = {}
    for file in options.daylight:
        light = read_light(file)
        sites[file] = calibrate(
            light.values,
            rho,
            options.sun_elevation,
            basis=basis,
            camera=options.camera,
            skies=_skies(light.names),
            tolerance=options.tolerance,
        )
    result = {
        "basis": basis,
        "sites": {file: site.report() for file, site in sites.items()},
        "all": joined(sites.values()).report(),
    }
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        write_json(out / "predicted.json", result)
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
        return
    print(f"{'predicted errors':40}   cases covered   sharp    rank unknown    kept")
    for name, found in (*result["sites"].items(), ("all", result["all"])):
        keys = ("covered", "sharpness", "rank_correlation", "unknown", "tolerance_kept")
        figures = ("-" if found[key] is None else f"{found[key]:.3f}" for key in keys)
        numbers = " ".join(f"{figure:>7}" for figure in figures)
        print(f"  {Path(name).name:38} {found['cases']:7} {numbers}")


def _skies(names: tuple[str, ...]) -> list[str]:
    """Columns ``SKY@FACE`` are faces of one sky, others skies of their own."""
    return [name.partition("@")[0] if "@" in name else f"@{k}" for k, name in enumerate(names)]
