"""All light of a scene: baked, and following what changes."""

from __future__ import annotations

import math
from collections.abc import Collection, Generator
from dataclasses import replace
from typing import Any

import bpy

from ... import tags
from ...choices import ALL_LIGHT, BAKED, OPEN
from ...progress import Progress, timed
from .. import out_of_date, scene_lighting
from .. import plan as planning
from ..bake import scene_bake, session
from ..bake.least_light import LeastLight, least_light
from ..bake.light import SceneLight, shining_of
from ..bake.sounding import sounding
from ..day import animate as animation
from ..lights import lighting
from ..materials import spectral_material
from ..materials.assigned import assigned
from ..outcome import Outcome
from ..plan import Assignments
from ..world import light_group, panorama
from ..world.settings import Settings
from ..write import write
from .materials import editable, given_before, in_scene, making_spectral, updating
from .world import developing

_chosen: list[LeastLight] = []

_open: list[bytes] = []
"""`SceneLight.key` of the light that the open sky shows, where that was found to be enough."""


def making_spectral_with_all_light(
    scene: bpy.types.Scene, given: Assignments, settings: Settings
) -> Generator[Progress, None, Outcome]:
    """Give materials what they are assigned, and bake all light where settings ask for it.

    Raises InputError as `make_spectral` does.
    """
    with_light = settings.occlusion in ALL_LIGHT
    found = yield from making_spectral(scene, given, settings, not with_light)
    if not with_light:
        return found
    lines = yield from all_light(scene, settings)
    return replace(found, lines=[*found.lines, *lines])


def bake(
    scene: bpy.types.Scene,
    settings: Settings,
    objects: Collection[bpy.types.Object] | None = None,
    **options: Any,
) -> Generator[Progress, None, list[str]]:
    """Bake all light on objects of the active scene, yielding how far it is.

    ``objects``: None for all of its managed ones; ``options``: those of `scene_bake.bake`. Returns
    lines to read. Under a sky that moves, all of it is baked. Raises InputError as `analyzed` does.
    """
    if animation.day_of(scene.world) is not None:
        return (yield from _of_day(scene, settings, options.get("changed_only", True)))
    shining = yield from shining_on(scene, settings)
    options = {"error": settings.tolerance, **options}
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
    if animation.day_of(scene.world) is not None:
        return (yield from _of_day(scene, settings))
    lines: list[str] = []
    shining = yield from shining_on(scene, settings)
    if not (session.is_lit_by(shining) or _key(scene, shining) in _open):
        lines = yield from _showing(scene, settings)
        shining = yield from shining_on(scene, settings)
    return lines + (yield from _lighting(scene, settings, shining))


def all_light(scene: bpy.types.Scene, settings: Settings) -> Generator[Progress, None, list[str]]:
    """Bake what has no light or an old one in the active scene, or where there is nothing to bake,
    light anew what is baked; returns lines. Raises InputError as `analyzed` does.
    """
    if animation.day_of(scene.world) is not None:
        return (yield from _of_day(scene, settings))
    return (yield from _lighting(scene, settings, (yield from shining_on(scene, settings))))


def _of_day(
    scene: bpy.types.Scene, settings: Settings, changed_only: bool = True
) -> Generator[Progress, None, list[str]]:
    """Bake all light of a sky that moves, where any of it is old; returns lines."""
    old = yield from scene_bake.finding_stale()
    if changed_only and tags.BAKED_KEY in scene.world and not any(map(scene_bake.is_waiting, old)):
        return [scene_bake.NOTHING]
    settings = replace(settings, occlusion=BAKED)
    return (yield from updating(scene, settings)).lines


def _lighting(
    scene: bpy.types.Scene, settings: Settings, shining: SceneLight
) -> Generator[Progress, None, list[str]]:
    lines: list[str] = []
    least = None
    _chosen.clear()
    _open.clear()
    if settings.is_choosing:
        # What shines under the open sky and on a bake, of which one is known.
        known = {settings.least: shining}
        for each in {None, OPEN} - {settings.least}:
            known[each] = yield from shining_on(scene, replace(settings, least=each))
        least = yield from _choosing(scene, settings, known[None], known[OPEN])
        enough = OPEN if least is not None and least.light == OPEN else None
        shining = known[enough]
        if enough != settings.least:
            settings = replace(settings, least=enough)
            lines = yield from _showing(scene, settings)
        if least is not None and enough == OPEN:
            scene_bake.remove()
            session.forget()
            _open[:] = [_key(scene, shining)]
            return [*lines, least.line]
    old = yield from scene_bake.finding_stale()
    if not any(map(scene_bake.is_waiting, old)):
        if session.holds(least):
            lines += yield from scene_bake.relighting(shining)
        else:
            old = scene_bake.targets()
    options = {"changed_only": False, "error": settings.tolerance, "least": least}
    return lines + (yield from _baking(scene, shining, old, **options))


def _key(scene: bpy.types.Scene, shining: SceneLight) -> bytes:
    return shining.key([material.name_full for material in in_scene(scene)])


def _choosing(
    scene: bpy.types.Scene, settings: Settings, shining: SceneLight, opened: SceneLight
) -> Generator[Progress, None, LeastLight | None]:
    """Find the least light that keeps to the tolerance, by what shines ``shining`` on a bake and
    ``opened`` under the open sky; None where no picture tells."""
    found = yield from sounding(shining, opened.sky, errors_of_models(scene))
    if found is not None:
        _chosen.append(least_light(found, settings.tolerance or 0.0))
    return _chosen[0] if _chosen else None


def chosen_light() -> dict[str, Any] | None:
    """The light that a tolerance has chosen last, as plain data: `LeastLight`; None without."""
    return _chosen[0].plain() if _chosen else None


def errors_of_models(scene: bpy.types.Scene) -> dict[str, float]:
    """The CIEDE2000 that is expected of each managed material's matrix, by its full name; 0 where
    none could be predicted."""
    errors = {}
    for material in in_scene(scene):
        managed = spectral_material.managed(material)
        result = None if managed is None else managed.details.result
        known = result is not None and math.isfinite(result.matrix_delta_E)
        errors[material.name_full] = result.matrix_delta_E if result and known else 0.0
    return errors


def _showing(scene: bpy.types.Scene, settings: Settings) -> Generator[Progress, None, list[str]]:
    """Let materials show what they have by these settings; returns lines."""
    chosen, lines = editable(in_scene(scene))
    world = yield from developing(scene, settings)
    yield from write((yield from planning.making(world, given_before(chosen), settings)))
    return lines


def shining_on(scene: bpy.types.Scene, settings: Settings) -> Generator[Progress, None, SceneLight]:
    """Find what shines on a scene now, by the models that its materials have."""
    world = scene.world
    light = yield from panorama.analyzing(world, settings.sensors)
    assert world is not None  # else it had raised
    given = ((material, assigned(material)) for material in in_scene(scene))
    surfaces = {material: one for material, one in given if one is not None and not one.faces}
    _, choice = yield from planning.choosing(light, surfaces, settings)
    found = yield from scene_lighting.finding(world, light, choice.transfer, settings, {})
    return (yield from shining_of(world, found, scene))


def light_lines(scene: bpy.types.Scene) -> list[str]:
    """What shines on a scene's materials, and what a picture must say; none before any."""
    found = light_group.record_of(scene.world)
    return [] if found is None else [*found.lights, *found.warnings, out_of_date.caption(scene)]
