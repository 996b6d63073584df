"""One hour of an EPW weather file: how bright sun and sky were, and where.

EnergyPlus Weather: U.S. Department of Energy, *EnergyPlus Auxiliary Programs*, "EnergyPlus Weather
File (EPW) Data Dictionary". Eight lines of header, then a line an hour. Hour 1 is the one from
0:00 to 1:00, in standard time all year; years are of the months that a typical year was made of.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from ..errors import InputError, parameter, printable
from .file_claims import regular_size

LARGEST = 64 << 20
"""[bytes]. A year of hours has 1.5 MB."""

EXTRATERRESTRIAL, DIRECT, DIFFUSE = 11, 14, 15
"""Columns of normal extraterrestrial, direct normal and diffuse horizontal radiation [Wh/m²]."""

MISSING = 9999.0
"""From here on a value says that there is none."""


@dataclass(frozen=True)
class WeatherHour:
    """The mean irradiances [W/m²] of an hour, and the station.

    ``direct``: of the sun, on a face towards it; ``diffuse``: of the sky, on level ground;
    ``extraterrestrial``: of the sun outside the air, None where the file does not say;
    ``latitude`` and ``longitude`` [degrees]; ``timezone`` as `sun_position` takes it.
    """

    direct: float
    diffuse: float
    extraterrestrial: float | None
    station: str
    latitude: float
    longitude: float
    timezone: str


def read_hour(path: str | Path, date: str, time: str) -> WeatherHour:
    """Read the hour of an EPW file that a date ``YYYY-MM-DD`` and a time ``HH:MM`` fall in.

    Time is the file's own standard time; the year of the date does not count. Raises InputError
    for what is no EPW file or ends early, for an hour that is not in it or was not measured, and
    for files of other steps than an hour.
    """
    path = Path(path)
    lines = _text(path).splitlines()
    head = lines[0].split(",") if lines else []
    if len(head) < 10 or head[0].strip().upper() != "LOCATION":
        raise InputError(path, "does not begin with LOCATION", "give an EPW weather file")
    latitude, longitude, zone = (_number(path, 1, head[i]) for i in (6, 7, 8))
    periods = next((n for n, line in enumerate(lines) if line.upper().startswith("DATA PERI")), -1)
    if periods < 0:
        raise InputError(path, "ends in its header", "download it again: it is cut off")
    steps = lines[periods].split(",")[2:3]
    if steps and steps[0].strip() not in ("", "1"):
        raise InputError(path, f"has {steps[0].strip()} values an hour", "give one of hours")
    month, day, hour = _hour(date, time)
    for number, line in enumerate(lines[periods + 1 :], periods + 2):
        row = line.split(",")
        if len(row) < 4 or [cell.strip().lstrip("0") for cell in row[1:4]] != [month, day, hour]:
            continue
        if len(row) <= DIFFUSE + 1:  # or the last number itself may be cut off
            raise InputError(f"{path}, line {number}", "ends early", "download the file again")
        outside, direct, diffuse = (
            _number(path, number, row[i]) for i in (EXTRATERRESTRIAL, DIRECT, DIFFUSE)
        )
        for what, value in (("direct", direct), ("diffuse", diffuse)):
            if not 0.0 <= value < MISSING:
                problem = f"{what} radiation of {date} {time} was not measured"
                raise InputError(f"{path}, line {number}", problem, "give another hour")
        return WeatherHour(
            direct,
            diffuse,
            outside if 0.0 < outside < MISSING else None,
            printable(head[1].strip()),
            latitude,
            longitude,
            f"{zone:+g}",
        )
    problem = f"has no hour {hour} of day {day}, month {month}"
    raise InputError(path, problem, "give another time, or a file of the whole year")


def _text(path: Path) -> str:
    """Return a file as text: names of stations are in many encodings, numbers in one."""
    if regular_size(path) > LARGEST:
        raise InputError(path, f"has more than {LARGEST >> 20} MB", "give an EPW weather file")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read: {error.strerror}", "check the path") from None
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16", "replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _hour(date: str, time: str) -> tuple[str, str, str]:
    """Return month, day and hour as the file has them."""
    try:
        moment = datetime.fromisoformat(f"{date}T{time}")
    except ValueError:
        cure = f"give {parameter('date')} YYYY-MM-DD and {parameter('time')} HH:MM"
        raise InputError(
            parameter("date"), f"'{date} {time}' is not a date and time", cure
        ) from None
    return str(moment.month), str(moment.day), str(moment.hour + 1)


def _number(path: Path, line: int, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if value != value:
        raise InputError(f"{path}, line {line}", f"'{text[:20]}' is no number", "mend the file")
    return value
