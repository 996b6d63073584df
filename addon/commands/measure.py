"""`measure`: lux, luminance, color temperature and melanopic light at places of a blend file."""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, parameter
from .arguments import Commands, three
from .outputs import output

if TYPE_CHECKING:
    from ..scene.meter.places import Places


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "measure", help="measure the light at places of a .blend: lux, melanopic lux, kelvin"
    )
    # Coordinates such as -1,2,0 are values, not options.
    parser._negative_number_matcher = re.compile(r"^-[\d.][\d.,eE+-]*$")
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument(
        "--at", type=three, action="append", metavar="X,Y,Z", help="place, in Blender units"
    )
    parser.add_argument(
        "--normal",
        type=three,
        action="append",
        metavar="X,Y,Z",
        help="where the meter looks, one for all or one for each --at; default 0,0,1: up",
    )
    parser.add_argument(
        "--camera",
        nargs="?",
        const="",
        metavar="NAME",
        help="vertical light at the eye of a camera; default: the scene's",
    )
    parser.add_argument(
        "--grid",
        metavar="FLOOR|X0,Y0,X1,Y1",
        help="many meters that look up: over an object's faces, or over a rectangle",
    )
    parser.add_argument(
        "--height",
        type=float,
        metavar="M",
        help="of --grid: meters over the floor, default 0.85; of a rectangle its z",
    )
    parser.add_argument(
        "--spacing", type=float, metavar="M", help="of --grid: default as EN 12464-1 has it"
    )
    parser.add_argument(
        "--border", type=float, metavar="M", help="of --grid: left out along walls; default 0.5"
    )
    parser.add_argument(
        "--report",
        type=output(".html", ".csv"),
        metavar="FILE.html",
        help="of --grid: a page with maps, uniformity and daylight factors, and a CSV beside it",
    )
    parser.add_argument(
        "--threshold", type=float, metavar="LUX", help="of --report: enough light; default 300"
    )
    known = parser.add_mutually_exclusive_group()
    known.add_argument(
        "--lux", type=float, help="illuminance of sky and sun on the level in the open, measured"
    )
    known.add_argument(
        "--spot",
        type=three,
        metavar="CD,AZIMUTH,ELEVATION",
        help="luminance of the sky in cd/m², measured in a direction in degrees, azimuth from +y "
        "clockwise",
    )
    known.add_argument(
        "--white-luminance", type=float, metavar="CD", help="cd/m² of the HDRI's RGB 1,1,1"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print JSON, the spectra in it")
    form.add_argument("--csv", action="store_true", help="print a table")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Measure, and print what was read."""
    from ..scene import use_cases
    from ..scene.files import blend_file
    from ..scene.meter import room_page
    from ..scene.meter.calibration import Told
    from ..scene.world.settings import Settings, stored
    from .progress_bar import run_with_bar

    _check(options)
    scene = blend_file.open_scene(options.scene)
    places = _places(options, scene)
    told = None
    if any(each is not None for each in (options.lux, options.spot, options.white_luminance)):
        told = Told(options.lux, options.spot, options.white_luminance)
    settings = stored(scene.world) or Settings()
    if options.report:
        survey = use_cases.surveying(scene, settings, places, told, options.threshold)
        room = run_with_bar(survey, "measure")
        found, name = room.measured, f"{Path(options.scene).stem}: {options.grid}"
        for path in room_page.write(Path(options.report), room, name):
            print(path)
    else:
        found = run_with_bar(use_cases.measuring(scene, settings, places, told), "measure")
    if options.json:
        print(json.dumps(found.plain()))
    elif options.csv:
        print(room_page.table(found), end="")
        print(found.calibration.line, file=sys.stderr)
    elif not options.report:
        print("\n".join(found.lines()))
    if inside := int(found.inside.sum()):
        print(f"WARNING: {inside} place(s) lie inside something solid", file=sys.stderr)


def _check(options: argparse.Namespace) -> None:
    """Raise InputError for options that do not go together."""
    ways = [options.at is not None, options.camera is not None, options.grid is not None]
    if sum(ways) != 1:
        raise InputError("measure", "where is not told", "give one of --at, --camera and --grid")
    if options.normal is not None:
        if options.at is None:
            raise InputError(parameter("normal"), "is of --at", "give --at, or leave it out")
        if len(options.normal) not in (1, len(options.at)):
            what = f"{len(options.normal)} for {len(options.at)} places"
            raise InputError(parameter("normal"), what, "give one for all, or one for each --at")
    for name in ("height", "spacing", "border", "report"):
        if getattr(options, name) is not None and options.grid is None:
            raise InputError(parameter(name), "is of a grid", "give --grid, or leave it out")
    if options.threshold is not None and options.report is None:
        raise InputError(parameter("threshold"), "is of a report", "give --report too")


def _places(options: argparse.Namespace, scene: Any) -> Places:
    """Return where the options say to measure."""
    from ..scene.meter import places

    if options.at is not None:
        normals = options.normal or [(0.0, 0.0, 1.0)]
        return places.single(options.at, normals * (len(options.at) // len(normals)))
    if options.camera is not None:
        return places.eye(places.camera(scene, options.camera))
    meter = places.units_in_a_meter(scene)
    numbers = options.grid.split(",")
    if len(numbers) == 4:
        try:
            corners = [float(each) for each in numbers]
        except ValueError:
            what = f"'{options.grid}' is not four numbers"
            raise InputError(parameter("grid"), what, "give X0,Y0,X1,Y1") from None
        if options.border is not None:
            raise InputError(parameter("border"), "is of a floor", "leave it out")
        if options.height is None:
            raise InputError(parameter("height"), "of the rectangle is not told", "give its z")
        return places.rectangle(corners, options.height * meter, options.spacing, meter)
    floor = scene.objects.get(options.grid)
    if floor is None:
        what = f"there is no object '{options.grid}'"
        raise InputError(parameter("grid"), what, "give an object's name or X0,Y0,X1,Y1")
    height = places.HEIGHT if options.height is None else options.height
    border = places.BORDER if options.border is None else options.border
    for name, value in (("height", height), ("border", border)):
        if not 0.0 <= value < 1e6:
            raise InputError(parameter(name), f"{value:g} m", "give 0 or more")
    return places.over(floor, height, options.spacing, border, meter)
