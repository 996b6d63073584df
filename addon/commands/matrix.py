"""`matrix`: reflectance CSVs to 3x3 matrices."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

from .arguments import Commands
from .under_sky import add_sky_options, choose


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("matrix", help="convert reflectance CSVs to 3x3 matrices")
    parser.add_argument(
        "files", nargs="+", metavar="FILE.csv", help="CSV with one or more materials"
    )
    add_sky_options(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print the matrices of all materials, and under a sky their predicted errors."""
    import numpy as np

    from ..spectra.reflectance import read_reflectances

    files = [read_reflectances(file, options.unit) for file in options.files]
    found = choose(options, np.concatenate([read.values for read in files]))
    choice = found.choice
    materials: list[dict[str, Any]] = []
    for file, read in zip(options.files, files, strict=True):
        for name in read.names:
            k = len(materials)
            material: dict[str, Any] = {
                "name": name,
                "matrix": choice.matrices[k].tolist(),
                "file": str(file),
                "unit": read.unit,
                "notes": list(read.notes),
                "model": choice.models[k],
            }
            materials.append(material | choice.report(k, name))
    result = {
        "materials": materials,
        "basis": choice.transfer.basis,
        "space": options.space,
        "camera": options.camera,
        "white": found.white,
        "sun_elevation": found.sun_elevation,
        "sky": options.sky,
        "sky_rgb": options.sky_rgb,
        "tolerance": choice.tolerance,
        "notes": found.notes,
    }
    if options.json:
        print(json.dumps(result, indent=1, allow_nan=False))
        return
    for material in materials:
        print(material["name"])
        for row in material["matrix"]:
            print("  " + " ".join(f"{value:10.6f}" for value in row))
        if "line" in material:
            print(f"  {material['line']}")
    of_files = dict.fromkeys(f"{m['file']}: {note}" for m in materials for note in m["notes"])
    for note in (*of_files, *found.notes):
        print(note, file=sys.stderr)
