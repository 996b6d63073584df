"""When and where the sky of a scene is seen, as `scene.skylight_place`."""

# No postponed annotations here: Blender reads properties from them.
# mypy: disable-error-code="valid-type"

import datetime
import json
import math
import sys
from typing import Any

import bpy

from ..choices import STANDARD_SKIES, WEATHERS, items
from ..errors import InputError
from . import where


def _go_to_station(self, context) -> None:
    """Take place and time zone of a weather file; what is wrong with it is said when it is used."""
    from ..sky.epw import read_station

    if not self.epw:
        return
    try:
        found = read_station(bpy.path.abspath(self.epw))
    except InputError:
        return
    self.city = ""
    self.latitude, self.longitude, self.timezone = found.latitude, found.longitude, found.timezone


class SkylightPlace(where.Where, bpy.types.PropertyGroup):
    """Date, time, place, weather and air of a simulated sky."""

    year: bpy.props.IntProperty(
        name="Year", description="Year in the Gregorian calendar", min=1, max=3000, default=2025
    )
    month: bpy.props.IntProperty(name="Month", description="Month", min=1, max=12, default=6)
    day: bpy.props.IntProperty(name="Day", description="Day", min=1, max=31, default=21)
    time: bpy.props.FloatProperty(
        name="Local Time",
        description="Local time in hours. 14.5 is half past two in the afternoon",
        min=0.0,
        max=23.9999,
        step=25,
        precision=3,
        default=12.0,
    )
    weather: bpy.props.EnumProperty(
        name="Weather", description="What clouds and haze make of the sky", items=items(WEATHERS)
    )
    cie: bpy.props.EnumProperty(
        name="CIE Sky",
        description="Standard general sky, ISO 15469",
        items=items(STANDARD_SKIES),
    )
    epw: bpy.props.StringProperty(
        name="EPW File",
        description="EnergyPlus weather file. It says place and time zone; the time is its "
        "standard time all year, and the hour is the one that the time falls in",
        subtype="FILE_PATH",
        update=_go_to_station,
    )
    haze: bpy.props.FloatProperty(
        name="Haze",
        description="Aerosol optical depth at 550 nm. 0.02 is very clear air, 0.1 clear, 0.3 hazy",
        min=0.0,
        max=5.0,
        soft_max=0.5,
        step=1,
        precision=3,
        default=0.05,
    )
    ozone: bpy.props.FloatProperty(
        name="Ozone",
        description="Ozone column in Dobson units. It matters most for a low sun",
        min=0.0,
        max=1000.0,
        precision=0,
        default=300.0,
    )
    ground: bpy.props.FloatProperty(
        name="Ground",
        description="Reflectance of the ground all around. It lights the sky and fills the sky's "
        "lower half",
        min=0.0,
        max=1.0,
        precision=2,
        default=0.2,
    )
    taken: bpy.props.StringProperty(
        description="Values that were last taken over from other add-ons", options={"HIDDEN"}
    )


def is_chosen(chosen: SkylightPlace) -> bool:
    """Whether anybody has said where: else a city is the first thing to type."""
    return any(chosen.is_property_set(name) for name in ("city", "latitude", "longitude", "epw"))


def draw(layout: bpy.types.UILayout, chosen: SkylightPlace, asks: bool = False) -> None:
    """Show the fields: where, when, in which weather, through what air.

    ``asks``: whether a city can be typed at once.
    """
    layout.use_property_split = True
    layout.use_property_decorate = False
    column = layout.column(align=True)
    column.enabled = chosen.weather != "epw"  # which says them itself
    where.draw(column, chosen, asks)
    layout.prop(chosen, "north")
    column = layout.column(align=True)
    for name in ("year", "month", "day", "time"):
        column.prop(chosen, name)
    column = layout.column(align=True)
    column.prop(chosen, "weather")
    if chosen.weather != "clear":
        column.use_property_split = False  # the names of skies are long
        column.prop(chosen, chosen.weather, text="")
    column = layout.column(align=True)
    for name in ("haze", "ozone", "ground"):
        column.prop(chosen, name)


