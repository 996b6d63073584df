"""`library`: what folders of reflectance files hold, to search, sort and look at."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from typing import Any

from ..choices import ORDERS, default
from ..errors import InputError
from .arguments import Commands, three
from .outputs import output
from .progress_bar import run_with_bar
from .under_sky import add_sky_options, choose

TOLD = 20
"""Problems that are told without being asked: a published library has hundreds in infrared."""


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("library", help="list, search and draw reflectances in folders")
    parser.add_argument(
        "folders",
        nargs="*",
        metavar="FOLDER",
        help="default: the built-in building materials and color checkers",
    )
    parser.add_argument(
        "--search",
        default="",
        metavar="TEXT",
        help="only reflectances with all these words in name or source",
    )
    parser.add_argument("--sort", default=default(ORDERS), metavar="|".join(ORDERS))
    parser.add_argument(
        "--sheet",
        type=output(".png"),
        metavar="PICTURE.png",
        help="draw swatches of the matches",
    )
    parser.add_argument(
        "--near",
        metavar="R,G,B",
        type=three,
        help="the ten nearest to a linear base color in --space, with their ΔE",
    )
    parser.add_argument(
        "--for",
        dest="material",
        default="",
        metavar="NAME",
        help="material name that --near also compares",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_sky_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print what is in the folders, and what of it cannot be used."""
    import numpy as np

    from ..spectra import library
    from ..transfer.nearest import nearest
    from ..transfer.prediction import rgb_albedo
    from ..transfer.swatches import under_sky

    if options.folders:
        whole = run_with_bar(library.index(options.folders), "read", delay=0.5)
    else:
        whole = library.built_in()
    wanted = set(whole.search(options.search))
    found = whole.only([k for k in whole.order(options.sort) if k in wanted])
    near = None
    if options.near is not None:
        near = nearest(found, options.near, options.material, space=options.space)
        found = found.only([one.number for one in near])
    sky = None
    if options.sky is not None or options.sky_rgb is not None:
        sky = choose(options, np.empty((0, 81)))
    if options.sheet is not None:
        _draw(options, found, sky)
    if options.json:
        under = None
        if sky is not None and sky.lights is not None:
            under = under_sky(sky.choice.transfer, found.values, sky.lights[0])
        record = {
            "spectra": _records(found, rgb_albedo(found.values, options.space), under),
            "problems": list(found.problems),
            "unused": found.unused,
            "others": found.others,
            "sky": options.sky,
            "space": options.space,
            "notes": sky.notes if sky is not None else [],
        }
        for spectrum, one in zip(record["spectra"], near or (), strict=False):
            spectrum["delta_E"] = one.delta_E
        print(json.dumps(record, indent=1, allow_nan=False))
        return
    for k, (L, a, b) in enumerate(found.Lab):
        kind = f"  {found.classes[k]}" if found.classes[k] else ""
        off = "" if near is None else f"  ΔE {near[k].delta_E:5.1f}"
        print(f"{L:6.1f} {a:6.1f} {b:6.1f}{off}  {found.paths[k]}:{found.names[k]}{kind}")
    for kind, count in Counter(map(str, found.kinds)).most_common():
        print(f"{count} as {kind}", file=sys.stderr)
    for problem in found.problems[:TOLD]:
        print(problem, file=sys.stderr)
    others = f", {found.others} files hold other data" if found.others else ""
    unused = f", {found.unused} cannot be used" if found.unused else ""
    unused += " (--json lists all)" if len(found.problems) > TOLD else ""
    print(f"{len(found)} of {len(whole)} spectra{unused}{others}", file=sys.stderr)


def _records(found: Any, d65: Any, under: Any) -> list[dict[str, Any]]:
    """Return what is known of each reflectance, ready for JSON."""
    records = [
        {
            "name": found.names[k],
            "class": found.classes[k],
            "source": found.sources[k],
            "format": found.kinds[k].format,
            "quantity": found.kinds[k].quantity,
            "unit": found.kinds[k].unit,
            "file": found.paths[k],
            "Lab": found.Lab[k].tolist(),
            "rgb_d65": d65[k].tolist(),
            "hash": found.hashes[k],
        }
        for k in range(len(found))
    ]
    for record, rgb in zip(records, () if under is None else under, strict=False):
        record["rgb_sky"] = rgb.tolist()
    return records


def _draw(options: argparse.Namespace, found: Any, sky: Any) -> None:
    """Write the sheet of swatches, as many as one holds."""
    import numpy as np

    from ..pictures.png_file import write_png
    from ..pictures.swatches import MOST, swatches
    from ..spectra.working_spaces import rec709_to_working
    from ..transfer.prediction import rgb_albedo
    from ..transfer.swatches import beside

    if not len(found):
        raise InputError("--search", "matches no reflectance", "use fewer words")
    if len(found) > MOST:
        print(f"{options.sheet}: the first {MOST} of {len(found)}", file=sys.stderr)
    shown = found.only(range(min(len(found), MOST)))
    left, right = None, rgb_albedo(shown.values)
    if sky is not None:
        to_rec709 = np.linalg.inv(rec709_to_working(options.space)).T
        halves = beside(sky.choice.transfer, shown.values, sky.lights[0])
        left, right = (half @ to_rec709 for half in halves)
    write_png(options.sheet, swatches(shown.names, left, right))
