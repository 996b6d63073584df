"""Materials of a scene: made spectral, brought up to date, given back."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ... import tags
from ...choices import BAKED, OPEN
from ...errors import InputError
from ...grouping import grouped
from ...progress import Progress, mapped, run
from ...transfer.assignment import Assignment
from ...transfer.assignment_table import read_table, table_files
from ...whole_files import write_text
from .. import clear
from .. import plan as planning
from ..blend_data import kept
from ..day import animate as animation
from ..day import day_world
from ..materials import base_color, eligibility, spectral_material
from ..materials.assigned import assigned, in_file
from ..materials.record import Result
from ..outcome import Everything, Outcome
from ..plan import Assignments
from ..world.settings import Settings
from ..write import relighting, write
from .world import developing


def make_spectral(scene: bpy.types.Scene, given: Assignments, settings: Settings) -> Outcome:
    """Give materials what they are assigned under a scene's sky.

    Everything is computed and checked before the first material changes. Raises InputError as
    `develop` and `plan.make` do.
    """
    return run(making_spectral(scene, given, settings))


def making_spectral(
    scene: bpy.types.Scene, given: Assignments, settings: Settings, relight: bool = True
) -> Generator[Progress, None, Outcome]:
    """Do as `make_spectral` does, yielding after each material; what is baked is lit anew, but
    where that is not wanted, for `all_light` follows.

    Under a sky that moves, all materials under it move with it, as `animate` has it.
    """
    planning.check(given)  # before the World is touched
    if (day := animation.day_of(scene.world)) is not None:
        ours, _ = editable(in_scene(scene))
        return (yield from animated(scene, day, {**given_before(ours), **given}, settings))
    day_world.stop_unused()
    world = yield from developing(scene, settings)
    plan = yield from planning.making(world, given, settings)
    results = yield from write(plan)
    lines = (yield from relighting(plan)) if relight else []
    return Outcome(plan.light, results, lines=lines)


def animated(
    scene: bpy.types.Scene, day: animation.Day, given: Assignments, settings: Settings
) -> Generator[Progress, None, Outcome]:
    """Give materials what they are assigned through a day, as `animation.animating` does.

    What materials reflect of each other's light is baked once they have it: whoever closes the
    generator before leaves new ones under the open sky that moves.
    """
    if settings.shadows == BAKED and any(map(_is_new, given, given.values())):
        first = animation.animating(scene, day, given, replace(settings, occlusion=OPEN))
        yield from mapped(first, lambda step: replace(step, done=0.3 * step.done))
    plan, lines = yield from animation.animating(scene, day, given, settings)
    return Outcome(plan.light, [one.result for one in plan.materials], lines=lines)


def _is_new(material: bpy.types.Material, one: Assignment) -> bool:
    """Whether a material has not yet what it is given."""
    before = assigned(material)
    return before is None or not np.array_equal(before.values, one.values)


def make_everything_spectral(
    scene: bpy.types.Scene,
    chosen: Mapping[bpy.types.Material, Assignment | str],
    settings: Settings,
    estimate: bool = True,
    relight: bool = True,
) -> Generator[Progress, None, Everything]:
    """Make every eligible material of a scene spectral, yielding after each; ``relight`` as in
    `making_spectral`.

    ``chosen``: what materials are given, or why that cannot be read; others keep what they have, or
    with ``estimate`` get a reflectance of their base color. Raises InputError as `make_spectral`.
    """
    given: dict[bpy.types.Material, Assignment] = {}
    left: list[tuple[str, str]] = []
    for material in eligibility.materials_of(scene):
        what = _what(material, chosen.get(material), estimate)
        if isinstance(what, str):
            left.append((material.name, what))
        else:
            given[material] = what
    results: list[Result] = []
    if given:
        results = (yield from making_spectral(scene, given, settings, relight)).results
    scene[tags.LEFT_ALONE] = json.dumps(left)
    return Everything(results, left)


def _what(
    material: bpy.types.Material, chosen: Assignment | str | None, estimate: bool
) -> Assignment | str:
    """What a material is to have, or why it is left alone."""
    if chosen is not None:
        return eligibility.unchangeable(material) or chosen
    before = assigned(material)
    if before is not None and not before.estimated:
        return eligibility.unchangeable(material) or before
    if why := eligibility.reason(material):
        return why
    if not estimate:
        return "no reflectance is chosen for it"
    return base_color.estimated(material)


def left_alone(scene: bpy.types.Scene) -> list[tuple[str, str]]:
    """Names of materials that `make_everything_spectral` left alone, and why; empty before."""
    found: list[Any] = kept.plain(scene, tags.LEFT_ALONE, [])
    return [(each[0], each[1]) for each in found if kept.are_texts(each) and len(each) == 2]


def resolved(given: Mapping[bpy.types.Material, Assignment | None]) -> Assignments:
    """Return what materials are given, those that are None by an estimate of their base color."""
    return {
        material: base_color.estimated(material) if one is None else one
        for material, one in given.items()
    }


def give_table(scene: bpy.types.Scene, path: Path, settings: Settings) -> Outcome:
    """Give a scene's materials what a table has for their names, one by one name after another.

    Names that no material of the scene has, and materials that cannot be changed, are reported.
    Raises InputError as `read_table` and `make_spectral` do, and where no name fits.
    """
    table = read_table(path)
    by_name = {material.name: material for material in eligibility.materials_of(scene)}
    absent = [name for name in table if name not in by_name]
    if len(absent) == len(table):
        raise InputError(path, "names no material of this scene", "choose the scene's own table")
    chosen, skipped = editable(by_name[name] for name in table if name in by_name)
    given = resolved({material: table[material.name] for material in chosen})
    skipped += [f"skipped: the scene has no material {name}" for name in absent]
    return replace(make_spectral(scene, given, settings), skipped=skipped)


def write_table(path: Path) -> int:
    """Write what the file's materials have been given as a table; return of how many.

    Raises InputError where nothing was given yet, or a file cannot be written.
    """
    given = in_file()
    if not given:
        raise InputError(path, "would be empty", "make a material spectral first")
    for file, text in table_files(path, given).items():
        write_text(file, text)
    return len(given)


def estimate(
    scene: bpy.types.Scene, materials: Iterable[bpy.types.Material], settings: Settings
) -> Outcome:
    """Give materials reflectances of their own base colors; raises as `make_spectral` does."""
    return make_spectral(scene, resolved(dict.fromkeys(materials)), settings)


def update(
    scene: bpy.types.Scene,
    settings: Settings,
    chosen: Iterable[bpy.types.Material] | None = None,
) -> Outcome:
    """Bring managed materials up to date with a scene's sky, as `updating` does."""
    return run(updating(scene, settings, chosen))


