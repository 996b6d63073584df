"""Arguments that several commands share."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from ..choices import BASIS, SIMPLEST, UNITS, described, offered_bases
from ..errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..sky.place import Place


Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"
"""What a command adds itself to."""


def option(parameter: str) -> str:
    """Return a parameter's option, as `errors.InputError.told` asks for it: ``--sun-elevation``."""
    return f"--{parameter.replace('_', '-')}"


def three(text: str) -> tuple[float, float, float]:
    """Return the three numbers of ``R,G,B``."""
    try:
        r, g, b = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not three numbers R,G,B") from None
    return r, g, b


def folder(path: str) -> Path:
    """Return a folder that results can go to, checked before the work and not after it.

    It is made and taken away again: work that stops leaves nothing. Raises `InputError` where it
    cannot be made.
    """
    found = Path(path)
    missing = [each for each in (found, *found.parents) if not each.exists()]
    try:
        found.mkdir(parents=True, exist_ok=True)
        for each in missing:
            each.rmdir()
    except OSError as error:
        raise InputError(
            path,
            f"cannot be created as a folder ({error.strerror})",
            "choose another folder for --out",
        ) from None
    return found


def chosen_reflectances(
    options: argparse.Namespace,
) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return names and reflectances (m, 81) of ``--reflectances``, else the ColorChecker's."""
    import numpy as np

    from ..spectra.colorchecker import colorchecker
    from ..spectra.reflectance import read_reflectances

    if not options.reflectances:
        return colorchecker()
    read = [read_reflectances(file, options.unit) for file in options.reflectances]
    names = tuple(name for one in read for name in one.names)
    return names, np.concatenate([one.values for one in read])


def positive(text: str) -> float:
    """Return a number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number above 0")
    return value


def basis_name(options: argparse.Namespace) -> str:
    """Return the basis that was asked for, or the one that its absence stands for."""
    return str(options.basis or (BASIS if options.tolerance is None else SIMPLEST))


def white_or_auto(text: str) -> tuple[float, float, float] | str:
    """Return the three numbers of ``R,G,B``, or ``auto``."""
    return text if text == "auto" else three(text)


def add_matrix_options(parser: argparse.ArgumentParser) -> None:
    """Add what decides a material's matrix, but for the sky."""
    parser.add_argument(
        "--basis",
        metavar="NAME",
        help=f"{described(offered_bases())}; measured FILE.csv: a basis from measured spectra. "
        f"Default: {BASIS}, with --tolerance: {SIMPLEST}",
    )
    parser.add_argument(
        "--tolerance",
        type=positive,
        nargs="?",
        const=0.5,
        metavar="CIEDE2000",
        help="largest color error (CIEDE2000); each material uses the simplest model within it "
        "(0.5 if no number is given)",
    )
    parser.add_argument(
        "--sun-elevation", type=float, metavar="DEG", help="in degrees; default: found in the HDRI"
    )
    parser.add_argument("--camera", metavar="NAME|FILE", help="camera of an HDRI in raw camera RGB")
    parser.add_argument(
        "--white",
        type=white_or_auto,
        metavar="R,G,B|auto",
        help="RGB of neutral light before white balance; auto: estimated from the sky",
    )
    add_unit(parser)


def add_unit(parser: argparse.ArgumentParser) -> None:
    """Add the unit that reflectances are in where their file does not say."""
    parser.add_argument("--unit", choices=tuple(UNITS), help="unit of the reflectances")


def add_place(parser: argparse.ArgumentParser) -> None:
    """Add where on earth a sky is seen and its time zone, which `place_of` reads."""
    parser.add_argument(
        "--city",
        metavar="NAME",
        help="place and time zone of a city, as in Paris or 'Paris, Texas'",
    )
    for name, what in (("latitude", "north"), ("longitude", "east")):
        parser.add_argument(
            f"--{name}", type=float, metavar="DEG", help=f"in degrees, {what} is positive"
        )
    parser.add_argument(
        "--timezone",
        metavar="ZONE",
        help="name such as Europe/Berlin, or hours east of UTC such as +2; default: the city's, "
        "else UTC",
    )


def add_north(parser: argparse.ArgumentParser) -> None:
    """Add where north is in a scene."""
    parser.add_argument(
        "--north",
        type=float,
        default=0.0,
        metavar="DEG",
        help="true north in the scene, clockwise from +Y as seen from above",
    )


def place_of(options: argparse.Namespace) -> Place:
    """Return the place that the options name, and say which one a city is."""
    from ..sky.place import place

    found = place(options.city, options.latitude, options.longitude, options.timezone)
    if found.name:
        print(found.line)
    return found
