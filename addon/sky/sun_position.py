"""Where the sun stands at a time and a place."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo

import numpy as np

from ..errors import InputError, parameter


def sun_position(
    date: str, time: str, latitude: float, longitude: float, zone: str = "UTC"
) -> tuple[float, float]:
    """Return the sun's elevation and azimuth [degrees] at one time: see `sun_positions`."""
    return sun_positions(date, [time], latitude, longitude, zone)[0]


def sun_positions(
    date: str, times: Sequence[str], latitude: float, longitude: float, zone: str = "UTC"
) -> list[tuple[float, float]]:
    """Return the sun's elevation and azimuth [degrees] at each time, clockwise from north.

    By pvlib's solar position algorithm (Reda and Andreas 2004, DOI 10.1016/j.solener.2003.12.003),
    within 0.001°. The elevation is the geometric one: our atmosphere does not refract either.

    Parameters
    ----------
    date, times
        ``2025-06-21``, ``14:30`` or ``14:30:15``, local to ``zone``; the first of two where summer
        time ends.
    latitude, longitude
        [degrees], north and east positive.
    zone
        A name (``Europe/Berlin``), which knows summer time, or hours east of UTC (``+2``,
        ``-03:30``).

    Raises
    ------
    InputError
        What is no date, time, place or zone, a time that clocks skip; and where pvlib is not
        installed.
    """
    if not -90.0 <= latitude <= 90.0:
        raise InputError(parameter("latitude"), f"{latitude:g}°", "give -90 to 90, north positive")
    if not -180.0 <= longitude <= 180.0:
        raise InputError(
            parameter("longitude"), f"{longitude:g}°", "give -180 to 180, east positive"
        )
    moments = [_moment(date, time, zone) for time in times]
    try:
        from pvlib import spa
    except ImportError:
        cure = f"pip install 'spectral-skylight[science]', or give {parameter('sun_elevation')}"
        raise InputError(parameter("date"), "pvlib is not installed", cure) from None
    sea_level = {"elev": 0.0, "pressure": 1013.25, "temp": 15.0, "atmos_refract": 0.5667}
    delta_t = spa.calculate_deltat(moments[0].year, moments[0].month)
    seconds = np.array([moment.timestamp() for moment in moments])
    *_, elevation, azimuth, _ = spa.solar_position(
        seconds, latitude, longitude, delta_t=delta_t, **sea_level
    )
    return list(zip(elevation.tolist(), azimuth.tolist(), strict=True))


def _moment(date: str, time: str, zone: str) -> datetime:
    """Read a local date and time."""
    try:
        moment = datetime.fromisoformat(f"{date}T{time}")
    except ValueError:
        cure = f"give {parameter('date')} YYYY-MM-DD and {parameter('time')} HH:MM"
        raise InputError(
            parameter("date"), f"'{date} {time}' is not a date and time", cure
        ) from None
    moment = moment.replace(tzinfo=_zone(zone))
    try:
        again = moment.astimezone(UTC).astimezone(moment.tzinfo)
    except OverflowError:  # on the first or last day that Python knows
        raise InputError(parameter("date"), f"{date} is too far away", "give another") from None
    if again.time() != moment.time():
        cure = f"summer time begins in {zone}: give an hour later"
        raise InputError(parameter("time"), f"there is no {time} on {date}", cure)
    return moment


def _zone(name: str) -> tzinfo:
    """Read a zone's name or its distance from UTC."""
    sign = {"+": 1, "-": -1}.get(name[:1])
    try:
        if sign is None:
            return ZoneInfo(name)
        hours, _, minutes = name[1:].partition(":")
        return timezone(sign * timedelta(hours=float(hours), minutes=int(minutes or 0)))
    except (ValueError, OverflowError, OSError, KeyError):  # ZoneInfoNotFoundError is a KeyError
        cure = "give a name such as Europe/Berlin, or hours such as +2"
        raise InputError(parameter("timezone"), f"'{name}' is unknown", cure) from None
