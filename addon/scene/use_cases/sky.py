"""Another sky for a scene, by a file or by date and place, and the materials that follow it."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from pathlib import Path

import bpy

from ...progress import Progress, run
from ..day import animate as animation
from ..outcome import Outcome
from ..world import hdri, own_worlds, simulated_sky, view_exposure
from ..world.settings import Settings, store
from .materials import animated, editable, given_before, in_scene, updating
from .world import checking, setting_sky


def load_sky(scene: bpy.types.Scene, path: str | Path, settings: Settings) -> Outcome:
    """Light a scene by an HDRI file, as `loading_sky` does."""
    return run(loading_sky(scene, path, settings))


def loading_sky(
    scene: bpy.types.Scene, path: str | Path, settings: Settings, relight: bool = True
) -> Generator[Progress, None, Outcome]:
    """Light a scene by an HDRI file, and let its spectral materials follow; ``relight`` as in
    `making_spectral`.

    Raises InputError as `set_sky` does; the scene is untouched then.
    """
    yield from checking(settings)
    ours, skipped = editable(in_scene(scene))
    yield from setting_sky(scene, path, settings)
    view_exposure.give_back(scene)  # it was for another sky
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

    The view's exposure follows, as `view_exposure.expose` says. Raises InputError as
    `simulated_sky.drawing` and `showing_sky` do; the scene is untouched then.
    """
    drawn = yield from simulated_sky.drawing(place)
    found = yield from showing_sky(scene, drawn, settings, relight)
    line = view_exposure.expose(scene, drawn.white * hdri.strength(scene.world))
    return replace(found, lines=[*found.lines, line]) if line else found


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
    yield from checking(settings)
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
    found = yield from animated(scene, day, given_before(ours), settings)
    return replace(found, skipped=skipped)
