"""What is done to a scene, a function each: buttons, commands and batch tasks call these.

Those that take long are generators of `Progress`: `run` works one to its end, and whoever closes
one leaves things whole. Each returns what to report.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Generator, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from .. import tags
from ..choices import BAKED
from ..errors import InputError
from ..grouping import grouped
from ..progress import Progress, aside, mapped, run, timed
from ..sky.light import SkyLight
from ..transfer.assignment import Assignment
from ..transfer.assignment_table import read_table, table_files
from ..transfer.white import AUTO, estimate_white, settle_white
from ..whole_files import write_text
from . import clear, out_of_date, scene_lighting
from . import plan as planning
from .bake import scene_bake, session
from .bake.light import SceneLight, shining_of
from .blend_data import kept, working_space
from .day import animate as animation
from .day import day_world
from .lights import lighting
from .materials import base_color, eligibility, spectral_material
from .materials.assigned import assigned, in_file
from .materials.record import Result
from .meter import calibration, light_meter, lit_scene, metered_picture, room, surface_light
from .meter.calibration import Calibration, Told
from .meter.exposure import Exposure, SunTimes, exposing
from .meter.light_meter import Measured
from .meter.places import Places
from .meter.room import Room
from .outcome import Everything, Outcome
from .plan import Assignments
from .world import hdri, light_group, own_worlds, panorama, simulated_sky
from .world.settings import Settings, store
from .write import relighting, write


def analyzed(world: bpy.types.World | None, settings: Settings) -> SkyLight:
    """Return what a World's sky is; raises InputError as `panorama.light_of` does."""
    return panorama.light_of(world, settings.sensors)


def set_sky(scene: bpy.types.Scene, path: str | Path, settings: Settings) -> bpy.types.World:
    """Light a scene by an HDRI file, as `setting_sky` does."""
    return run(setting_sky(scene, path, settings))


def setting_sky(
    scene: bpy.types.Scene, path: str | Path, settings: Settings
) -> Generator[Progress, None, bpy.types.World]:
    """Light a scene by an HDRI file, developed where it is a camera's raw.

    Raises InputError for a file that is no sky (the scene is untouched) and for wrong settings.
    """
    yield from _checking(settings)
    yield from hdri.setting_sky(scene, path, raw=settings.camera is not None)
    world = yield from developing(scene, settings)
    own_worlds.remove_unused()
    return world


def load_sky(scene: bpy.types.Scene, path: str | Path, settings: Settings) -> Outcome:
    """Light a scene by an HDRI file, as `loading_sky` does."""
    return run(loading_sky(scene, path, settings))


def _checking(settings: Settings) -> Generator[Progress, None, None]:
    """Raise InputError for wrong settings."""
    check = partial(settings.transfer, space=working_space.name())
    yield from aside(Progress(0.0, "the sky"), check)


def loading_sky(
    scene: bpy.types.Scene, path: str | Path, settings: Settings, relight: bool = True
) -> Generator[Progress, None, Outcome]:
    """Light a scene by an HDRI file, and let its spectral materials follow; ``relight`` as in
    `making_spectral`.

    Raises InputError as `set_sky` does; the scene is untouched then.
    """
    yield from _checking(settings)
    ours, skipped = editable(in_scene(scene))
    yield from setting_sky(scene, path, settings)
    found = yield from updating(scene, settings, ours, relight)
    return replace(found, skipped=skipped)


def simulate_sky(
    scene: bpy.types.Scene, place: simulated_sky.SkyPlace, settings: Settings
) -> Outcome:
    """Light a scene by the sky of a date and a place, as `simulating_sky` does."""
    return run(simulating_sky(scene, place, settings))


def simulating_sky(
    scene: bpy.types.Scene,
    place: simulated_sky.SkyPlace,
    settings: Settings,
    relight: bool = True,
) -> Generator[Progress, None, Outcome]:
    """Light a scene by the sky of a date and a place, and let its spectral materials follow;
    ``relight`` as in `making_spectral`.

    Raises InputError as `simulated_sky.drawing` and `showing_sky` do; the scene is untouched then.
    """
    drawn = yield from simulated_sky.drawing(place)
    return (yield from showing_sky(scene, drawn, settings, relight))


