"""Which lights a World's materials receive where they stand: the ground under them, neighbours."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from functools import partial

import bpy
import numpy as np
from numpy.typing import NDArray

from ..choices import BAKED, DOME
from ..progress import Progress, aside
from ..sky.light import SkyLight
from ..transfer.matrices import Transfer
from ..transfer.white import AUTO
from .bake import scene_bake, sky_exposure
from .lights import lighting, user_lamps
from .materials import spectral_material
from .world import hdri as worlds
from .world.settings import Settings


def finding(
    world: bpy.types.World,
    light: SkyLight,
    transfer: Transfer,
    settings: Settings,
    reflectances: Mapping[bpy.types.Material, NDArray[np.float64]],
) -> Generator[Progress, None, lighting.Lights]:
    """Find the lights of a World for materials with these reflectances and those it has.

    The ground is chosen by what stands in the World's scene. Raises InputError as `lighting.find`.
    """
    scene = bpy.context.scene  # whose geometry is looked at
    if scene.world != world:
        scene = next(iter(lighting.scenes_of(world)), None)
    known = dict(reflectances)
    for material in spectral_material.managed_materials(world):
        if material not in known:
            managed = spectral_material.managed(material)
            if managed is not None and managed.details.values:
                known[material] = managed.values
    rho = np.array(list(known.values())).reshape(-1, 81)
    find = partial(
        lighting.find,
        lamps=user_lamps.find(scene, transfer, rho) if scene and settings.shadows != DOME else None,
        with_sun=settings.sun,
        ground=(yield from _ground(scene, known, settings)),
        occlusion=settings.shadows,
        traced=settings.traced or _waits(scene, light, settings),
    )
    return (yield from aside(Progress(0.0, "the lights"), find, light, transfer))


def _waits(scene: bpy.types.Scene | None, light: SkyLight, settings: Settings) -> bool:
    """Whether Cycles renders a scene whose light is not baked yet: it traces it until then.

    Not where that is another light: the HDRI's, with its sun and its ground.
    """
    if scene is None or settings.shadows != BAKED or scene.render.engine != "CYCLES":
        return False
    if settings.ground not in (AUTO, "hdri") or (light.sun is not None and not settings.sun):
        return False
    return not scene_bake.baked()


def _ground(scene, known, settings):
    """Return one of `transfer.ground.CHOICES`, or the reflectance (81,) of what lies below."""
    automatic = settings.ground == AUTO
    if settings.traced or (automatic and (settings.shadows == BAKED or scene is None)):
        return "hdri"  # of which Cycles, or a bake, knows how much geometry hides
    if scene is None or not (automatic or settings.ground == "modelled"):
        return settings.ground
    covered, below = yield from sky_exposure.looking_below(list(known))
    if automatic and not covered:
        return "hdri"
    return "modelled" if below is None else known.get(below, "modelled")


def towards_sun(
    world: bpy.types.World, light: SkyLight, settings: Settings
) -> NDArray[np.float64] | None:
    """Return where a World's sun stands, (3,), None without one that shines."""
    sun = light.sun if settings.sun else None
    return None if sun is None else worlds.in_world(worlds.sky_of(world), sun.direction)
