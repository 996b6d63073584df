"""The World of a scene: the sky that it holds, read and made to show colors."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from functools import partial
from pathlib import Path

import bpy
import numpy as np

from ...progress import Progress, aside, run
from ...sky.light import SkyLight
from ...transfer.white import AUTO, estimate_white, settle_white
from ..blend_data import working_space
from ..world import hdri, own_worlds, panorama
from ..world.settings import Settings


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
    yield from checking(settings)
    yield from hdri.setting_sky(scene, path, raw=settings.camera is not None)
    world = yield from developing(scene, settings)
    own_worlds.remove_unused()
    return world


def checking(settings: Settings) -> Generator[Progress, None, None]:
    """Raise InputError for wrong settings."""
    check = partial(settings.transfer, space=working_space.name())
    yield from aside(Progress(0.0, "the sky"), check)


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