def updating(
    scene: bpy.types.Scene,
    settings: Settings,
    chosen: Iterable[bpy.types.Material] | None = None,
    relight: bool = True,
) -> Generator[Progress, None, Outcome]:
    """Bring managed materials (None: all of the scene that can be changed) up to date with its sky;
    ``relight`` as in `making_spectral`.

    What they are given comes from the blend file itself. Raises InputError as `make_spectral` does,
    and for a material of the first version, which kept no reflectance.
    """
    skipped: list[str] = []
    if chosen is None:
        chosen, skipped = editable(in_scene(scene))
    found = yield from making_spectral(scene, given_before(chosen), settings, relight)
    return replace(found, skipped=skipped)


def given_before(materials: Iterable[bpy.types.Material]) -> dict[bpy.types.Material, Assignment]:
    """Return what materials were given; raises InputError for one that keeps nothing."""
    found = {material: assigned(material) for material in materials}
    for material, one in found.items():
        if one is None:
            place = f'material "{material.name}"'
            raise InputError(place, "has no reflectance yet", "apply one first")
    return {material: one for material, one in found.items() if one is not None}


def in_scene(scene: bpy.types.Scene) -> list[bpy.types.Material]:
    """Return the managed materials that a scene shows or that its World lights, each once."""
    shown = eligibility.materials_of(scene)
    under = spectral_material.managed_materials(scene.world) if scene.world else []
    return list(dict.fromkeys([*filter(spectral_material.is_managed, shown), *under]))


def editable(
    found: Iterable[bpy.types.Material],
) -> tuple[list[bpy.types.Material], list[str]]:
    """Return those that this file can change, and a line for each that is skipped.

    Raises InputError where none is left of some.
    """
    kept: list[bpy.types.Material] = []
    skipped: list[tuple[str, InputError]] = []
    for material in found:
        try:
            spectral_material.check_editable(material)
        except InputError as error:
            skipped.append((material.name, error))
        else:
            kept.append(material)
    if skipped and not kept:
        raise skipped[0][1]
    if len(skipped) == 1:
        return kept, [f"skipped: {skipped[0][1]}"]
    causes = ((name, f"{error.problem}; {error.args[2]}") for name, error in skipped)
    return kept, [f"skipped: {line}" for line in grouped(causes)]


def remove(materials: Iterable[bpy.types.Material]) -> Outcome:
    """Give those of some materials back that are ours, as they were; raises as `editable` does."""
    ours = set(spectral_material.ours())
    chosen, skipped = editable(material for material in materials if material in ours)
    for material in chosen:
        spectral_material.remove(material)
    return Outcome(skipped=skipped, lines=[f"{len(chosen)} material(s) restored"])


def remove_all() -> Outcome:
    """Take all of ours out of the file; raises as `editable` does, and nothing is removed then."""
    found = remove(spectral_material.ours())
    return replace(found, lines=[*found.lines, *clear.clear()])
