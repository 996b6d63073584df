"""`chart`: accuracy against speed, of every method."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from .arguments import Commands, add_unit, chosen_reflectances, folder
from .outputs import output_folder

if TYPE_CHECKING:
    from ..evaluation.methods import Sky


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("chart", help="chart accuracy against speed for all methods")
    parser.add_argument(
        "--out",
        required=True,
        type=output_folder("chart.*", "eevee.csv"),
        metavar="DIR",
        help="folder for the chart and its tables",
    )
    parser.add_argument(
        "--skies",
        nargs="+",
        type=float,
        metavar="DEG",
        help="sun elevations in degrees; default: -4 0 5 15 30 60",
    )
    parser.add_argument(
        "--daylight",
        nargs="+",
        default=[],
        metavar="FILE.csv",
        help="compare materials in the light of these measured spectra, not in that of the skies",
    )
    parser.add_argument(
        "--sun-elevation",
        type=float,
        metavar="DEG",
        help="with --daylight: the sun's elevation; without, methods that need it are left out",
    )
    parser.add_argument(
        "--reflectances",
        nargs="+",
        metavar="FILE.csv",
        help="reflectances; default: the ColorChecker",
    )
    add_unit(parser)
    parser.add_argument(
        "--basis",
        nargs="+",
        default=[],
        metavar="NAME",
        help="additional bases: 'measured FILE.csv'",
    )
    parser.add_argument(
        "--rounds", type=int, default=15, metavar="N", help="repetitions of each timing"
    )
    parser.add_argument(
        "--eevee",
        type=int,
        default=3,
        metavar="N",
        help="rounds of Eevee renders; 0: do not render",
    )
    parser.add_argument(
        "--scenes",
        nargs="*",
        metavar="NAME",
        help="instead chart whole pictures of the examples' scenes: street, courtyard, sun, room, "
        "white, dusk; default: all. Takes hours, and goes on where it was stopped",
    )
    parser.add_argument(
        "--ways",
        nargs="+",
        metavar="PATTERN",
        help="with --scenes: only ways to the picture whose names fit, such as 'Ours*'",
    )
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Measure every method, write picture and tables, and print them."""
    if options.scenes is not None:
        _scenes(options)
        return
    if options.ways:
        raise InputError("--ways", "chooses ways to whole pictures", "add --scenes")
    from ..evaluation.chart import ELEVATIONS, full_skies, rows
    from ..evaluation.chart_report import report_chart
    from ..evaluation.charts import new_figure
    from ..evaluation.methods import METHODS, with_basis

    if not 1 <= options.rounds <= 1000:
        raise InputError("--rounds", f"{options.rounds}", "give 1 to 1000")
    if not 0 <= options.eevee <= 100:
        raise InputError("--eevee", f"{options.eevee} rounds", "give 0 to 100")
    new_figure(1.0, 1.0)  # rather now than after minutes
    out = folder(options.out)
    _, rho = chosen_reflectances(options)
    measured = _measured(options)
    further = (with_basis(name) for name in options.basis)
    methods = {**METHODS, **{method.name: method for method in further}}
    watched = sys.stderr.isatty()
    skies = full_skies(options.skies or ELEVATIONS, watched)
    found = rows(
        skies,
        rho,
        rounds=options.rounds,
        methods=methods,
        measured=measured,
        progress=watched,
    )
    costs, blender = _eevee(options.eevee) if options.eevee else ({}, None)
    told = {} if measured is None else {"measured": f"{len(measured)} measured spectra"}
    result = report_chart(out, found, skies, rho, costs, blender, **told)
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
        return
    for record in result["methods"]:
        print(
            f"{record['kind']:9}{record['method']:34}CIEDE2000 {record['mean_delta_E']:7.3f} mean"
            f"{record['p95_delta_E']:8.3f} p95{record['max_delta_E']:8.3f} max"
            f"{record['ns_per_pixel']:9.2f} ns{'  on the front' if record['on_front'] else ''}"
        )
    for record in result["eevee"]:
        print(f"Eevee    {record['material']:34}{record['ratio']:7.3f} of Diffuse")
    for path in result["files"]:
        print(path)


def _measured(options: argparse.Namespace) -> list[Sky] | None:
    """Read the light that materials are compared in; None for the skies' own."""
    from ..evaluation.chart import measured_skies
    from ..spectra.light import read_light

    if options.daylight:
        spectra = [spectrum for file in options.daylight for spectrum in read_light(file).values]
        return measured_skies(spectra, options.sun_elevation)
    if options.sun_elevation is not None:
        raise InputError("--sun-elevation", "is of measured light", "add --daylight FILE.csv")
    return None


def _scenes(options: argparse.Namespace) -> None:
    """Chart whole pictures, by the examples' program: scenes and referee are no part of ours."""
    program = Path(__file__).resolve().parents[2] / "examples" / "scene_points.py"
    if not program.is_file():
        raise InputError("--scenes", "needs the examples", "run it in a clone of the repository")
    command = [sys.executable, str(program), "--out", options.out, "--scenes", *options.scenes]
    command += ["--ways", *options.ways] if options.ways else []
    if code := subprocess.run(command, check=False).returncode:
        raise InputError("--scenes", f"has ended with exit code {code}", "see the lines above")


def _eevee(rounds: int) -> tuple[dict[str, dict[str, float]], str | None]:
    """Return what a sample of each material costs in Eevee, and Blender's version; where there is
    none, say so."""
    from dataclasses import asdict

    try:
        from ..scene.output import eevee_cost
    except ImportError:
        print("Eevee is not measured: there is no Blender (pip install bpy)", file=sys.stderr)
        return {}, None
    found: dict[str, eevee_cost.Cost] = {}
    for turn, found in enumerate(eevee_cost.sample_costs(rounds=rounds), 1):  # noqa: B007
        if sys.stderr.isatty():
            print(f"Eevee: round {turn} of {rounds}", file=sys.stderr)
    return {name: asdict(one) for name, one in found.items()}, eevee_cost.blender_version()
