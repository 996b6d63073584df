"""The sun's paths over the sky of a place, seen from above as in a plan.

A stereographic sun-path diagram: a direction at the angle z from the zenith is drawn R tan(z / 2)
from the middle, so that paths are arcs of circles (S. V. Szokolay 2007, *Solar Geometry*, PLEA
Note 1). East is on the right, as on a map. Hours are those of the clock on the day that is shown,
summer time included, so that they fit its path; a line joins the sun's places at one hour of the
clock all year, solid from winter to summer and dashed on the way back.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..sky.solar_position import solar_position
from .canvas import Canvas
from .sky_map import MARKS, SUN
from .theme import DARK, Theme

SIZE = 480.0
"""Side of the picture [units]."""
MIDDLE, RADIUS = SIZE / 2, 180.0
"""Of the horizon's circle [units]."""

ARCS = ("Dec", "Jan", "Feb", "Mar", "Apr", "May", "Jun")
"""Months of which the path on the 21st is drawn; the others' are nearly the same."""

_MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"]
_TEXT, _SMALL = 17.0, 13.5


@dataclass(frozen=True)
class Heliodon:
    """The sun's paths at a place, around one moment of its clock.

    ``moment``: with its distance from UTC; ``latitude`` and ``longitude`` [degrees]; ``north``: the
    direction of true north in the picture [degrees], clockwise from its upper edge.
    """

    moment: datetime
    latitude: float
    longitude: float
    north: float = 0.0

    def sun(self, moments: ArrayLike) -> tuple[NDArray, NDArray]:
        """Return elevations and azimuths [degrees] at moments (n,), UTC in seconds since 1970."""
        return solar_position(moments, self.latitude, self.longitude)

    def now(self) -> tuple[float, float]:
        """Return elevation and azimuth [degrees] at the moment itself."""
        elevation, azimuth = self.sun(self.moment.timestamp())
        return float(elevation), float(azimuth)

    def day(self, month: int, day: int) -> NDArray[np.float64]:
        """Return the moments of a day of the moment's year, every twelve minutes (121,)."""
        return self.at(month, day, 0) + 720.0 * np.arange(121)

    def hour(self, hour: int) -> NDArray[np.float64]:
        """Return an hour's moments, every sixth day from one December to the next (62,)."""
        return self.at(1, 1, hour) + 86400.0 * (6.0 * np.arange(62) - 11.0)

    def at(self, month: int, day: int, hour: int) -> float:
        """Return the moment of an hour of the clock in the moment's year."""
        zone = self.moment.utcoffset() or timedelta()
        clock = datetime(self.moment.year, month, day, hour, tzinfo=UTC)
        return (clock - zone).timestamp()

    def place(self, elevation: ArrayLike, azimuth: ArrayLike) -> tuple[NDArray, NDArray]:
        """Return where directions [degrees] are in the picture, x and y [units]."""
        distance = RADIUS * np.tan(np.radians(90.0 - np.asarray(elevation, float)) / 2)
        turn = np.radians(np.asarray(azimuth, float) + self.north)
        return MIDDLE + distance * np.sin(turn), MIDDLE - distance * np.cos(turn)


def heliodon(
    shown: Heliodon, title: str = "", *, theme: Theme = DARK, scale: float = 1.0
) -> NDArray[np.uint8]:
    """Draw the sun's paths: of the 21st of months, of the day shown, and where the sun stands.

    ``title``: the place's name; ``scale``: pixels a unit. Returns sRGB, (h, h, 3).
    """
    canvas = Canvas(SIZE, SIZE, scale, theme.paper)
    _dome(canvas, shown, theme)
    for hour in range(24):
        _hour(canvas, shown, hour, theme)
    for month in ARCS:
        _arc(canvas, shown, month, theme)
    for x, y in _above(shown, shown.day(shown.moment.month, shown.moment.day)):
        canvas.line(x, y, theme.today, 3.0)
    _hours_of_day(canvas, shown, theme)
    _sun(canvas, shown, theme)
    _words(canvas, shown, title, theme)
    return canvas.pixels


def _dome(canvas: Canvas, shown: Heliodon, theme: Theme) -> None:
    """Draw the horizon, circles of elevation, and the compass."""
    turn = np.linspace(0.0, 360.0, 181)
    canvas.disc(MIDDLE, MIDDLE, RADIUS, theme.cell)
    for elevation in range(0, 90, 10):
        main = elevation % 30 == 0
        canvas.line(*shown.place(elevation, turn), theme.faint, 1.0, opacity=0.7 if main else 0.25)
    for azimuth in range(0, 360, 10):
        out = -1.0 if azimuth % 30 else -2.0
        canvas.line(*shown.place([0.0, out], azimuth), theme.faint, 1.0)
        if azimuth % 30 == 0:
            canvas.line(*shown.place([0.0, 80.0], azimuth), theme.faint, 1.0, opacity=0.25)
    for elevation in (30, 60):
        x, y = shown.place(elevation, 0.0)
        canvas.text(float(x), float(y) + 5, f"{elevation}°", _SMALL, theme.faint, 0.5)


def _above(shown: Heliodon, moments: NDArray) -> list[tuple[NDArray, NDArray]]:
    """Return what of a path lies over the horizon, as lines of x and y; they end on it."""
    elevation, azimuth = shown.sun(moments)
    up = elevation > 0.0
    starts = [0, *(np.flatnonzero(up[1:] != up[:-1]) + 1), len(moments)]
    lines = []
    for start, end in pairwise(starts):
        if up[start]:
            part = slice(max(start - 1, 0), end + 1)
            lines.append(_cut(elevation[part], *shown.place(elevation[part], azimuth[part])))
    return lines


