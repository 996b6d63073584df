"""`render`: a blend file, without a window, as colors or as an amount of light, EXR and PNG."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from ..choices import ENGINES, QUANTITIES, described
from ..errors import InputError, parameter
from .arguments import Commands
from .outputs import output


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "render", help="render a .blend to an EXR and a PNG, without a window"
    )
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument("--out", required=True, type=output(".exr", ".png"), metavar="FILE.exr")
    parser.add_argument("--camera", metavar="NAME", help="default: the scene's")
    parser.add_argument("--engine", choices=tuple(ENGINES), help="default: the scene's")
    parser.add_argument(
        "--quantity",
        choices=tuple(QUANTITIES),
        help="amount of light instead of colors: the PNG shows it in false colors, the EXR holds "
        f"it in its channel Y. {described(QUANTITIES)}",
    )
    parser.add_argument(
        "--range",
        type=_two,
        metavar="LOW,HIGH",
        help="of --quantity: what the first and the last color stand for; default: chosen",
    )
    parser.add_argument(
        "--lux",
        type=float,
        help="of --quantity: illuminance of sky and sun on the level in the open, measured",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Render, and print the paths of the pictures."""
    from ..scene.files import blend_file
    from ..scene.materials import rgb_comparison
    from ..scene.output import render

    for name in ("range", "lux"):
        if getattr(options, name) is not None and options.quantity is None:
            raise InputError(parameter(name), "is of --quantity", "give that, or leave it out")
    scene = blend_file.open_scene(options.scene)
    for path in (Path(options.out), Path(options.out).with_suffix(".png")):
        blend_file.check_unread(path)
    if found := rgb_comparison.shown_now():
        names = ", ".join(material.name for material in found[:5]) + (" …" if found[5:] else "")
        line = f"{names}: rendered as RGB × RGB, because the file was saved in comparison mode"
        print(f"WARNING: {line}; make them spectral again with apply", file=sys.stderr)
    if options.quantity is not None:
        _of_light(scene, options)
        return
    for path in render.render(scene, options.out, options.camera, options.engine):
        print(path)


def _of_light(scene: Any, options: argparse.Namespace) -> None:
    """Write an amount of light, as numbers and in false colors."""
    from ..pictures import false_colour
    from ..pictures.png_file import write_png
    from ..scene import use_cases
    from ..scene.meter.calibration import Told
    from ..scene.output import render
    from ..scene.world.settings import Settings, stored
    from ..sky.exr_writer import write_exr
    from ..spectra.photometry import quantity
    from .progress_bar import run_with_bar

    camera = render.find_camera(scene, options.camera)
    told = None if options.lux is None else Told(lux=options.lux)
    settings = stored(scene.world) or Settings()
    work = use_cases.picture_of_light(
        scene, settings, options.quantity, camera, options.engine, told
    )
    amounts, known = run_with_bar(work, "measure")
    unit = quantity(options.quantity).unit if known.absolute else "relative"
    scale = false_colour.scale_of(amounts)
    if options.range is not None:
        low, high = options.range
        wide = low > 0.0 and high > false_colour.WIDE * low
        scale = false_colour.Scale(low, high, wide)
    label = QUANTITIES[options.quantity].label
    exr = Path(options.out).resolve()
    write_exr(exr, {"Y": amounts}, {"quantity": options.quantity, "unit": unit})
    write_png(exr.with_suffix(".png"), false_colour.false_colour(amounts, label, unit, scale=scale))
    print(known.line, file=sys.stderr)
    for path in (exr, exr.with_suffix(".png")):
        print(path)


def _two(text: str) -> tuple[float, float]:
    """Read LOW,HIGH."""
    try:
        low, high = (float(each) for each in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not two numbers LOW,HIGH") from None
    if not 0.0 <= low < high < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}': LOW is 0 or more and below HIGH")
    return low, high
