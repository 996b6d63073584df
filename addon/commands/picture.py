"""`picture`: what a material or a sky is, and what is expected of it, to look at."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..errors import InputError
from .arguments import Commands
from .outputs import output
from .under_sky import UnderSky, add_sky_options, choose


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("picture", help="draw reflectance, matrix, errors or sky as a PNG")
    parser.add_argument(
        "source",
        metavar="FILE.csv[:COLUMN]|SCENE.blend",
        help="one material: its reflectance and matrix; many: their errors under the sky",
    )
    parser.add_argument("--out", required=True, type=output(".png"), metavar="PICTURE.png")
    parser.add_argument("--material", metavar="NAME", help="material of SCENE.blend; default: all")
    parser.add_argument("--theme", choices=("light", "dark"), default="light")
    parser.add_argument(
        "--scale",
        type=float,
        default=1.5,
        metavar="PIXELS",
        help="pixels per unit, 0.5 to 8; pictures are 480 units wide",
    )
    add_sky_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Draw and write the picture."""
    from ..pictures.png_file import write_png

    if not 0.5 <= options.scale <= 8.0:
        raise InputError("--scale", f"{options.scale:g}", "give 0.5 to 8")
    of = _of_scene if Path(options.source).suffix == ".blend" else _of_file
    write_png(options.out, of(options))
    print(options.out)


def _of_file(options: argparse.Namespace) -> Any:
    """Draw reflectances of a file under the sky that the options tell."""
    import numpy as np

    from ..pictures.portrait import Portrait, plain
    from ..spectra.reflectance import read_reflectances, split_assignment
    from ..transfer.prediction import rgb_albedo

    if options.material is not None:
        raise InputError("--material", "is for SCENE.blend", f"write {options.source}:COLUMN")
    path, column = split_assignment(options.source)
    read = read_reflectances(path, options.unit, column)
    if len(read.names) > 1 and options.sky is None and options.sky_rgb is None:
        raise InputError(
            path,
            f"holds {len(read.names)} materials, which are compared under a sky",
            f"give --sky HDRI, or name one material, as in {path.name}:{read.names[0]}",
        )
    found = choose(options, read.values)
    choice = found.choice
    for note in (*read.notes, *found.notes):
        print(note)
    if len(read.names) > 1:
        assert choice.prediction is not None
        if choice.prediction.unknown:
            print(f"errors are unknown: {choice.prediction.unknown}")
        ours = [choice.error(k)[0] for k in range(len(read.names))]
        rows = zip(read.names, choice.prediction.rgb, ours, strict=True)
        return _draw(options, path.name, errors=list(rows), light=found.light)
    albedo = rgb_albedo(read.values[0], options.space)
    one = Portrait(
        name=read.names[0],
        reflectance=plain(read.values[0]),
        matrix=plain(choice.matrices[0]),
        spectrum=plain(_spectrum(found)),
        measured=read.measured,
        today=plain(np.diag(albedo) @ choice.transfer.to_working),
    )
    return _draw(options, f"{one.name} ({path.name})", one, light=found.light)


def _spectrum(found: UnderSky) -> Any:
    """Return the restored spectrum of the light on level ground, None without a sky."""
    if found.lights is None:
        return None
    transfer = found.choice.transfer
    return transfer.restoration @ transfer.unbalanced(found.lights[0])


def _of_scene(options: argparse.Namespace) -> Any:
    """Draw what a file's managed materials were given."""
    from ..scene import portraits
    from ..scene.files import blend_file

    if options.sky is not None or options.sky_rgb is not None:
        raise InputError("--sky", f"{options.source} has its own", "omit it")
    blend_file.open_scene(options.source)
    if options.material is None:
        rows = portraits.expected()
        if not rows:
            raise InputError(options.source, "has no spectral material", "apply one first")
        return _draw(options, Path(options.source).name, errors=rows)
    found = portraits.portrait(blend_file.material(options.material))
    if found is None:
        raise InputError(
            f"--material {options.material}", "has no reflectance yet", "apply one first"
        )
    return _draw(options, f"{options.material}: {found.name}", found)


def _draw(
    options: argparse.Namespace,
    title: str,
    one: Any = None,
    errors: Any = None,
    light: Any = None,
) -> Any:
    """Draw one `Portrait`, or many materials' errors (name, today's, ours), and the `SkyLight`."""
    from ..pictures.errors import errors as bars
    from ..pictures.sheet import sheet
    from ..pictures.sky_map import sky_map
    from ..pictures.theme import THEMES

    style: dict[str, Any] = {"theme": THEMES[options.theme], "scale": options.scale}
    drawn = [one.draw_curve(**style), one.draw_matrix(**style)] if one else []
    if errors is not None:
        drawn.append(bars(*zip(*errors, strict=True), **style))
    if light is not None:
        drawn.append(sky_map(light.outside, light.sky, light.sun, **style))
    return sheet(title, drawn, **style)
