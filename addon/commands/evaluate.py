"""`evaluate`: errors over a day, or under measured light."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any


def add(commands: Any) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("evaluate", help="errors over a day, or under measured light")
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
    parser.set_defaults(run=run)


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not DEG or DEG,DEG,…") from None


def run(options: argparse.Namespace) -> None:
    """Write figures and tables; print the summary."""
    from pathlib import Path

    import numpy as np

    from ..spectra.light import read_light
    from ..spectra.reflectance import read_reflectances
    from ..transfer.evaluation import colorchecker
    from ..transfer.report import report_day, report_light

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
