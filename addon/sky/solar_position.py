"""Where the sun stands in the sky of a place, at moments of universal time."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

SECONDS_A_DAY = 86400.0
CENTURY = 36525.0
"""[days] of a Julian century."""

PERTURBATIONS = np.array(
    [
        # amplitude [degrees], phase [degrees], degrees a century
        (0.00134, 153.23, 22518.7541),  # Venus
        (0.00154, 216.57, 45037.5082),  # Venus
        (0.00200, 312.69, 32964.3577),  # Jupiter
        (0.00179, 260.74, 445267.1142),  # the moon; Meeus has it as a sine
        (0.00178, 141.19, 20.20),  # of long period; Meeus has it as a sine
    ]
)
"""What planets and the moon add to the sun's longitude."""

PARALLAX = 8.794 / 3600
"""[degrees]. How much lower a sun on the horizon stands than seen from earth's center."""


def solar_position(
    seconds: ArrayLike, latitude: ArrayLike, longitude: ArrayLike, *, refracted: bool = False
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sun's elevation and azimuth [degrees], arrays of the arguments' common shape.

    Within 0.005° of Reda and Andreas (DOI 10.1016/j.solener.2003.12.003) from 1600 to 2400, within
    0.013° from the year 1 to 3000. By Meeus, *Astronomical Formulae for Calculators* (1988, ISBN
    0-943396-22-0), chapter 18, with nutation, aberration and parallax; sidereal time by Meeus,
    *Astronomical Algorithms* (1998, ISBN 0-943396-61-1), eq. 12.4.

    Parameters
    ----------
    seconds
        Universal time since 1970-01-01 [s], as `datetime.timestamp` gives it.
    latitude, longitude
        [degrees], -90 to 90 and any; north and east are positive. At a pole the azimuth is counted
        from the opposite of the meridian of ``longitude`` (from the meridian, at the south pole).
    refracted
        Whether the elevation is where one sees the sun through air at sea level, 15 °C and 1013.25
        hPa, instead of where it stands: see `refraction`.

    The azimuth is clockwise from north, 0 to 360.
    """
    days = np.asarray(seconds, float) / SECONDS_A_DAY + 25567.5  # since noon of 1899-12-31
    apparent, obliquity, nutation = _ecliptic((days + _dynamical(days)) / CENTURY)
    right_ascension = np.arctan2(np.cos(obliquity) * np.sin(apparent), np.cos(apparent))
    declination = np.arcsin(np.sin(obliquity) * np.sin(apparent))

    days = days - CENTURY  # since noon of 2000-01-01
    sidereal = 280.46061837 + 360.98564736629 * days + 0.000387933 * (days / CENTURY) ** 2
    hour = np.radians(sidereal + longitude) + nutation * np.cos(obliquity) - right_ascension

    place = np.radians(latitude)
    north = np.cos(place) * np.sin(declination) - np.sin(place) * np.cos(declination) * np.cos(hour)
    east = -np.cos(declination) * np.sin(hour)
    up = np.sin(place) * np.sin(declination) + np.cos(place) * np.cos(declination) * np.cos(hour)
    elevation = np.arctan2(up, np.hypot(north, east))
    elevation = np.degrees(elevation) - PARALLAX * np.cos(elevation)
    if refracted:
        elevation = elevation + refraction(elevation)
    return elevation, np.degrees(np.arctan2(east, north)) % 360.0


def refraction(elevation: ArrayLike) -> NDArray[np.float64]:
    """Return by how much air at sea level lifts the sun at an elevation, (...) [degrees].

    By Reda and Andreas (2004), eq. 42, at 1013.25 hPa and 15 °C; 0 for a sun whose upper limb is
    below the horizon even so.
    """
    elevation = np.asarray(elevation, float)
    seen = elevation >= -(0.26667 + 0.5667)  # the sun's radius and the refraction at the horizon
    above = np.where(seen, elevation, 0.0)
    lift = 1.02 / 60 / np.tan(np.radians(above + 10.3 / (above + 5.11)))
    return np.where(seen, 1013.25 / 1010 * 283 / (273 + 15) * lift, 0.0)


def _ecliptic(T: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Return the sun's apparent longitude, earth's obliquity and the nutation of longitude [rad].

    ``T``: centuries of dynamical time since 1900, January 0.5.
    """
    mean = 279.69668 + 36000.76892 * T + 0.0003025 * T**2
    anomaly = np.radians(358.47583 + 35999.04975 * T - 0.00015 * T**2 - 0.0000033 * T**3)
    center = (1.919460 - 0.004789 * T - 0.000014 * T**2) * np.sin(anomaly)
    center += (0.020094 - 0.000100 * T) * np.sin(2 * anomaly) + 0.000293 * np.sin(3 * anomaly)
    amplitude, phase, rate = PERTURBATIONS.T
    perturbed = np.cos(np.radians(phase + rate * T[..., None])) @ amplitude
    node = np.radians(259.18 - 1934.142 * T)  # of the moon's orbit
    nutation = -0.00479 * np.sin(node)
    aberration = -0.00569
    obliquity = 23.452294 - 0.0130125 * T - 0.00000164 * T**2 + 0.000000503 * T**3
    obliquity += 0.00256 * np.cos(node)
    apparent = mean + center + perturbed + nutation + aberration
    return np.radians(apparent), np.radians(obliquity), np.radians(nutation)


def _dynamical(days: NDArray) -> NDArray:
    """Return by how much dynamical time is ahead of universal time [days].

    Morrison and Stephenson (2004, DOI 10.1177/002182860403500305), eq. 1. A minute wrong, as it is
    in the 20th century, moves the sun by 0.0007°.
    """
    return (32.0 * ((days + 29219.0) / CENTURY) ** 2 - 20.0) / SECONDS_A_DAY  # centuries from 1820
