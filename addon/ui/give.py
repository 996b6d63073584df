"""What all buttons share that give materials something: read the files, do it, and report."""

from __future__ import annotations

from collections.abc import Mapping

import bpy

from . import operator, properties
from .choice import Chosen, keep

Lines = list[tuple[str, str]]


def give(context: bpy.types.Context, chosen: Mapping[bpy.types.Material, Chosen]) -> Lines:
    """Give materials what was chosen for them; without a sky it is kept ready with them.

    Raises InputError as the readers of the files and `use_cases.make_spectral` do.
    """
    from ..scene import use_cases

    read = {m: one.read(m.skylight.absolute) for m, one in chosen.items()}
    lines: Lines = [("INFO", f"{m.name}: {note}") for m, one in read.items() for note in one.notes]
    if operator.no_sky(context):
        said = "is chosen. Load a sky, then press Apply"
        lines += [("INFO", f"{m.name}: {one.column} {said}") for m, one in read.items()]
    else:
        settings = properties.settings_of(context.scene.world)
        found = use_cases.make_spectral(context.scene, read, settings)
        lines += [("WARNING" if r.out_of_gamut else "INFO", r.line) for r in found.results]
        lines += operator.of_light(context.scene)
    for material, one in chosen.items():
        keep(material.skylight, one, read[material].column)
    return lines


def warnings(skipped: list[str]) -> Lines:
    """Lines on what was skipped, as buttons report them."""
    return [("WARNING", line) for line in skipped]
