"""What light there is in a scene, at places and on surfaces; nothing changes."""

from __future__ import annotations

from collections.abc import Generator

import bpy
import numpy as np
from numpy.typing import NDArray

from ...progress import Progress, mapped
from ..meter import calibration, light_meter, lit_scene, metered_picture, room, surface_light
from ..meter.calibration import Calibration, Told
from ..meter.exposure import Exposure, SunTimes, exposing
from ..meter.light_meter import Measured
from ..meter.places import Places
from ..meter.room import Room
from ..world.settings import Settings
from .light import shining_on


def measuring(
    scene: bpy.types.Scene, settings: Settings, places: Places, told: Told | None = None
) -> Generator[Progress, None, Measured]:
    """Measure the light at places of the active scene; returns what meters read there.

    Nothing changes. Raises InputError as `analyzed` and `light_meter.measuring` do.
    """
    shining = yield from shining_on(scene, settings)
    return (yield from light_meter.measuring(scene.world, shining, places, told))


def surveying(
    scene: bpy.types.Scene,
    settings: Settings,
    places: Places,
    told: Told | None = None,
    threshold: float | None = None,
) -> Generator[Progress, None, Room]:
    """Measure a floor of the active scene, its daylight factor too; raises as `room.surveying`."""
    shining = yield from shining_on(scene, settings)
    return (yield from room.surveying(scene.world, shining, places, told, threshold))


def light_on_surfaces(
    scene: bpy.types.Scene, settings: Settings
) -> Generator[Progress, None, surface_light.Drawing]:
    """Measure the light on all surfaces of the active scene, to draw it; nothing changes.

    Raises InputError as `analyzed` and `calibration.find` do.
    """
    shining = yield from shining_on(scene, settings)
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
    shining = yield from shining_on(scene, settings)
    return (yield from metered_picture.picturing(scene, shining, quantity, camera, engine, told))


def exposure(times: SunTimes) -> Generator[Progress, None, Exposure]:
    """Find hours of sun and sky view factors on all surfaces of the open scene, yielding how far
    that is; nothing of the file changes. Raises InputError as `exposing` does."""
    return (yield from exposing(times))