def sky_place(chosen: SkylightPlace):
    """The `scene.world.simulated_sky.SkyPlace` that a scene's properties describe."""
    from ..scene.world.simulated_sky import SkyPlace

    seconds = min(round(chosen.time * 3600), 86399)
    minutes, second = divmod(seconds, 60)
    # Blender's floats are of single precision: 48.1 is 48.09999847.
    numbers = {
        name: round(getattr(chosen, name), 6)
        for name in ("latitude", "longitude", "north", "haze", "ozone", "ground")
    }
    return SkyPlace(
        date=f"{chosen.year:04}-{chosen.month:02}-{chosen.day:02}",
        time=f"{minutes // 60:02}:{minutes % 60:02}:{second:02}",
        timezone=chosen.timezone.strip(),
        weather=chosen.weather,
        cie=int(chosen.cie),
        epw=bpy.path.abspath(chosen.epw) if chosen.epw else "",
        **numbers,
    )


def take_over(scene: bpy.types.Scene) -> None:
    """Take date and place from the add-ons Sun Position and Bonsai where they have changed.

    What a user typed here since stays as long as nothing changes there.
    """
    found = {**_of_sun_position(scene), **_of_ifc()}
    text = json.dumps(found, sort_keys=True)
    chosen = scene.skylight_place
    if not found or chosen.taken == text:
        return
    for name, value in found.items():
        setattr(chosen, name, value)
    chosen.taken = text


def _of_sun_position(scene: bpy.types.Scene) -> dict[str, Any]:
    """What the add-on Sun Position has; empty where no place was set in it."""
    sun = getattr(scene, "sun_pos_properties", None)
    if sun is None or not (sun.is_property_set("latitude") or sun.is_property_set("longitude")):
        return {}
    month, day = sun.month, sun.day
    if sun.use_day_of_year:
        date = datetime.date(sun.year, 1, 1) + datetime.timedelta(days=sun.day_of_year - 1)
        month, day = date.month, date.day
    return {
        "year": sun.year,
        "month": month,
        "day": day,
        "time": sun.time,
        "timezone": f"{sun.UTC_zone + sun.use_daylight_savings:+g}",
        "latitude": sun.latitude,
        "longitude": sun.longitude,
        "north": math.degrees(sun.north_offset),
    }


def _of_ifc() -> dict[str, Any]:
    """What the IFC project that Bonsai has open says of its site and of true north."""
    bonsai = sys.modules.get("bonsai.tool")
    file = None if bonsai is None else bonsai.Ifc.get()
    return {} if file is None else of_project(file)


def of_project(file: Any) -> dict[str, float]:
    """Read latitude, longitude and north [degrees] from an IFC project.

    ``file``: an `ifcopenshell.file`. IfcSite has degrees, minutes, seconds and millionths, all of
    one sign (IfcCompoundPlaneAngleMeasure); TrueNorth of the model's context is a direction in it.
    """
    found = {}
    for site in file.by_type("IfcSite"):
        if site.RefLatitude and site.RefLongitude:
            found["latitude"] = _degrees(site.RefLatitude)
            found["longitude"] = _degrees(site.RefLongitude)
            break
    for context in file.by_type("IfcGeometricRepresentationContext"):
        # Sub-contexts derive it from their parent.
        if context.is_a() == "IfcGeometricRepresentationContext" and context.TrueNorth:
            x, y = context.TrueNorth.DirectionRatios[:2]
            found["north"] = math.degrees(math.atan2(x, y))
            break
    return found


def _degrees(parts: Any) -> float:
    return sum(part / size for part, size in zip(parts, (1, 60, 3600, 3.6e9), strict=False))


CLASSES = (SkylightPlace,)


def attach() -> None:
    """Give scenes their place."""
    bpy.types.Scene.skylight_place = bpy.props.PointerProperty(type=SkylightPlace)


def detach() -> None:
    """Take it off again; what it holds stays in the file."""
    del bpy.types.Scene.skylight_place
