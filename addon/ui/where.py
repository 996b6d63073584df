"""Where on earth a sky is seen: the fields of a place, for whatever has one."""

# No postponed annotations here: Blender reads properties from them.
# mypy: disable-error-code="valid-type"

import bpy

from ..errors import InputError

NEAR = 0.01
"""[degrees] from a city that is still there: as its place is rounded."""


def _cities(self, context, typed) -> list[str]:
    """Cities whose name begins with what is typed."""
    from ..sky import cities

    return cities.suggestions(typed)


def _go_to_city(self, context) -> None:
    """Take place and time zone of the city; a name that no city has is not kept."""
    from ..sky import cities

    if not self.city:
        return
    try:
        found = cities.city(self.city)
    except InputError:
        self.city = ""
        return
    if self.city == found.label and self.timezone == found.timezone and not _is_away(self, found):
        return
    self.city = ""  # each of these would say that it is left
    self.latitude, self.longitude, self.timezone = found.latitude, found.longitude, found.timezone
    self.city = found.label  # which comes here once more


def _leave_city(self, context) -> None:
    """A place that was typed is no longer the city's."""
    from ..sky import cities

    if not self.city:
        return
    try:
        found = cities.city(self.city)
    except InputError:
        return
    if _is_away(self, found):
        self.city = ""


def _is_away(chosen, city) -> bool:
    """Whether a place is not in a city."""
    away = abs(chosen.latitude - city.latitude), abs(chosen.longitude - city.longitude)
    return max(away) > NEAR


def _zones(self, context, typed) -> list[str]:
    """Names of time zones, listed when the field is opened."""
    from ..sky import time_zones

    return time_zones.names()


class Where:
    """A city, or latitude and longitude; the time zone; and where north is in the scene."""

    timezone: bpy.props.StringProperty(
        name="Time Zone",
        description="Name such as Europe/Berlin, which includes daylight saving time, or hours "
        "east of UTC such as +2",
        default="UTC",
        search=_zones,
        search_options={"SUGGESTION"},
    )
    city: bpy.props.StringProperty(
        name="City",
        description="City whose place and time zone to take. Type the first letters of its name",
        search=_cities,
        search_options={"SUGGESTION"},
        update=_go_to_city,
    )
    latitude: bpy.props.FloatProperty(
        name="Latitude",
        description="Latitude in degrees, north is positive",
        min=-90.0,
        max=90.0,
        precision=4,
        update=_leave_city,
    )
    longitude: bpy.props.FloatProperty(
        name="Longitude",
        description="Longitude in degrees, east is positive",
        min=-180.0,
        max=180.0,
        precision=4,
        update=_leave_city,
    )
    north: bpy.props.FloatProperty(
        name="North",
        description="Direction of true north in degrees, clockwise from +Y as seen from above",
        min=-360.0,
        max=360.0,
        precision=2,
    )


def draw(column: bpy.types.UILayout, chosen: Where, asks: bool = False) -> None:
    """Show where it is; ``asks``: whether a city can be typed at once."""
    row = column.row(align=True)
    row.activate_init = asks
    row.prop(chosen, "city")
    for name in ("latitude", "longitude", "timezone"):
        column.prop(chosen, name)
