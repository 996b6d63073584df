"""One hour of an EPW weather file: how bright sun and sky were, and where.

EnergyPlus Weather: U.S. Department of Energy, *EnergyPlus Auxiliary Programs*, "EnergyPlus Weather
File (EPW) Data Dictionary". Eight lines of header, then a line an hour. Hour 1 is the one from
0:00 to 1:00, in standard time all year; years are of the months that a typical year was made of.
"""

from __future__ import annotations

import csv
import re
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
"""From here on a value says that there is none; some files leave it empty."""

GIVE_EPW = "give an EPW weather file"


@dataclass(frozen=True)
class Station:
    """Where weather was measured, as the first line of a file says.

    ``latitude`` and ``longitude`` [degrees]; ``timezone`` as `sun_position` takes it.
    """

    name: str
    latitude: float
    longitude: float
    timezone: str


@dataclass(frozen=True)
class WeatherHour:
    """The mean irradiances [W/m²] of an hour, and the station.

    ``direct``: of the sun, on a face towards it; ``diffuse``: of the sky, on level ground;
    ``extraterrestrial``: of the sun outside the air, None where the file does not say.
    """

    direct: float
    diffuse: float
    extraterrestrial: float | None
    station: Station


def read_station(path: str | Path) -> Station:
    """Read where an EPW file's weather was measured; raises InputError where that is not said."""
    return _station(Path(path), _lines(Path(path))[0])


def read_hour(path: str | Path, date: str, time: str) -> WeatherHour:
    """Read the hour of an EPW file that a date ``YYYY-MM-DD`` and a time ``HH:MM`` fall in.

    Time is the file's own standard time; the year of the date counts only where a file has several.
    Raises InputError for what is no EPW file or ends early, for an hour that is not in it or was
    not measured, and for files of other steps than an hour.
    """
    path = Path(path)
    lines = _lines(path)
    station = _station(path, lines[0])
    periods = next((n for n, line in enumerate(lines) if line.upper().startswith("DATA PERI")), -1)
    if periods < 0:
        raise InputError(path, "ends in its header", "download it again: it is cut off")
    steps = lines[periods].split(",")[2:3]
    if steps and steps[0].strip() not in ("", "1"):
        raise InputError(path, f"has {steps[0].strip()} values an hour", "give one of hours")
    moment = _moment(date, time)
    number = _row(path, lines, periods + 1, moment)
    row = lines[number - 1].split(",")
    if len(row) <= DIFFUSE + 1:  # or the last number itself may be cut off
        raise InputError(f"{path}, line {number}", "ends early", "download the file again")
    outside, direct, diffuse = (
        _number(path, number, row[i]) for i in (EXTRATERRESTRIAL, DIRECT, DIFFUSE)
    )
    for what, value in (("direct", direct), ("diffuse", diffuse)):
        if not 0.0 <= value < MISSING:
            problem = f"{what} radiation of {date} {time} was not measured"
            raise InputError(f"{path}, line {number}", problem, "give another hour")
    return WeatherHour(direct, diffuse, outside if 0.0 < outside < MISSING else None, station)


def _lines(path: Path) -> list[str]:
    """Return a file's lines: names of stations are in many encodings, numbers in one."""
    if regular_size(path) > LARGEST:
        raise InputError(path, f"has more than {LARGEST >> 20} MB", GIVE_EPW)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read: {error.strerror}", "check the path") from None
    # LOCATION in two bytes a character, with a mark of their order or without.
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = content.decode("utf-16", "replace")
    elif content[:2] in (b"L\0", b"\0L"):
        text = content.decode("utf-16-le" if content[:1] == b"L" else "utf-16-be", "replace")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("latin-1")
    # Not by `splitlines`: to that some letters of other encodings are the end of a line.
    return re.split("\r\n|\r|\n", text)


def _station(path: Path, line: str) -> Station:
    """Read the first line: LOCATION, city, state, country, source, WMO, place, zone, elevation."""
    start = line.lstrip().upper()
    if start.startswith(("LOCATION;", "LOCATION\t")):
        raise InputError(path, "is not separated by commas", "save it as the EPW it was")
    try:
        head = next(csv.reader([line]), [])
    except csv.Error:
        head = []
    while len(head) > 10 and not head[-1].strip():  # a spreadsheet pads its rows
        head.pop()
    if len(head) < 10 or head[0].strip().upper() != "LOCATION":
        raise InputError(path, "does not begin with LOCATION", GIVE_EPW)
    # From the end: a name may hold commas.
    latitude, longitude, zone = (_number(path, 1, text) for text in head[-4:-1])
    for what, value, most in (
        ("latitude", latitude, 90.0),
        ("longitude", longitude, 180.0),
        ("time zone", zone, 14.0),
    ):
        if not abs(value) <= most:
            cure = f"mend the file: {-most:g} to {most:g}"
            raise InputError(f"{path}, line 1", f"the {what} is {value:g}", cure)
    return Station(printable(head[1].strip()), latitude, longitude, f"{zone:+g}")


def _row(path: Path, lines: list[str], start: int, moment: datetime) -> int:
    """Return the number of the line of a moment's hour, of its year where there are several."""
    rows: dict[int, int] = {}
    wanted = moment.month, moment.day, moment.hour + 1
    for number, line in enumerate(lines[start:], start + 1):
        try:
            year, month, day, hour = (int(cell) for cell in line.split(",", 4)[:4])
        except ValueError:  # blank, or cut off
            continue
        if hour == 0:
            cure = "give an EPW of hours 1 to 24"
            raise InputError(f"{path}, line {number}", "counts hours from 0", cure)
        if (month, day, hour) == wanted:
            if year in rows:
                problem = f"is the same hour as line {rows[year]}"
                raise InputError(f"{path}, line {number}", problem, "delete one of them")
            rows[year] = number
    if len(rows) == 1:
        return next(iter(rows.values()))
    if rows and moment.year not in rows:
        cure = f"give a {parameter('date')} in one of these years"
        raise InputError(path, f"has that hour in {', '.join(map(str, sorted(rows)))}", cure)
    if rows:
        return rows[moment.year]
    problem = f"has no hour {moment.hour + 1} of day {moment.day}, month {moment.month}"
    cure = "give another time, or a file of the whole year"
    if (moment.month, moment.day) == (2, 29):
        cure = "typical years have no leap day: give another"
    raise InputError(path, problem, cure)


def _moment(date: str, time: str) -> datetime:
    """Read the date and time of an hour."""
    try:
        return datetime.fromisoformat(f"{date}T{time}")
    except ValueError:
        cure = f"give {parameter('date')} YYYY-MM-DD and {parameter('time')} HH:MM"
        raise InputError(
            parameter("date"), f"'{date} {time}' is not a date and time", cure
        ) from None


def _number(path: Path, line: int, text: str) -> float:
    """Read a number; one that is left out is `MISSING`."""
    if not text.strip():
        return MISSING
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if value != value:
        raise InputError(f"{path}, line {line}", f"'{text[:20]}' is no number", "mend the file")
    return value
