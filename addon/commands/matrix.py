"""`matrix`: reflectance CSVs to 3x3 matrices."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

from .arguments import add_matrix_options, three


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
    from ..spectra.working_spaces import rec709_to_working
    from ..transfer.matrices import transfer
    from ..transfer.prediction import predict

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
