"""Where the sun stands at a local time of a place."""

from __future__ import annotations

import calendar
import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta, timezone, tzinfo

import numpy as np

from ..errors import InputError, parameter
from .solar_position import solar_position
from .time_zones import time_zone

LAST_YEAR = 3000
"""How far `solar_position` has been compared."""


def sun_position(
    date: str, time: str, latitude: float, longitude: float, zone: str = "UTC"
) -> tuple[float, float]:
    """Return the sun's elevation and azimuth [degrees] at one time: see `sun_positions`."""
    return sun_positions(date, [time], latitude, longitude, zone)[0]


def sun_positions(
    date: str, times: Sequence[str], latitude: float, longitude: float, zone: str = "UTC"
) -> list[tuple[float, float]]:
    """Return the sun's elevation and azimuth [degrees] at each time, clockwise from north.

    By `solar_position`. The elevation is the geometric one: our atmosphere does not refract either.

    Parameters
    ----------
    date, times
        ``2025-06-21``, ``14:30`` or ``14:30:15``, local to ``zone``, in the Gregorian calendar.
    latitude, longitude
        [degrees], north and east positive.
    zone
        A name (``Europe/Berlin``), which knows summer time, or hours east of UTC (``+2``,
        ``-03:30``).

    Raises
    ------
    InputError
        What is no date, time, place or zone, a date after `LAST_YEAR`, and a time that clocks skip
        or have twice.
    """
    if not -90.0 <= latitude <= 90.0:
        raise InputError(parameter("latitude"), f"{latitude:g}°", "give -90 to 90, north positive")
    if not -180.0 <= longitude <= 180.0:
        raise InputError(
            parameter("longitude"), f"{longitude:g}°", "give -180 to 180, east positive"
        )
    moments = [local_moment(date, time, zone) for time in times]
    seconds = np.array([moment.timestamp() for moment in moments])
    elevation, azimuth = solar_position(seconds, latitude, longitude)
    return list(zip(elevation.tolist(), azimuth.tolist(), strict=True))


def local_moment(date: str, time: str, zone: str = "UTC") -> datetime:
    """Return a local date and time with its zone; arguments and errors as `sun_positions` has."""
    cure = f"give {parameter('date')} YYYY-MM-DD and {parameter('time')} HH:MM"
    try:
        moment = datetime.fromisoformat(f"{date}T{time}")
    except ValueError:
        leap = re.fullmatch(r"(\d{4})-02-29", date)
        if leap and not calendar.isleap(int(leap[1])):
            raise InputError(
                parameter("date"), f"{leap[1]} is no leap year", "give another day"
            ) from None
        raise InputError(
            parameter("date"), f"'{date} {time}' is not a date and time", cure
        ) from None
    if moment.tzinfo is not None:
        cure = f"give that as {parameter('timezone')}"
        raise InputError(parameter("time"), f"'{time}' has a time zone in it", cure)
    if moment.year > LAST_YEAR:
        raise InputError(parameter("date"), f"{date} is too far away", f"give 1 to {LAST_YEAR}")
    moment = moment.replace(tzinfo=_zone(zone))
    try:
        again = moment.astimezone(UTC).astimezone(moment.tzinfo)
    except OverflowError:  # on the first day that Python knows
        raise InputError(parameter("date"), f"{date} is too far away", "give another") from None
    later = moment.replace(fold=1)  # by what holds after the clocks are changed
    summer_time = later.dst() != moment.dst()
    if again.replace(tzinfo=None) != moment.replace(tzinfo=None):
        cure = f"clocks are put forward in {zone}: give a later time or day"
        if summer_time:
            cure = f"summer time begins in {zone}: give an hour later"
        raise InputError(parameter("time"), f"there is no {time} on {date}", cure)
    if later.utcoffset() != moment.utcoffset():
        why = "summer time ends" if summer_time else "clocks are put back"
        cure = f"{why} in {zone}: give {parameter('timezone')} in hours, "
        cure += f"{_hours(moment.utcoffset())} or {_hours(later.utcoffset())}"
        raise InputError(parameter("time"), f"{time} comes twice on {date}", cure)
    return moment


def _hours(offset: timedelta | None) -> str:
    """Write a distance from UTC as `_zone` reads it."""
    assert offset is not None
    minutes = round(offset.total_seconds() / 60)
    return f"{'-' if minutes < 0 else '+'}{abs(minutes) // 60}:{abs(minutes) % 60:02}"


def _zone(name: str) -> tzinfo:
    """Read a zone's name or its distance from UTC."""
    if name == "UTC":  # which needs no tables
        return UTC
    given = re.fullmatch(r"([+-])(\d{1,2}(?:\.\d+)?)(?::([0-5]\d))?", name)
    try:
        if given is None:
            return time_zone(name)
        distance = timedelta(hours=float(given[2]), minutes=int(given[3] or 0))
        return timezone(-distance if given[1] == "-" else distance)
    except (ValueError, KeyError):
        cure = "give a name such as Europe/Berlin, or hours such as +2"
        raise InputError(parameter("timezone"), f"'{name}' is unknown", cure) from None
