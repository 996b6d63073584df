"""`glazing`: what a pane does to daylight and to the colors behind it."""

from __future__ import annotations

import argparse
import json
from typing import Any

from .arguments import Commands, add_unit, chosen_reflectances


def add(commands: Commands) -> None:
    """Add the command to those of the parser."""
    parser = commands.add_parser(
        "glazing", help="light transmittance, color rendering and color shifts of glass"
    )
    parser.add_argument(
        "panes",
        nargs="+",
        metavar="FILE.csv[:COLUMN]",
        help="transmittance of a pane at normal incidence; several: one behind the other, uncoated",
    )
    parser.add_argument(
        "--reflectances",
        nargs="+",
        metavar="FILE.csv",
        help="materials behind the glass; default: the ColorChecker's",
    )
    add_unit(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Print what EN 410 says of the glass, and the shift of each material."""
    from ..spectra.colour_temperature import cct_and_duv
    from ..spectra.grid import WEIGHTS
    from ..spectra.illuminants import D65
    from ..spectra.sensitivities import cmfs
    from ..transfer import assignment, glass

    one = assignment.SINGLE_FACE
    read = [assignment.read(file, unit=options.unit, faces=one) for file in options.panes]
    tau = read[0].values
    if len(read) > 1:
        tau = glass.panes(*(glass.uncoated(each.values) for each in read)).transmittance
    names, reflectances = chosen_reflectances(options)
    shifts = glass.colour_shift(tau, reflectances)
    T, Duv = cct_and_duv(cmfs() * WEIGHTS @ (D65() * tau))
    found: dict[str, Any] = {
        "panes": [each.name for each in read],
        "light_transmittance": float(glass.light_transmittance(tau)),
        "color_rendering_index": _number(glass.daylight_rendering(tau)),
        "daylight_cct": _number(float(T)),
        "daylight_duv": _number(float(Duv)),
        "materials": [
            {"name": name, "delta_E": _number(float(shift))}
            for name, shift in zip(names, shifts, strict=True)
        ],
    }
    if options.json:
        print(json.dumps(found, indent=1, allow_nan=False))
        return
    print(", ".join(found["panes"]))
    print(f"  light transmittance {found['light_transmittance']:.3f} (EN 410, D65)")
    if found["color_rendering_index"] is None:
        print("  lets no light through")
        return
    kelvin = "is no white" if found["daylight_cct"] is None else f"has {T:.0f} K, Duv {Duv:+.4f}"
    print(f"  color rendering of daylight Ra {found['color_rendering_index']:.1f} (EN 410)")
    print(f"  daylight through it {kelvin}")
    print(
        f"  colors shift by CIEDE2000 {shifts.mean():.1f} in the mean, {shifts.max():.1f} at most"
    )
    for name, shift in zip(names, shifts, strict=True):
        print(f"  {shift:5.1f}  {name}")


def _number(value: float) -> float | None:
    return value if value == value else None
