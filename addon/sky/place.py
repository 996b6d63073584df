"""Where on earth: a city by its name, or latitude and longitude."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import InputError, parameter
from . import cities


@dataclass(frozen=True)
class Place:
    """A place: ``name``, empty for one without; ``latitude`` and ``longitude`` [degrees];
    ``timezone`` as `sun_position.sun_positions` takes it."""

    name: str
    latitude: float
    longitude: float
    timezone: str

    @property
    def line(self) -> str:
        """What is taken for it."""
        return f"{self.name}: {self.latitude:.2f}°, {self.longitude:.2f}°, {self.timezone}"


def place(
    city: str | None, latitude: float | None, longitude: float | None, timezone: str | None
) -> Place:
    """Return the place of a city, in its time zone where none is given, or of two angles [degrees],
    in UTC.

    Raises InputError for a city that is not in the list, for a city and angles, and for neither.
    """
    angles = {"latitude": latitude, "longitude": longitude}
    if city is not None:
        given = [parameter(name) for name, angle in angles.items() if angle is not None]
        if given:
            cure = f"leave {' and '.join(given)} out"
            raise InputError(parameter("city"), "says the place", cure)
        found = cities.city(city)
        return Place(found.label, found.latitude, found.longitude, timezone or found.timezone)
    if latitude is None or longitude is None:
        missing = next(name for name, angle in angles.items() if angle is None)
        cure = f"give {parameter('city')}, or "
        cure += " and ".join(parameter(name) for name in angles)
        raise InputError(parameter(missing), "the place is unknown", cure)
    return Place("", latitude, longitude, timezone or "UTC")
