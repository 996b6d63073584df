"""What many reflectances would look like under a World's sky, to choose among them."""

from __future__ import annotations

from collections.abc import Generator

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..progress import Progress, aside, run
from ..spectra.working_spaces import rec709_to_working, srgb
from ..transfer.prediction import rgb_albedo
from ..transfer.swatches import beside
from .blend_data import working_space
from .world import hdri as worlds
from .world import panorama
from .world.settings import Settings


def colours(
    world: bpy.types.World, settings: Settings, reflectances: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return what reflectances (m, 81) show, as `colouring` finds it."""
    return run(colouring(world, settings, reflectances))


def colouring(
    world: bpy.types.World, settings: Settings, reflectances: NDArray[np.float64]
) -> Generator[Progress, None, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Find what reflectances (m, 81) show on level ground and under D65, (m, 3) each.

    RGB in the file's working space, as `transfer.swatches.beside` makes them. Raises InputError as
    `panorama.light_of` does.
    """
    light = yield from panorama.analyzing(world, settings.sensors)
    space = working_space.name()

    def shown():
        return beside(settings.transfer(light, space=space), reflectances, light.faces[0])

    return (yield from aside(panorama.ANALYZING, shown))


def daylight(reflectances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return their colours under D65 alone, (m, 3), white (1, 1, 1)."""
    return rgb_albedo(reflectances, working_space.name())


def on_screen(colour: NDArray[np.float64]) -> list[int]:
    """Return a colour (3,) of the working space as sRGB of 8 bits, cut off outside."""
    to_rec709 = np.linalg.inv(rec709_to_working(working_space.name()))
    found: list[int] = np.rint(255.0 * srgb(to_rec709 @ colour)).astype(int).tolist()
    return found


def sky_key(world: bpy.types.World | None, settings: Settings | None) -> str:
    """Return what tells whether a World's sky, or the working space, is another one than before."""
    if world is None:
        return ""
    try:
        name = worlds.sky_of(world).name
    except InputError:
        return ""
    return f"{world.name_full} {name} {working_space.name()} {settings}"