def showing_sky(
    scene: bpy.types.Scene,
    drawn: simulated_sky.Drawn,
    settings: Settings,
    relight: bool = True,
) -> Generator[Progress, None, Outcome]:
    """Light a scene by a simulated sky, and let its spectral materials follow; ``relight`` as in
    `making_spectral`.

    What settings say of another sky's numbers (camera, white balance, the sun's elevation) does not
    hold for this one, which says its own. Raises InputError for wrong settings and where no
    material can be changed; the scene is untouched then.
    """
    settings = replace(settings, camera=None, white=None, sun_elevation=None)
    yield from _checking(settings)
    ours, skipped = editable(in_scene(scene))
    image = simulated_sky.image_of(drawn)
    store(simulated_sky.light(scene, image), settings)
    own_worlds.remove_unused()
    line = f"{image.name}: sun at {drawn.elevation:.1f}°"
    lines = [f"{line}, {drawn.kind}" if drawn.kind else line]
    found = yield from updating(scene, settings, ours, relight)
    return replace(found, skipped=skipped, lines=lines)


def animate(
    scene: bpy.types.Scene, day: animation.Day, settings: Settings
) -> Generator[Progress, None, Outcome]:
    """Let a scene's sky and its spectral materials move through a day, yielding how far it is.

    As `simulate_sky` does for one moment. Raises InputError as `Day.course` and `plan.make` do; the
    scene is untouched then.
    """
    settings = replace(settings, camera=None, white=None, sun_elevation=None)
    settings.transfer()
    ours, skipped = editable(in_scene(scene))
    found = yield from _animated(scene, day, given_before(ours), settings)
    return replace(found, skipped=skipped)


def _animated(
    scene: bpy.types.Scene, day: animation.Day, given: Assignments, settings: Settings
) -> Generator[Progress, None, Outcome]:
    plan, lines = yield from animation.animating(scene, day, given, settings)
    return Outcome(plan.light, [one.result for one in plan.materials], lines=lines)


def exposure(times: SunTimes) -> Generator[Progress, None, Exposure]:
    """Find hours of sun and sky view factors on all surfaces of the open scene, yielding how far
    that is; nothing of the file changes. Raises InputError as `exposing` does."""
    return (yield from exposing(times))


def develop(scene: bpy.types.Scene, settings: Settings) -> bpy.types.World:
    """Return a scene's World, as `developing` does."""
    return run(developing(scene, settings))


def developing(
    scene: bpy.types.Scene, settings: Settings
) -> Generator[Progress, None, bpy.types.World]:
    """Return a scene's World; where its HDRI is a camera's raw, give it one that shows colors.

    Raises InputError as `hdri.develop` does, and for an unknown camera.
    """
    if settings.camera is None:
        return hdri.develop(scene, np.eye(3))
    light = yield from panorama.analyzing(scene.world, settings.sensors)
    return hdri.develop(scene, settings.transfer(light).to_working)


def with_estimated_white(world: bpy.types.World | None, settings: Settings) -> tuple[Settings, str]:
    """Return settings with the white balance that a World's sky seems to have, and a line on it."""
    light = analyzed(world, settings)
    white, line = settle_white(
        AUTO, lambda: estimate_white(light, settings.transfer(light), settings.sun_elevation)
    )
    return replace(settings, white=white), line


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
        return (yield from _animated(scene, day, {**given_before(ours), **given}, settings))
    day_world.stop_unused()
    world = yield from developing(scene, settings)
    plan = yield from planning.making(world, given, settings)
    results = yield from write(plan)
    lines = (yield from relighting(plan)) if relight else []
    return Outcome(plan.light, results, lines=lines)


def making_spectral_with_all_light(
    scene: bpy.types.Scene, given: Assignments, settings: Settings
) -> Generator[Progress, None, Outcome]:
    """Give materials what they are assigned, and bake all light where settings ask for it.

    Raises InputError as `make_spectral` does.
    """
    found = yield from making_spectral(scene, given, settings, settings.shadows != BAKED)
    if settings.shadows != BAKED:
        return found
    lines = yield from all_light(scene, settings)
    return replace(found, lines=[*found.lines, *lines])


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


def bake(
    scene: bpy.types.Scene,
    settings: Settings,
    objects: Collection[bpy.types.Object] | None = None,
    **options: Any,
) -> Generator[Progress, None, list[str]]:
    """Bake all light on objects of the active scene, yielding how far it is.

    ``objects``: None for all of its managed ones; ``options``: those of `scene_bake.bake`. Returns
    lines to read. Raises InputError as `analyzed` does.
    """
    shining = yield from _shining(scene, settings)
    return (yield from _baking(scene, shining, objects, **options))


