"""Sun hours and sky view factors, against closed forms."""

import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.sky.solar_position import solar_position
from spectral_skylight.addon.transport.exposure import sky_view, sun_hours
from spectral_skylight.addon.transport.rays import Caster

FAR = 4000.0
"""Of things that are endless: what is beyond counts for less than 1e-3."""

UP = np.array([[0.0, 0.0, 1.0]], np.float32)


def rectangle(a, b, c, d):
    return [[a, b, c], [a, c, d]]


def wall(x_0, y_0, x_1, y_1, height):
    """A vertical rectangle over a line on the ground."""
    ground, over = ((x_0, y_0), (x_1, y_1)), (0.0, height)
    (a, b), (low, high) = ground, over
    return rectangle((*a, low), (*b, low), (*b, high), (*a, high))


def scene(*walls):
    return Caster(np.array([t for one in walls for t in one], np.float32))


def view(caster, place, normal=UP):
    return run(sky_view(caster, np.array([place], np.float32), normal, 8192))[0]


def test_nothing_hides_the_sky():
    far = scene(wall(FAR, 0, FAR, 1, 1))
    assert view(far, (0, 0, 0)) == 1.0
    south = np.array([[0.0, -1.0, 0.0]], np.float32)
    assert view(far, (0, 0, 0), south) == pytest.approx(0.5, abs=0.002)
    assert view(far, (0, 0, 0), -UP) == 0.0


@pytest.mark.parametrize(("height", "width"), [(3.0, 6.0), (10.0, 8.0), (1.0, 20.0)])
def test_the_floor_of_a_street_canyon(height, width):
    """An endless street's middle sees cos(atan(2 H / W)) of the sky (T. R. Oke 1981, DOI
    10.1002/joc.3370010304)."""
    half = width / 2.0
    street = scene(wall(half, -FAR, half, FAR, height), wall(-half, -FAR, -half, FAR, height))
    expected = np.cos(np.arctan(2.0 * height / width))
    assert view(street, (0, 0, 0.001)) == pytest.approx(expected, abs=0.002)


def test_beside_an_endless_wall_half_of_the_sky_is_left():
    one = scene(wall(0.01, -FAR, 0.01, FAR, FAR))
    assert view(one, (0, 0, 0.001)) == pytest.approx(0.5, abs=0.002)


@pytest.mark.parametrize("depth", [2.0, 4.5])
def test_the_middle_of_a_courtyards_floor(depth):
    """The open rectangle's form factor for the level face under its middle (J. R. Howell,
    configuration factor B-4, four times a quarter)."""
    half = 3.0
    court = scene(
        wall(half, -half, half, half, depth),
        wall(-half, -half, -half, half, depth),
        wall(-half, half, half, half, depth),
        wall(-half, -half, half, -half, depth),
    )
    x = half / depth
    s = np.sqrt(1.0 + x * x)
    expected = 4.0 * (x / s * np.arctan(x / s)) * 2.0 / (2.0 * np.pi)
    assert view(court, (0, 0, 0.001)) == pytest.approx(expected, abs=0.002)


def suns(latitude, minutes):
    start = 1750464000.0  # 2025-06-21 00:00 UTC
    count = round(1440 / minutes)
    elevation, azimuth = solar_position(
        start + (np.arange(count) + 0.5) / count * 86400.0, latitude, 0.0
    )
    e, a = np.radians(elevation), np.radians(90.0 - azimuth)
    return np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], axis=1)


def hours(caster, place, normal, minutes=1.0):
    ways = suns(48.1, minutes)
    at = np.array([place], np.float32)
    return run(sun_hours(caster, at, normal, ways, minutes / 60.0))[0]


@pytest.mark.parametrize(("height", "away"), [(3.0, 1.0), (3.0, 2.5), (6.0, 2.0)])
def test_the_shadow_of_an_endless_wall(height, away):
    """North of a wall from west to east the sun is seen where its profile angle is over the wall's:
    tan(profile) = z / -y of its direction; north of the line it shines over the back."""
    caster = scene(wall(-FAR, -away, FAR, -away, height))
    ways = suns(48.1, 0.1)
    seen = (ways[:, 2] > 0.0) & (ways[:, 2] * away > -ways[:, 1] * height)
    expected = seen.sum() * 0.1 / 60.0
    assert hours(caster, (0, 0, 0.0), UP) == pytest.approx(expected, abs=2.5 / 60.0)


def test_a_day_in_the_open_is_as_long_as_the_sun_is_up():
    """The day's length by cos(H) = -tan(latitude) tan(declination)."""
    far = scene(wall(FAR, 0, FAR, 1, 0.001))
    declination = np.radians(23.44)
    length = 2.0 / 15.0 * np.degrees(np.arccos(-np.tan(np.radians(48.1)) * np.tan(declination)))
    assert hours(far, (0, 0, 1.0), UP) == pytest.approx(length, abs=2.5 / 60.0)
    north = np.array([[0.0, 1.0, 0.0]], np.float32)
    assert 0.0 < hours(far, (0, 0, 1.0), north) < length / 2.0
    assert hours(far, (0, 0, 1.0), -UP) == 0.0
