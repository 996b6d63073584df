"""`irradiance`: what an HDRI gives faces, without its sun."""

from __future__ import annotations

import argparse
import json

from ..errors import InputError
from .arguments import Commands, white_or_auto
from .outputs import output


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "irradiance", help="compute the irradiance of an HDRI, without its sun"
    )
    parser.add_argument("sky", metavar="HDRI")
    parser.add_argument(
        "--out",
        type=output(".exr"),
        required=True,
        metavar="E.exr",
        help="lat-long image of irradiance / π over normals",
    )
    parser.add_argument("--width", type=int, default=64, help="width of E.exr in pixels")
    parser.add_argument("--degree", type=int, choices=range(7), help="degree of the polynomial")
    parser.add_argument(
        "--white", type=white_or_auto, metavar="R,G,B|auto", help="undo white balance"
    )
    parser.add_argument(
        "--map",
        type=output(".png"),
        metavar="MAP.png",
        help="map of the sky: sun yellow, ground gray, light that is not skylight magenta",
    )
    parser.add_argument("--json", action="store_true", help="print coefficients and errors")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Write the irradiance map; print the fit."""
    import numpy as np

    from ..scene.files.exr_decoder import read_sky
    from ..sky.irradiance import irradiance_map
    from ..sky.light import analyse
    from ..sky.panorama import write_panorama
    from ..transfer.matrices import transfer
    from ..transfer.white import estimate_white, settle_white

    if options.width < 4 or options.width % 2:
        raise InputError("--width", f"{options.width} pixels", "give an even number of at least 4")
    panorama = read_sky(options.sky)
    light = analyse(panorama, options.degree)
    white, note = settle_white(options.white, lambda: estimate_white(light, transfer()))
    if white is not None:
        panorama.rgb[...] *= np.array(white, panorama.rgb.dtype)
        light = analyse(panorama, options.degree)
    write_panorama(options.out, irradiance_map(light.sky, options.width))
    if options.map is not None:
        from ..pictures.png_file import write_png
        from ..pictures.sky_map import marked

        write_png(options.map, marked(light.outside, panorama.rgb))
    report = light.report()
    notes = [*report["notes"], note] if note else report["notes"]
    if options.json:
        result = {"sky": options.sky, "white": white, **report, "notes": notes}
        print(json.dumps(result, indent=1))
        return
    fit = light.fit
    print(f"degree {fit.degree} largest error {100 * fit.errors[fit.degree].worst:.2f} %")
    for line in (*notes, light.caption):
        print(line)