def _baking(
    scene: bpy.types.Scene,
    shining: SceneLight,
    objects: Collection[bpy.types.Object] | None = None,
    **options: Any,
) -> Generator[Progress, None, list[str]]:
    try:
        lines, seconds = yield from timed(scene_bake.bake(objects, light=shining, **options))
        if not (cost := session.account()) or scene_bake.NOTHING in lines:
            return lines
        return [*lines, f"all light: {cost}, {seconds:.1f} s"]
    finally:
        lighting.refresh(scene.world)  # lamps shine on what stands in for instances, too


def following(scene: bpy.types.Scene, settings: Settings) -> Generator[Progress, None, list[str]]:
    """Let materials and all light follow what has changed in the active scene; returns lines.

    Nothing is done where nothing has. Raises InputError as `update` does.
    """
    lines: list[str] = []
    shining = yield from _shining(scene, settings)
    if not session.is_lit_by(shining):
        chosen, lines = editable(in_scene(scene))
        world = yield from developing(scene, settings)
        yield from write((yield from planning.making(world, given_before(chosen), settings)))
    return lines + (yield from all_light(scene, settings))


def all_light(scene: bpy.types.Scene, settings: Settings) -> Generator[Progress, None, list[str]]:
    """Bake what has no light or an old one in the active scene, or where there is nothing to bake,
    light anew what is baked; returns lines. Raises InputError as `analyzed` does.
    """
    shining = yield from _shining(scene, settings)
    old = yield from scene_bake.finding_stale()
    lines: list[str] = []
    if not any(map(scene_bake.is_waiting, old)):
        lines = yield from scene_bake.relighting(shining)
    return lines + (yield from _baking(scene, shining, old, changed_only=False))


def _shining(scene: bpy.types.Scene, settings: Settings) -> Generator[Progress, None, SceneLight]:
    """Find what shines on a scene now, by the models that its materials have."""
    world = scene.world
    light = yield from panorama.analyzing(world, settings.sensors)
    assert world is not None  # else it had raised
    given = ((material, assigned(material)) for material in in_scene(scene))
    surfaces = {material: one for material, one in given if one is not None and not one.faces}
    _, choice = yield from planning.choosing(light, surfaces, settings)
    found = yield from scene_lighting.finding(world, light, choice.transfer, settings, {})
    return (yield from shining_of(world, found, scene))


def measuring(
    scene: bpy.types.Scene, settings: Settings, places: Places, told: Told | None = None
) -> Generator[Progress, None, Measured]:
    """Measure the light at places of the active scene; returns what meters read there.

    Nothing changes. Raises InputError as `analyzed` and `light_meter.measuring` do.
    """
    shining = yield from _shining(scene, settings)
    return (yield from light_meter.measuring(scene.world, shining, places, told))


def surveying(
    scene: bpy.types.Scene,
    settings: Settings,
    places: Places,
    told: Told | None = None,
    threshold: float | None = None,
) -> Generator[Progress, None, Room]:
    """Measure a floor of the active scene, its daylight factor too; raises as `room.surveying`."""
    shining = yield from _shining(scene, settings)
    return (yield from room.surveying(scene.world, shining, places, told, threshold))


def light_on_surfaces(
    scene: bpy.types.Scene, settings: Settings
) -> Generator[Progress, None, surface_light.Drawing]:
    """Measure the light on all surfaces of the active scene, to draw it; nothing changes.

    Raises InputError as `analyzed` and `calibration.find` do.
    """
    shining = yield from _shining(scene, settings)
    assert scene.world is not None
    known = calibration.find(scene.world, shining)
    lit = yield from mapped(lit_scene.casting(shining), lambda p: Progress(0.5 * p.done, p.line))
    found = yield from surface_light.measuring(lit, shining, known)
    return surface_light.Drawing.of(found)


def picture_of_light(
    scene: bpy.types.Scene,
    settings: Settings,
    quantity: str,
    camera: bpy.types.Object,
    engine: str | None = None,
    told: Told | None = None,
) -> Generator[Progress, None, tuple[NDArray[np.float32], Calibration]]:
    """Return an amount of light as a camera of the active scene sees it; nothing changes.

    As `metered_picture.picturing` does, and raises InputError as that and `analyzed` do.
    """
    shining = yield from _shining(scene, settings)
    return (yield from metered_picture.picturing(scene, shining, quantity, camera, engine, told))


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


def light_lines(scene: bpy.types.Scene) -> list[str]:
    """What shines on a scene's materials, and what a picture must say; none before any."""
    found = light_group.record_of(scene.world)
    return [] if found is None else [*found.lights, *found.warnings, out_of_date.caption(scene)]
