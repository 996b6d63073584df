"""What all buttons share that give materials something: read the files, do it, and report."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from typing import TYPE_CHECKING

import bpy

from ..grouping import grouped
from ..progress import Progress
from . import follow, operator, properties
from .choice import Chosen, keep

if TYPE_CHECKING:
    from ..scene.materials.record import Result

Lines = list[tuple[str, str]]


def giving(
    context: bpy.types.Context, chosen: Mapping[bpy.types.Material, Chosen]
) -> Generator[Progress, None, Lines]:
    """Give materials what was chosen for them; without a sky it is kept ready with them.

    Raises InputError as the readers of the files and `use_cases.make_spectral` do.
    """
    from ..scene import use_cases

    read = {m: one.read(m.skylight.absolute) for m, one in chosen.items()}
    notes = [(material.name, note) for material, one in read.items() for note in one.notes]
    lines: Lines = [("INFO", line) for line in grouped(notes)]
    if operator.no_sky(context):
        said = "is chosen. Load a sky, then press Apply"
        lines += [("INFO", f"{m.name}: {one.column} {said}") for m, one in read.items()]
    else:
        settings = properties.settings_of(context.scene.world)
        relight = not follow.follows(settings)
        found = yield from use_cases.making_spectral(context.scene, read, settings, relight)
        lines += [("WARNING" if r.out_of_gamut else "INFO", r.line) for r in found.results]
        lines += operator.of_light(context.scene)
    for material, one in chosen.items():
        keep(material.skylight, one, read[material].column)
    return lines


def warnings(skipped: list[str]) -> Lines:
    """Lines on what was skipped, as buttons report them."""
    return [("WARNING", line) for line in skipped]


def of_results(results: Iterable[Result]) -> Lines:
    """What of many results needs the person: a line for each cause, with its materials."""
    found = list(results)
    clamped = [(r.material, "out of gamut under this sky: Blender clamps it") for r in found]
    clamped = [line for line, r in zip(clamped, found, strict=True) if r.out_of_gamut]
    unknown = [(r.material, f"error unknown: {r.unknown}") for r in found if r.unknown]
    return [
        *(("WARNING", line) for line in grouped(clamped)),
        *(("INFO", line) for line in grouped(unknown)),
    ]
