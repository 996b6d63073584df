"""`animate`: the sky of a blend file, and all that it lights, through a day or a year."""

from __future__ import annotations

import argparse
from pathlib import Path

from .arguments import Commands, add_north, add_place, place_of
from .outputs import output
from .progress_bar import run_with_bar


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "animate", help="let the sky of a .blend move through a day, by keyframes and drivers"
    )
    parser.add_argument("scene", metavar="SCENE.blend", help="with spectral materials, or without")
    parser.add_argument("--date", required=True, metavar="YYYY-MM-DD")
    parser.add_argument(
        "--from", dest="first", default="06:00", metavar="HH:MM", help="default: 06:00"
    )
    parser.add_argument(
        "--to", dest="last", default="20:00", metavar="HH:MM", help="up to 24:00; default: 20:00"
    )
    parser.add_argument(
        "--year",
        metavar="HH:MM",
        help="move through the days of the date's year instead, each at this time, winter's",
    )
    parser.add_argument("--frames", type=int, default=240, metavar="N", help="default: 240")
    add_place(parser)
    add_north(parser)
    parser.add_argument("--haze", type=float, default=0.05, help="as of sky; default 0.05")
    parser.add_argument("--ozone", type=float, default=300.0, metavar="DU", help="as of sky")
    parser.add_argument("--ground", type=float, default=0.2, help="its reflectance; default 0.2")
    parser.add_argument("--out", required=True, type=output(".blend"), metavar="OUT.blend")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Write the blend file, and print what was made and what it leaves."""
    from ..scene import use_cases
    from ..scene.day.animate import YEAR, Day
    from ..scene.files import blend_file
    from ..scene.world.settings import Settings, stored
    from ..scene.world.simulated_sky import SkyPlace

    first, last = (options.year, YEAR) if options.year else (options.first, options.last)
    where = place_of(options)
    place = SkyPlace(
        options.date,
        first,
        where.timezone,
        where.latitude,
        where.longitude,
        options.north,
        options.haze,
        options.ozone,
        options.ground,
    )
    day = Day(place, first, last, options.frames)
    day.course()
    scene = blend_file.open_scene(options.scene)
    blend_file.check_unread(Path(options.out))
    settings = stored(scene.world) or Settings()
    found = run_with_bar(use_cases.animate(scene, day, settings), "animate")
    blend_file.save(options.out)
    for line in (*found.skipped, *found.lines):
        print(line)
