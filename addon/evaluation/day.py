"""One clear day on the faces of a building: the paper's own test of its method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ..errors import InputError, parameter
from ..sky.clear_sky import picture
from ..sky.lat_long import directions, solid_angles
from ..sky.light import FACES
from ..sky.simulation import simulate
from ..sky.sun_position import sun_position

FACE_NAMES = ("up", *(f"{tilt} {side}" for tilt in ("45°", "vertical") for side in "NESW"))
"""What the faces of `FACES` are called."""

ROWS = 48
"""Of the pictures of the sky that light is taken from."""
_FINER = 6


@dataclass(frozen=True)
class Day:
    """The sky's light from sunrise to sunset, without the sun itself.

    ``hours`` (t,) local time, ``elevations`` of the sun (t,) [degrees], and ``light`` (t, 9, 81):
    irradiance / pi on `FACES` [W m^-2 nm^-1 sr^-1].
    """

    hours: NDArray[np.float64]
    elevations: NDArray[np.float64]
    light: NDArray[np.float64]


def simulate_day(
    date: str,
    latitude: float,
    longitude: float,
    zone: str = "UTC",
    *,
    step: int = 30,
    progress: bool = False,
    **settings: Any,
) -> Day:
    """Simulate a clear day at a place, every ``step`` minutes from sunrise to sunset.

    Date, place and zone are those of `sun_position`, ``settings`` those of `simulate`: atmosphere,
    orders of scattering, quality. Raises `InputError` as both do, for a step that is not 5 to 180
    minutes, and for a day on which the sun does not rise.
    """
    if not 5 <= step <= 180:
        raise InputError(parameter("step"), f"{step} minutes", "give 5 to 180")
    sunlit = []
    for minutes in range(0, 24 * 60, step):
        time = f"{minutes // 60:02d}:{minutes % 60:02d}"
        elevation, azimuth = sun_position(date, time, latitude, longitude, zone)
        if elevation >= 0.0:
            sunlit.append((minutes / 60.0, elevation, azimuth))
    if not sunlit:
        raise InputError(
            parameter("date"), f"no sun rises at {latitude:g}° on {date}", "give another day"
        )
    weights = face_weights()
    light = []
    for _, elevation, azimuth in tqdm(sunlit, desc="day", disable=not progress):
        sky = picture(simulate(elevation, **settings), ROWS, azimuth)
        light.append(weights @ sky.reshape(-1, sky.shape[-1]))
    hours, elevations, _ = np.array(sunlit).T
    return Day(hours, elevations, np.array(light))


def face_weights() -> NDArray[np.float64]:
    """Return what each pixel of a picture of `ROWS` rows counts on `FACES`, (9, pixels).

    Finer points inside the pixels see to the horizon of each face.
    """
    rows, columns = ROWS * _FINER, 2 * ROWS * _FINER
    cosine = np.maximum(directions(rows, columns) @ FACES.T, 0.0)
    cosine *= solid_angles(rows, columns)[:, None, None] / np.pi
    blocks = cosine.reshape(ROWS, _FINER, 2 * ROWS, _FINER, len(FACES))
    return blocks.sum(axis=(1, 3)).reshape(-1, len(FACES)).T
