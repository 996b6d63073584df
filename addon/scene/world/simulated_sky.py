"""A sky of a date, a place and a weather as the sky of a scene, in the blend file alone."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import asdict, dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ... import tags
from ...choices import QUALITIES, WEATHERS, default
from ...errors import InputError, parameter
from ...progress import Progress, aside
from . import hdri, sky_image

HEIGHT = 512
"""[pixels]. The sun's disc is then one or two wide; its irradiance is exact in any."""


@dataclass(frozen=True)
class SkyPlace:
    """When and where a sky is seen, in which weather, and through what air.

    ``date``, ``time``, ``timezone``, ``latitude`` and ``longitude`` as `sky.sun_position` takes
    them; ``north``: the direction of true north in the scene [degrees], clockwise from +Y as seen
    from above; ``haze``, ``ozone`` and ``ground`` as `sky.atmosphere.Atmosphere` does;
    ``weather``: one of `choices.WEATHERS`; ``cie``: the number of a standard sky; ``epw``: the path
    of a weather file, which says place and time zone itself.
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
    weather: str = "clear"
    cie: int = 1
    epw: str = ""


@dataclass(frozen=True)
class Drawn:
    """A simulated sky as it becomes an image: numbers alone, nothing of Blender.

    ``rgb`` (h, 2 h, 3) in linear Rec.709; ``attributes``: of its EXR; ``elevation``: the sun's
    [degrees]; ``kind``: what the sky is called, empty for a clear one; ``white``: as `white_of`
    has it; ``place`` and ``quality``: what it was made of.
    """

    rgb: NDArray[np.float32]
    attributes: dict[str, Any]
    elevation: float
    kind: str
    white: float
    place: SkyPlace
    quality: str

    @property
    def name(self) -> str:
        """Of the image."""
        return f"Sky {self.place.date} {self.place.time[:5]}"


def drawing(place: SkyPlace, quality: str = default(QUALITIES)) -> Generator[Progress, None, Drawn]:
    """Simulate the sky of a place, its sun included, yielding how far it is.

    The preview takes about a second on two processors. Raises InputError as `sun_position`,
    `Atmosphere`, `read_hour` and `under_weather` do, and for a sun lower than skies are simulated.
    """
    from ...sky.atmosphere import Atmosphere
    from ...sky.clear_sky import SCALE, header_of, picture, white_of
    from ...sky.epw import read_hour
    from ...sky.simulation import LOWEST_SUN, simulating
    from ...sky.sun_position import sun_position
    from ...sky.weather import under_weather
    from ...spectra.sensitivities import observer

    hour = None
    where = place.latitude, place.longitude, place.timezone
    if place.weather == "epw":
        if not place.epw:
            raise InputError(parameter("epw"), "no file is chosen", "choose an EPW weather file")
        hour = read_hour(place.epw, place.date, place.time)
        where = hour.station.latitude, hour.station.longitude, hour.station.timezone
    elevation, azimuth = sun_position(place.date, place.time, *where)
    if elevation < LOWEST_SUN:
        problem = f"the sun is {-elevation:.1f}° below the horizon"
        cure = f"skies are simulated down to {LOWEST_SUN:g}°: give another time"
        raise InputError(parameter("time"), problem, cure)
    cie = place.cie if place.weather == "cie" else None
    if place.weather != "clear" and elevation <= 0.0:
        cure = f"{WEATHERS[place.weather].label} needs one over it: give another time"
        raise InputError(parameter("time"), f"the sun is {-elevation:.1f}° below the horizon", cure)
    air = Atmosphere(haze=place.haze, ozone=place.ozone, ground=place.ground)
    clear = yield from simulating(elevation, air, quality=quality)
    view = azimuth + place.north, elevation > 0.0

    def drawn():
        sky, kind = under_weather(clear, cie=cie, hour=hour)
        rgb = picture(sky, HEIGHT, *view, observer() * SCALE)
        kind = "" if sky is clear else kind
        white = white_of(sky)
        return Drawn(rgb, header_of(sky, *view), elevation, kind, white, place, quality)

    return (yield from aside(Progress(1.0, "sky"), drawn))


def image_of(drawn: Drawn) -> bpy.types.Image:
    """Return a simulated sky as a packed image."""
    made = {"place": asdict(drawn.place), "quality": drawn.quality}
    notes = [drawn.kind] if drawn.kind else []
    return sky_image.simulated(
        drawn.name, drawn.rgb, drawn.attributes, {**made, "notes": notes}, drawn.elevation
    )


def made_of(image: bpy.types.Image) -> tuple[SkyPlace, str] | None:
    """Return the place of a sky that we simulated, and the quality; None of any other image."""
    found = sky_image.made(image)
    try:
        return SkyPlace(**found["place"]), str(found["quality"])
    except (KeyError, TypeError):  # of an earlier version, or overwritten
        return None


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
