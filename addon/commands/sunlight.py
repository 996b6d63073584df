"""`sunlight`: hours of sun and sky view factors on the surfaces of a blend file."""

from __future__ import annotations

import argparse
from pathlib import Path

from .arguments import Commands, add_north, add_place, place_of
from .outputs import output
from .progress_bar import run_with_bar


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "sunlight", help="hours of sun and sky view factors on the surfaces of a .blend"
    )
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument("--date", required=True, metavar="YYYY-MM-DD")
    parser.add_argument(
        "--from", dest="first", default="00:00", metavar="HH:MM", help="default: 00:00"
    )
    parser.add_argument(
        "--to", dest="last", default="24:00", metavar="HH:MM", help="default: 24:00"
    )
    parser.add_argument(
        "--minutes", type=float, default=5.0, metavar="N", help="a sun every so many; default 5"
    )
    add_place(parser)
    add_north(parser)
    parser.add_argument(
        "--csv", type=output(".csv"), metavar="FILE.csv", help="write a row for each object"
    )
    parser.add_argument(
        "--points", type=output(".csv"), metavar="FILE.csv", help="write a row for each place"
    )
    for name, what in (("png", "hours of sun"), ("sky-view", "sky view factors")):
        parser.add_argument(
            f"--{name}",
            type=output(".png"),
            metavar="FILE.png",
            help=f"draw {what} as the scene's camera sees them, with a legend",
        )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Find out, write what is asked for, and print a summary."""
    from ..errors import InputError
    from ..scene import use_cases
    from ..scene.files import blend_file
    from ..scene.meter.exposure import SunTimes
    from ..whole_files import write_text

    where = place_of(options)
    times = SunTimes(
        options.date,
        options.first,
        options.last,
        where.timezone,
        where.latitude,
        where.longitude,
        options.north,
        options.minutes,
    )
    times.suns()
    scene = blend_file.open_scene(options.scene)
    pictures = {"sun_hours": options.png, "sky_view": options.sky_view}
    if any(pictures.values()) and scene.camera is None:
        raise InputError(options.scene, "has no camera", "omit --png and --sky-view, or add one")
    found = run_with_bar(use_cases.exposure(times), "sunlight")
    if options.csv:
        write_text(Path(options.csv), found.table())
    if options.points:
        write_text(Path(options.points), found.points())
    for name, path in pictures.items():
        if path:
            found.picture(name, scene.camera, Path(path))
    for line in found.lines:
        print(line)
