"""The sun's way over a place through a day, or a year at one hour, as curves of few keys."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date as calendar_date
from datetime import timedelta

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, parameter
from .simulation import LOWEST_SUN
from .solar_position import SECONDS_A_DAY, solar_position
from .sun_position import LAST_YEAR, local_moment

SAMPLES = 4096
"""Of a course: a day's are 21 s apart."""

ELEVATION_WITHIN, AZIMUTH_WITHIN = 0.003, 0.01
"""[degrees] by which curves may be off: less than `solar_position` itself, or a blurred disc."""

MIDNIGHT = "24:00"


@dataclass(frozen=True, eq=False)
class Curve:
    """A piecewise cubic: at ``x`` (k,), from 0 to 1, it is ``y`` and rises by ``slope`` per 1."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    slope: NDArray[np.float64]

    def at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return its values (n,) at places (n,) inside."""
        k = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2)
        width = self.x[k + 1] - self.x[k]
        return hermite(
            (x - self.x[k]) / width,
            self.y[k],
            self.y[k + 1],
            self.slope[k] * width,
            self.slope[k + 1] * width,
        )


@dataclass(frozen=True, eq=False)
class Course:
    """Where the sun stands from a first moment (0) to a last (1).

    ``elevation`` [degrees]; ``azimuth`` [degrees], clockwise from north, beyond 360 where it goes
    on; ``line``: what it is, in words.
    """

    elevation: Curve
    azimuth: Curve
    line: str

    @property
    def range(self) -> tuple[float, float]:
        """The lowest and the highest elevation [degrees] that skies are needed for."""
        heights = self.elevation.at(np.linspace(0.0, 1.0, SAMPLES))
        return max(float(heights.min()), LOWEST_SUN), float(heights.max())


def through_day(
    date: str, first: str, last: str, latitude: float, longitude: float, zone: str
) -> Course:
    """Return the sun's way from a time of a day to a later one, local to a zone.

    ``last`` may be 24:00; others as `sun_position.sun_positions` takes them. Where clocks change
    between the two, time goes on evenly. Raises InputError as that does, where the last is not
    later than the first, and where the sun stays lower than skies are simulated.
    """
    start, end = span(date, first, last, zone)
    seconds = np.linspace(start, end, SAMPLES)
    return _course(seconds, latitude, longitude, f"{date} {first}-{last}")


def span(date: str, first: str, last: str, zone: str) -> tuple[float, float]:
    """Return from when to when [s] a part of a day goes; raises InputError as `through_day`."""
    start = local_moment(date, first, zone).timestamp()
    if last == MIDNIGHT:
        following = calendar_date.fromisoformat(date) + timedelta(days=1)
        end = local_moment(following.isoformat(), "00:00", zone).timestamp()
    else:
        end = local_moment(date, last, zone).timestamp()
    if end <= start:
        raise InputError(
            parameter("to"), f"{last} is not later than {first}", "give a later time, up to 24:00"
        )
    return start, end


def through_year(year: int, time: str, latitude: float, longitude: float, zone: str) -> Course:
    """Return the sun's way from January 1 to December 31 at one time of the day, winter's.

    Clocks are not put forward in summer: the sun would leap by an hour. Raises InputError as
    `through_day` does.
    """
    if not 1 <= year <= LAST_YEAR:
        raise InputError(parameter("date"), f"{year} is too far away", f"give 1 to {LAST_YEAR}")
    winter, summer = (local_moment(f"{year:04}-{day}", time, zone) for day in ("01-01", "07-01"))
    first = winter.timestamp()
    none = timedelta()
    first += max((winter.dst() or none) - (summer.dst() or none), none).total_seconds()
    days = calendar_date(year, 12, 31).timetuple().tm_yday
    each = first + SECONDS_A_DAY * np.arange(days)
    return _course(each, latitude, longitude, f"{year:04} at {time}")


def _course(seconds: NDArray, latitude: float, longitude: float, line: str) -> Course:
    for name, value, most in (("latitude", latitude, 90.0), ("longitude", longitude, 180.0)):
        if not -most <= value <= most:
            raise InputError(parameter(name), f"{value:g}°", f"give -{most:g} to {most:g}")
    elevation, azimuth = solar_position(seconds, latitude, longitude)
    if elevation.max() < LOWEST_SUN:
        raise InputError(
            parameter("time"),
            f"the sun stays at least {-elevation.max():.1f}° below the horizon",
            f"skies are simulated down to {LOWEST_SUN:g}°: give another day or time",
        )
    x = np.linspace(0.0, 1.0, len(seconds))
    return Course(
        curve(x, elevation, ELEVATION_WITHIN),
        curve(x, np.degrees(np.unwrap(np.radians(azimuth))), AZIMUTH_WITHIN),
        line,
    )


def curve(x: NDArray[np.float64], y: NDArray[np.float64], within: float) -> Curve:
    """Return the curve of fewest keys by halving that is within so much of samples (n,)."""
    slope = np.gradient(y, x, edge_order=2)
    keys = {0, len(x) - 1}
    parts = [(0, len(x) - 1)]
    while parts:
        first, last = parts.pop()
        width = x[last] - x[first]
        s = (x[first : last + 1] - x[first]) / width
        told = hermite(s, y[first], y[last], slope[first] * width, slope[last] * width)
        if last - first > 1 and np.abs(told - y[first : last + 1]).max() > within:
            middle = (first + last) // 2
            keys.add(middle)
            parts += [(first, middle), (middle, last)]
    chosen = sorted(keys)
    return Curve(x[chosen], y[chosen], slope[chosen])


def hermite(
    s: NDArray[np.float64], y_0: NDArray, y_1: NDArray, rise_0: NDArray, rise_1: NDArray
) -> NDArray[np.float64]:
    """Return the cubic from y_0 to y_1 at s from 0 to 1, which rises so at its ends."""
    c = 3.0 * (y_1 - y_0) - 2.0 * rise_0 - rise_1
    b = rise_0 + rise_1 - 2.0 * (y_1 - y_0)
    return np.asarray(y_0 + s * (rise_0 + s * (c + s * b)))