def _cut(elevation: NDArray, x: NDArray, y: NDArray) -> tuple[NDArray, NDArray]:
    """Return a line with its first and last point moved to the horizon where they lie below it."""
    x, y = x.copy(), y.copy()
    for end, inner in ((0, 1), (-1, -2)):
        if elevation[end] <= 0.0:
            part = elevation[inner] / (elevation[inner] - elevation[end])
            x[end] = x[inner] + part * (x[end] - x[inner])
            y[end] = y[inner] + part * (y[end] - y[inner])
    return x, y


def _hour(canvas: Canvas, shown: Heliodon, hour: int, theme: Theme) -> None:
    """Draw the line of one hour of the clock, and its number beside the longest day's path."""
    year = shown.hour(hour)
    summer = len(year) // 2
    halves = ((year[: summer + 1], None), (year[summer:], (4.0, 4.0)))
    for half, dash in halves if shown.latitude >= 0.0 else halves[::-1]:
        for x, y in _above(shown, half):
            canvas.line(x, y, theme.faint, 1.0, dash, opacity=0.6)
    months = (6, 12) if shown.latitude >= 0.0 else (12, 6)
    (high, low), azimuths = shown.sun([shown.at(month, 21, hour) for month in months])
    if high < 1.0:
        return
    (x, other_x), (y, other_y) = shown.place([high, low], azimuths)
    away = np.array([x - other_x, y - other_y])
    away = away / np.hypot(*away) * 11.0
    canvas.text(x + away[0], y + away[1] + 4.5, str(hour), _SMALL, theme.faint, 0.5)


def _arc(canvas: Canvas, shown: Heliodon, month: str, theme: Theme) -> None:
    """Draw the path of a month's 21st; those of solstice and equinox are named where it rises."""
    named = month in ("Dec", "Mar", "Jun")
    lines = _above(shown, shown.day(_MONTHS.index(month) + 1, 21))
    for x, y in lines:
        canvas.line(x, y, theme.sky, 1.5 if named else 1.0, opacity=1.0 if named else 0.5)
    if not (named and lines):
        return
    ends = [(line[0][k], line[1][k]) for line in lines for k in (0, -1)]
    on_horizon = [end for end in ends if np.hypot(*np.subtract(end, MIDDLE)) > RADIUS - 1]
    if not on_horizon:
        return
    x, y = max(on_horizon)  # in the east, as long as north is up
    out = np.array([x - MIDDLE, y - MIDDLE]) / RADIUS
    canvas.text(
        x + 11 * out[0], y + 11 * out[1] + 4.5, f"21 {month}", _SMALL, theme.sky, 0.5 - 0.5 * out[0]
    )


def _hours_of_day(canvas: Canvas, shown: Heliodon, theme: Theme) -> None:
    """Mark each hour on the path of the day shown."""
    moments = shown.day(shown.moment.month, shown.moment.day)[::5]
    elevation, azimuth = shown.sun(moments)
    for x, y in zip(*shown.place(elevation[elevation > 0], azimuth[elevation > 0]), strict=True):
        canvas.disc(x, y, 3.5, theme.today)


def _sun(canvas: Canvas, shown: Heliodon, theme: Theme) -> None:
    """Draw the sun at the moment shown, and from where it shines."""
    elevation, azimuth = shown.now()
    if elevation > 0.0:
        x, y = shown.place([elevation, 0.0], azimuth)
        canvas.line([MIDDLE, x[1]], [MIDDLE, y[1]], theme.ink, 1.0, (3.0, 3.0), opacity=0.7)
        canvas.disc(x[0], y[0], 10.0, theme.ink)
        canvas.disc(x[0], y[0], 8.5, MARKS[SUN])
    for name, towards in zip("NESW", (0, 90, 180, 270), strict=True):
        x, y = shown.place(0.0, towards)
        x, y = MIDDLE + 0.93 * (x - MIDDLE), MIDDLE + 0.93 * (y - MIDDLE)
        canvas.disc(float(x), float(y), 10.0, theme.cell)
        canvas.text(float(x), float(y) + 6.0, name, _TEXT, theme.ink, 0.5)


def _words(canvas: Canvas, shown: Heliodon, title: str, theme: Theme) -> None:
    """Write day and hour, the sun's place, the site and its north into the corners."""
    elevation, azimuth = shown.now()
    moment = shown.moment
    minutes = round((moment.utcoffset() or timedelta()).total_seconds() / 60)
    zone = f"UTC{'-' if minutes < 0 else '+'}{abs(minutes) // 60}"
    zone += f":{abs(minutes) % 60:02}" if minutes % 60 else ""
    sun = (f"Sun {elevation:.1f}° high", f"azimuth {azimuth:.1f}°")
    if elevation <= 0.0:
        sun = (f"Sun {-elevation:.1f}°", "below the horizon")
    where = f"{abs(shown.latitude):.2f}° {'NS'[shown.latitude < 0]}, "
    where += f"{abs(shown.longitude):.2f}° {'EW'[shown.longitude < 0]}"
    north = f"North is {shown.north:g}° from +Y" if shown.north else "North is up"
    day = f"{moment.day} {_MONTHS[moment.month - 1]} {moment.year}"
    left, right, room = 10.0, SIZE - 10.0, SIZE / 2 - 14.0
    for x, y, text, align in (
        (left, 24.0, day, 0.0),
        (left, 44.0, f"{moment:%H:%M} {zone}", 0.0),
        (right, 24.0, sun[0], 1.0),
        (right, 44.0, sun[1], 1.0),
        (left, SIZE - 32.0, title, 0.0),
        (left, SIZE - 12.0, where, 0.0),
        (right, SIZE - 12.0, north, 1.0),
    ):
        canvas.text(x, y, text, _TEXT, theme.ink, align, room)
