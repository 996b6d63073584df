"""`apply`: materials of a blend file made spectral."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from .arguments import add_matrix_options, basis_name
from .progress_bar import run_with_bar


def add(commands: Any) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser("apply", help="make materials of a .blend spectral")
    parser.add_argument("scene", metavar="SCENE.blend")
    parser.add_argument("--sky", metavar="HDRI", help="default: the World's own")
    parser.add_argument(
        "--assign",
        action="append",
        default=[],
        type=_assignment,
        metavar="MATERIAL=FILE.csv[:COLUMN]",
        help="may be given many times; a texture of its base colour varies it",
    )
    parser.add_argument(
        "--estimate",
        action="append",
        default=[],
        metavar="MATERIAL",
        help="restore a reflectance from the material's own base colour or texture",
    )
    parser.add_argument(
        "--metal",
        action="append",
        default=[],
        type=_assignment,
        metavar="MATERIAL=NK.csv",
        help="a metal by its n and k; the material's own Metallic says where",
    )
    parser.add_argument(
        "--glass",
        action="append",
        default=[],
        type=_assignment,
        metavar="MATERIAL=FILE.csv[:COLUMN]",
        help="a glazing by its transmittance, measured at normal incidence",
    )
    parser.add_argument(
        "--behind",
        action="append",
        default=[],
        type=_assignment,
        metavar="MATERIAL=FILE.csv[:COLUMN]",
        help="a material with a reflectance is lit through a glazing of this transmittance alone",
    )
    add_matrix_options(parser)
    parser.add_argument("--space", help="checked against the file's working space")
    parser.add_argument(
        "--no-sun", action="store_true", help="leave the HDRI's sun off the materials"
    )
    parser.add_argument(
        "--lamp",
        action="append",
        default=[],
        type=_assignment,
        metavar="LAMP=SPECTRUM",
        help="a lamp's FILE.csv[:COLUMN], illuminant (A, FL11, LED-B3 ...) or temperature (2700K)",
    )
    parser.add_argument(
        "--ground",
        choices=("auto", "hdri", "modelled", "none"),
        default="auto",
        help="light from below: modelled where geometry lies under the materials (auto)",
    )
    parser.add_argument(
        "--occlusion",
        choices=("open", "dome", "baked"),
        default="open",
        help="shadows of the sky: none, live in Eevee, or baked",
    )
    parser.add_argument(
        "--bounce",
        action="store_true",
        help="bake what one bounce between materials brings too",
    )
    parser.add_argument(
        "--gloss", action="store_true", help="keep the gloss and metal of the materials"
    )
    parser.add_argument("--out", required=True, metavar="OUT.blend")
    parser.set_defaults(run=run)


def _assignment(text: str) -> tuple[str, str]:
    material, equals, reflectance = text.partition("=")
    if not (material and equals and reflectance):
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=VALUE")
    return material, reflectance


def _settings(options: argparse.Namespace) -> Any:
    """Return the `scene.settings.Settings` of the options; a white to be found is left open."""
    from ..scene.world.settings import BAKED, Settings
    from ..transfer.white import AUTO

    if options.bounce and options.occlusion != BAKED:
        raise InputError("--bounce", "is part of a bake", "add --occlusion baked")
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


@dataclass(frozen=True)
class _Spectra:
    """What the options' files hold, by the names of materials, read before the scene is opened.

    Reflectances and transmittances (name, (81,)); from where to where [nm] reflectances were
    measured; n and k (81,) of metals.
    """

    reflectances: dict[str, Any]
    measured: dict[str, tuple[float, float]]
    metals: dict[str, Any]
    glazings: dict[str, Any]
    behind: dict[str, Any]


def _read(options: argparse.Namespace) -> _Spectra:
    from ..spectra.formats.igsdb import TRANSMITTANCE
    from ..spectra.reflectance import read_one
    from ..spectra.refraction import read_nk
    from ..transfer.metals import conductor

    if not (options.assign or options.estimate or options.metal):
        raise InputError("--assign", "names no material", "give MATERIAL=FILE.csv or --estimate")
    given = [name for name, _ in (*options.assign, *options.metal, *options.glass)]
    given += options.estimate
    for name in given:
        if given.count(name) > 1:
            raise InputError(f"--assign {name}", "is given twice", "give each material once")
    read = [
        {name: read_one(text, options.unit, quantity) for name, text in pairs}
        for pairs, quantity in (
            (options.assign, ""),
            (options.glass, TRANSMITTANCE),
            (options.behind, TRANSMITTANCE),
        )
    ]
    curves: list[dict[str, Any]] = [
        {name: (one.names[0], one.values[0]) for name, one in each.items()} for each in read
    ]
    measured = {name: one.measured for name, one in read[0].items()}
    metals = {name: read_nk(text) for name, text in options.metal}
    for name, text in options.metal:
        curves[0][name] = (text, conductor(*metals[name]))
    return _Spectra(curves[0], measured, metals, *curves[1:])


def _targets(options: argparse.Namespace, spectra: _Spectra) -> dict[Any, Any]:
    """Return the open file's materials and their reflectances (name, (81,))."""
    from ..scene.files import blend_file
    from ..scene.materials import base_color

    targets = {blend_file.material(name): given for name, given in spectra.reflectances.items()}
    for name in options.estimate:
        material = blend_file.material(name)
        targets[material] = (base_color.ESTIMATED, base_color.estimated(material))
    for name, (glass, transmittance) in spectra.behind.items():
        if (material := blend_file.material(name)) not in targets:
            raise InputError(f"--behind {name}", "has no reflectance", "give it one by --assign")
        reflectance, values = targets[material]
        targets[material] = (f"{reflectance} behind {glass}", values * transmittance)
    return targets


