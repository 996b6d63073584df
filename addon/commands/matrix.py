"""`matrix`: reflectance CSVs to 3x3 matrices."""

from __future__ import annotations

import argparse
import json
import sys
from functools import partial
from typing import Any

from ..errors import InputError
from .arguments import add_matrix_options, basis_name, three


def add(commands: Any) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("matrix", help="reflectance CSVs to 3x3 matrices")
    parser.add_argument("files", nargs="+", metavar="FILE.csv", help="one or more materials each")
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--sky", metavar="HDRI", help="predict the errors under this sky")
    source.add_argument(
        "--sky-rgb", type=three, metavar="R,G,B", help="the skylight's colour, in the space"
    )
    add_matrix_options(parser)
    parser.add_argument("--space", default="Linear Rec.709", help="working space of the scene")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print the matrices of all materials, and under a sky their predicted errors."""
    import numpy as np

    from ..sky.light import analyse
    from ..sky.panorama import read_panorama
    from ..spectra.reflectance import read_reflectances
    from ..spectra.sensitivities import camera, observer
    from ..spectra.working_spaces import rec709_to_working
    from ..transfer.choice import choose_with, doubt
    from ..transfer.matrices import transfer
    from ..transfer.white import AUTO, estimate_white, settle_white

    lights, light, notes, doubted = None, None, [], ""
    white, elevation = options.white, options.sun_elevation
    if options.sky_rgb is not None:
        if not np.isfinite(options.sky_rgb).all():
            raise InputError("--sky-rgb", "is not finite", "give three numbers R,G,B")
        lights = np.array([options.sky_rgb])
    elif options.sky is not None:
        S_in = observer() if options.camera is None else camera(options.camera)
        if isinstance(white, tuple):
            S_in = S_in / np.array(white)[:, None]
        light = analyse(read_panorama(options.sky), S_in=S_in)
        elevation = light.sun_elevation(elevation)
        lights = light.faces
        if options.camera is None:
            lights = lights @ rec709_to_working(options.space).T
    mapping = partial(
        transfer,
        camera=options.camera,
        space=options.space,
        sun_elevation=elevation,
        sky_rgb=lights,
    )
    if light is not None:
        to_working = None if options.camera else rec709_to_working(options.space)
        white, note = settle_white(
            white, lambda: estimate_white(light, mapping("rayleigh"), elevation, to_working)
        )
        notes = [*light.notes, note] if note else light.notes
        doubted = doubt(light, tinted=bool(note) and options.white is None)
    elif white == AUTO:
        raise InputError("--white auto", "there is no sky to estimate it from", "give --sky HDRI")
    mapping = partial(mapping, white=white)
    files = [read_reflectances(file, options.unit) for file in options.files]
    choice = choose_with(
        mapping,
        basis_name(options),
        np.concatenate([read.values for read in files]),
        lights,
        elevation,
        options.tolerance,
        light.outside.foreign if light else 0.0,
        doubted,
    )
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
        "white": white,
        "sun_elevation": elevation,
        "sky": options.sky,
        "sky_rgb": options.sky_rgb,
        "tolerance": choice.tolerance,
        "notes": notes,
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
    for note in (*of_files, *notes):
        print(note, file=sys.stderr)
