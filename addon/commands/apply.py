"""`apply`: materials of a blend file made spectral."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..choices import ALL_LIGHT, GROUNDS, OCCLUSIONS, default, described
from ..errors import InputError
from .arguments import Commands, add_matrix_options, basis_name
from .outputs import output
from .progress_bar import run_with_bar

if TYPE_CHECKING:
    from ..scene.world.settings import Settings
    from ..transfer.assignment import Assignment


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("apply", help="make materials of a .blend spectral")
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument("--sky", metavar="HDRI", help="default: the World's own")
    _repeated(
        parser,
        "--assign",
        "MATERIAL=FILE.csv[:COLUMN]",
        "may be repeated; a base color texture varies the reflectance",
    )
    parser.add_argument(
        "--estimate",
        action="append",
        default=[],
        metavar="MATERIAL",
        help="estimate a reflectance from the material's base color or texture",
    )
    _repeated(
        parser,
        "--metal",
        "MATERIAL=NK.csv",
        "a metal by its n and k, applied where the material is Metallic",
    )
    _repeated(
        parser,
        "--glass",
        "MATERIAL=FILE.csv[:COLUMN]",
        "glass by its transmittance at normal incidence; each face is a pane",
    )
    _repeated(
        parser,
        "--glass-block",
        "MATERIAL=FILE.csv[:COLUMN]",
        "as --glass, for a mesh with faces on both sides of the pane",
    )
    parser.add_argument(
        "--assignments",
        metavar="FILE.csv",
        help="read a table of materials and their assignments; options above take precedence",
    )
    parser.add_argument(
        "--write-assignments",
        type=output(".csv"),
        metavar="FILE.csv",
        help="also write the assignments of all spectral materials as such a table",
    )
    _repeated(
        parser,
        "--behind",
        "MATERIAL=FILE.csv[:COLUMN]",
        "all light on the material passes through glass of this transmittance",
    )
    add_matrix_options(parser)
    parser.add_argument("--space", metavar="NAME", help="must match the working space of the file")
    parser.add_argument(
        "--no-sun", action="store_true", help="exclude the HDRI's sun from spectral materials"
    )
    _repeated(
        parser,
        "--lamp",
        "LAMP=SPECTRUM",
        "a lamp's FILE.csv[:COLUMN], illuminant (A, FL11, LED-B3 ...) or temperature (2700K)",
    )
    parser.add_argument(
        "--ground",
        choices=tuple(GROUNDS),
        default=default(GROUNDS),
        help=f"source of the light from below. {described(GROUNDS)}",
    )
    parser.add_argument(
        "--occlusion",
        choices=tuple(OCCLUSIONS),
        default=default(OCCLUSIONS),
        help=f"light and shadows. {described(OCCLUSIONS)}",
    )
    parser.add_argument(
        "--bounce",
        action="store_true",
        help="every bounce between surfaces, which auto and baked always include",
    )
    parser.add_argument(
        "--gloss",
        action="store_true",
        help="keep the specular and metallic layers of the materials",
    )
    parser.add_argument("--out", required=True, type=output(".blend"), metavar="OUT.blend")
    parser.set_defaults(run=run)


def _repeated(parser: argparse.ArgumentParser, option: str, metavar: str, text: str) -> None:
    """Add an option ``NAME=VALUE`` that may be given again and again."""
    parser.add_argument(
        option, action="append", default=[], type=_assignment, metavar=metavar, help=text
    )


def _assignment(text: str) -> tuple[str, str]:
    material, equals, reflectance = text.partition("=")
    if not (material and equals and reflectance):
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=VALUE")
    return material, reflectance


def _settings(options: argparse.Namespace) -> Settings:
    """Return the `scene.settings.Settings` of the options; a white to be found is left open."""
    from ..scene.world.settings import Settings
    from ..transfer.white import AUTO

    if options.bounce and options.occlusion not in ALL_LIGHT:
        raise InputError("--bounce", "needs all light", "omit --occlusion, or give auto")
    return Settings(
        basis=basis_name(options),
        camera=options.camera,
        white=None if options.white == AUTO else options.white,
        sun_elevation=options.sun_elevation,
        tolerance=options.tolerance,
        sun=not options.no_sun,
        ground=options.ground,
        occlusion=options.occlusion,
        bounce=options.bounce,
        gloss=options.gloss,
    )


def _read(options: argparse.Namespace) -> dict[str, Assignment | None]:
    """Read what materials are given, by their names, before the scene is opened.

    None for those whose base color is to tell.
    """
    from ..transfer import assignment
    from ..transfer.assignment_table import read_table

    named = [name for name, _ in (*options.assign, *options.metal, *options.glass)]
    named += [name for name, _ in options.glass_block] + options.estimate
    if not (named or options.assignments):
        raise InputError("--assign", "assigns no material", "give MATERIAL=FILE.csv or --estimate")
    for name in named:
        if named.count(name) > 1:
            raise InputError(f"--assign {name}", "is given twice", "give each material once")
    given: dict[str, Assignment | None] = {}
    if options.assignments:
        given |= read_table(Path(options.assignments))
    given |= {name: assignment.read(file, unit=options.unit) for name, file in options.assign}
    for pairs, faces in (
        (options.glass, assignment.SINGLE_FACE),
        (options.glass_block, assignment.BLOCK),
    ):
        for name, file in pairs:
            given[name] = assignment.read(file, unit=options.unit, faces=faces)
    given |= {name: assignment.read_metal(file) for name, file in options.metal}
    given |= dict.fromkeys(options.estimate)
    for name, file in options.behind:
        surface = given.get(name)
        if surface is None or surface.faces:
            raise InputError(f"--behind {name}", "has no reflectance", "give it one with --assign")
        glass = assignment.read(file, unit=options.unit, faces=assignment.SINGLE_FACE)
        given[name] = surface.lit_through(glass)
    return given


def run(options: argparse.Namespace) -> None:
    """Write the blend file, and print what each material was given."""
    from ..scene import use_cases
    from ..scene.blend_data import working_space
    from ..scene.files import blend_file
    from ..scene.lights import user_lamps
    from ..transfer.white import AUTO

    read, settings = _read(options), _settings(options)
    scene = blend_file.open_scene(options.scene)
    blend_file.check_unread(Path(options.out))
    if options.space not in (None, working_space.name()):
        raise InputError(
            options.scene,
            f"its working space is {working_space.name()}, not {options.space}",
            "omit --space",
        )
    for name, spectrum in options.lamp:
        file = Path(spectrum)  # the blend file may move
        spectrum = str(file.resolve()) if file.parent.is_dir() and file.suffix else spectrum
        user_lamps.set_spectrum(blend_file.lamp(name).data, spectrum)
    if options.sky is not None:
        use_cases.set_sky(scene, options.sky, settings)
    lines = []
    if options.white == AUTO:
        settings, line = use_cases.with_estimated_white(scene.world, settings)
        lines.append(line)
    given = use_cases.resolved({blend_file.material(name): one for name, one in read.items()})
    found = run_with_bar(use_cases.making_spectral_with_all_light(scene, given, settings), "apply")
    blend_file.save(options.out)
    if options.write_assignments:
        use_cases.write_table(Path(options.write_assignments))
    for result in found.results:
        print(result.line)
    notes = found.light.notes if found.light is not None else []
    for line in (*lines, *found.lines, *notes, *use_cases.light_lines(scene)):
        print(line)
