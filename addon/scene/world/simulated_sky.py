"""A clear sky of a date and a place as the sky of a scene, in the blend file alone."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import bpy

from ... import tags
from ...errors import InputError, parameter
from ...progress import Progress, aside
from . import hdri, sky_image

HEIGHT = 512
"""[pixels]. The sun's disc is then one or two wide; its irradiance is exact in any."""


@dataclass(frozen=True)
class SkyPlace:
    """When and where a sky is seen, and through what air.

    ``date``, ``time``, ``timezone``, ``latitude`` and ``longitude`` as `sky.sun_position` takes
    them; ``north``: the direction of true north in the scene [degrees], clockwise from +Y as seen
    from above; ``haze``, ``ozone`` and ``ground`` as `sky.atmosphere.Atmosphere` does.
    """

    date: str
    time: str
    timezone: str
    latitude: float
    longitude: float
    north: float = 0.0
    haze: float = 0.05
    ozone: float = 300.0
    ground: float = 0.2


def imaging(place: SkyPlace) -> Generator[Progress, None, bpy.types.Image]:
    """Simulate the sky of a place, its sun included, and return it as a packed image.

    About a second on two processors. Raises InputError as `sun_position` and `Atmosphere` do, and
    for a sun lower than skies are simulated; nothing is made then.
    """
    from ...sky.atmosphere import Atmosphere
    from ...sky.clear_sky import SCALE, header_of, picture
    from ...sky.simulation import LOWEST_SUN, simulate
    from ...sky.sun_position import sun_position
    from ...spectra.sensitivities import observer

    where = (place.date, place.time, place.latitude, place.longitude, place.timezone)
    elevation, azimuth = sun_position(*where)
    if elevation < LOWEST_SUN:
        problem = f"the sun is {-elevation:.1f}° below the horizon"
        cure = f"skies are simulated down to {LOWEST_SUN:g}°: give another time"
        raise InputError(parameter("time"), problem, cure)
    air = Atmosphere(haze=place.haze, ozone=place.ozone, ground=place.ground)
    view = azimuth + place.north, elevation > 0.0
    name = f"Sky {place.date} {place.time[:5]}"

    def simulated():
        sky = simulate(elevation, air)
        return picture(sky, HEIGHT, *view, observer() * SCALE), header_of(sky, *view)

    rgb, header = yield from aside(Progress(0.0, name), simulated)
    return sky_image.simulated(name, rgb, header, elevation)


def light(scene: bpy.types.Scene, image: bpy.types.Image) -> bpy.types.World:
    """Light a scene by an image of `imaging` and return its World.

    A World of ours that shows such an image, to no other scene, is kept with what was set there;
    otherwise the scene gets a new one, as by `hdri.set_sky`.
    """
    world = scene.world
    ours = world is not None and tags.OWN_WORLD in world and world.is_editable
    if not ours or _lights_another(world, scene):
        return hdri.show(scene, image)
    sky = hdri.sky_of(world)
    if sky.image is None or sky_image.sun_elevation(sky.image) is None:
        return hdri.show(scene, image)
    before = sky.image
    named_alike = world.name == before.name
    world.node_tree.nodes[sky.texture].image = image
    if before.users == 0:
        # The same hour in other air: Blender has numbered the new image.
        name = before.name if image.name.startswith(before.name) else image.name
        bpy.data.images.remove(before)
        image.name = name
    if named_alike:
        world.name = image.name
    return world


def _lights_another(world: bpy.types.World, scene: bpy.types.Scene) -> bool:
    return any(each.world == world for each in bpy.data.scenes if each != scene)