def _metals(spectra: _Spectra) -> dict[Any, Any]:
    """Return the open file's materials that are metals, with n and k."""
    from ..scene.files import blend_file
    from ..scene.materials import glass_and_metal

    metals = {blend_file.material(name): nk for name, nk in spectra.metals.items()}
    for material in metals:
        glass_and_metal.check_metal(material)
    return metals


def run(options: argparse.Namespace) -> None:
    """Write the blend file, and print what each material was given."""
    from ..scene import baking, spectral
    from ..scene.blend_data import working_space
    from ..scene.files import blend_file
    from ..scene.lights import user_lamps
    from ..scene.world import light_group
    from ..scene.world.settings import BAKED
    from ..transfer.white import AUTO

    spectra, settings = _read(options), _settings(options)
    scene = blend_file.open_scene(options.scene)
    if options.space not in (None, working_space.name()):
        raise InputError(
            options.scene,
            f"its working space is {working_space.name()}, not {options.space}",
            "leave --space out",
        )
    for name, spectrum in options.lamp:
        file = Path(spectrum)  # the blend file may move
        spectrum = str(file.resolve()) if file.parent.is_dir() and file.suffix else spectrum
        blend_file.lamp(name).data[user_lamps.SPECTRUM] = spectrum
    if options.sky is not None:
        spectral.set_sky(scene, options.sky, settings)
    said = []
    if options.white == AUTO:
        settings, line = spectral.with_estimated_white(scene.world, settings)
        said.append(line)
    targets, metals = _targets(options, spectra), _metals(spectra)
    world = spectral.develop(scene, settings)
    measured = {blend_file.material(name): span for name, span in spectra.measured.items()}
    glazings = {blend_file.material(n): (*pane, 1) for n, pane in spectra.glazings.items()}
    light, results = spectral.make_spectral(world, targets, settings, metals, measured, glazings)
    if settings.occlusion == BAKED:
        said += run_with_bar(baking.bake(world, settings), "bake")
        light, results = spectral.update(world, settings, targets)
    blend_file.save(options.out)
    for result in results:
        print(result.line)
    description = light_group.description_of(world) or {}
    for line in (*said, *light.notes, *description["lights"], description["caption"]):
        print(line)
