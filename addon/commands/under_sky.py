"""Matrices of reflectances under what a command's options say of the sky."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from ..choices import SPACES, default, listed
from ..errors import InputError
from .arguments import add_matrix_options, basis_name, three

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..sky.light import SkyLight
    from ..transfer.choice import Choice


def add_sky_options(parser: argparse.ArgumentParser) -> None:
    """Add what decides a material's matrix, the sky included."""
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--sky", metavar="HDRI", help="HDRI under which errors are predicted")
    source.add_argument(
        "--sky-rgb", type=three, metavar="R,G,B", help="RGB of skylight in the working space"
    )
    add_matrix_options(parser)
    parser.add_argument(
        "--space",
        default=default(SPACES),
        metavar="NAME",
        help=f"working space of the scene: {listed(SPACES)}",
    )


@dataclass(frozen=True)
class UnderSky:
    """Models of reflectances, a `Choice`, and what was found in the sky.

    ``light``: the `SkyLight`, None without an HDRI; ``lights`` (k, 3) as the sky's numbers are,
    None without any sky.
    """

    choice: Choice
    light: SkyLight | None
    lights: NDArray[np.float64] | None
    white: tuple[float, float, float] | None
    sun_elevation: float | None
    notes: list[str]


def choose(options: argparse.Namespace, reflectances: NDArray[np.float64]) -> UnderSky:
    """Return the models of reflectances (m, 81) under the sky of the options.

    Raises InputError as the readers of the options' files and `transfer` do.
    """
    import numpy as np

    from ..spectra.sensitivities import camera, observer
    from ..spectra.working_spaces import rec709_to_working
    from ..transfer.choice import choose_with
    from ..transfer.known_light import KnownLight
    from ..transfer.matrices import OWN, transfer
    from ..transfer.white import AUTO, estimate_white, settle_white

    lights, light, known, notes = None, None, None, []
    white, elevation = options.white, options.sun_elevation
    if options.sky_rgb is not None:
        if not np.isfinite(options.sky_rgb).all():
            raise InputError("--sky-rgb", "is not finite", "give three numbers R,G,B")
        lights = np.array([options.sky_rgb])
        known = KnownLight(lights, elevation)
    elif options.sky is not None:
        from ..scene.files.exr_decoder import read_sky
        from ..sky.light import analyse

        S_in = observer() if options.camera is None else camera(options.camera)
        if isinstance(white, tuple):
            S_in = S_in / np.array(white)[:, None]
        light = analyse(read_sky(options.sky, raw=options.camera is not None), S_in=S_in)
        elevation = light.sun_elevation(elevation)
        to_working = None if options.camera else rec709_to_working(options.space)
        lights = light.faces if to_working is None else light.faces @ to_working.T
    mapping = partial(
        transfer,
        camera=options.camera,
        space=options.space,
        sun_elevation=elevation,
        sky_rgb=lights,
        known=None if light is None or light.spectrum is None else light.spectrum.members,
    )
    if light is not None:
        white, note = settle_white(
            white, lambda: estimate_white(light, mapping("rayleigh"), elevation, to_working)
        )
        notes = [*light.notes, note] if note else light.notes
        known = KnownLight.of(
            light,
            elevation,
            white_is_doubtful=bool(note) and options.white is None,
            to_working=to_working,
        )
    elif white == AUTO:
        raise InputError("--white auto", "there is no sky to estimate it from", "give --sky HDRI")
    choice = choose_with(
        partial(mapping, white=white),
        basis_name(options),
        reflectances,
        known,
        options.tolerance,
    )
    if choice.transfer.basis == OWN:
        notes = [*notes, "the matrices are from this sky's own spectrum"]
    return UnderSky(choice, light, lights, white, elevation, notes)
