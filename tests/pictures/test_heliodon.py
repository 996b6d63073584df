"""The sun's paths: where the projection puts them, and what the picture shows there."""

from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest

from spectral_skylight.addon.pictures import heliodon as paths
from spectral_skylight.addon.pictures.heliodon import MIDDLE, RADIUS, Heliodon, heliodon
from spectral_skylight.addon.pictures.sky_map import MARKS, SUN
from spectral_skylight.addon.pictures.theme import LIGHT

SUMMER = timezone(timedelta(hours=2))
BERLIN = Heliodon(datetime(2025, 6, 21, 15, 20, tzinfo=SUMMER), 52.52, 13.41)


def test_the_projection_is_stereographic():
    """Zenith, horizon and 30°: R tan 30°, by hand; north up, east on the right."""
    x, y = BERLIN.place([90.0, 0.0, 0.0, 30.0, 30.0], [0.0, 0.0, 90.0, 180.0, 270.0])
    third = RADIUS / np.sqrt(3.0)
    np.testing.assert_allclose(x - MIDDLE, [0, 0, RADIUS, 0, -third], atol=1e-9)
    np.testing.assert_allclose(y - MIDDLE, [0, -RADIUS, 0, third, 0], atol=1e-9)
    turned = Heliodon(BERLIN.moment, 52.52, 13.41, north=90.0)
    np.testing.assert_allclose(turned.place(0.0, 0.0), (MIDDLE + RADIUS, MIDDLE), atol=1e-9)


def test_paths_of_a_day_are_arcs_of_circles():
    """What a stereographic projection makes of circles on a sphere, parallax aside."""
    for month in (3, 6, 12):
        ((x, y),) = paths._above(BERLIN, BERLIN.day(month, 21))
        system = np.column_stack([2 * x, 2 * y, np.ones(x.size)])
        cx, cy, rest = np.linalg.lstsq(system, x**2 + y**2, rcond=None)[0]
        radii = np.hypot(x - cx, y - cy)
        # The declination drifts by up to 0.4° in a day, 0.2° to either side: some 0.3 units.
        assert np.abs(radii - np.sqrt(rest + cx**2 + cy**2)).max() < 0.5, month


def test_the_equinox_rises_in_the_east_and_ends_on_the_horizon():
    ((x, y),) = paths._above(BERLIN, BERLIN.day(3, 20))
    np.testing.assert_allclose(np.hypot(x - MIDDLE, y - MIDDLE)[[0, -1]], RADIUS, atol=0.05)
    assert (x[0], y[0]) == pytest.approx((MIDDLE + RADIUS, MIDDLE), abs=2.0)  # 0.6° of azimuth


def test_polar_day_and_night():
    svalbard = Heliodon(datetime(2025, 6, 21, tzinfo=UTC), 78.2, 15.6)
    ((x, y),) = paths._above(svalbard, svalbard.day(6, 21))
    assert np.hypot(x - MIDDLE, y - MIDDLE).max() < RADIUS and x.size == 121
    assert paths._above(svalbard, svalbard.day(12, 21)) == []
    assert heliodon(svalbard).shape == (480, 480, 3)


@pytest.mark.parametrize("latitude", [90.0, -90.0, 0.0, -23.5, 66.0])
def test_lines_stay_inside_the_horizon(latitude):
    shown = Heliodon(BERLIN.moment, latitude, 0.0)
    lines = [line for hour in range(24) for line in paths._above(shown, shown.hour(hour))]
    lines += [line for month in range(1, 13) for line in paths._above(shown, shown.day(month, 21))]
    assert lines
    for x, y in lines:
        assert np.hypot(x - MIDDLE, y - MIDDLE).max() < RADIUS + 0.5


def test_hours_are_the_clocks_of_the_day_shown():
    """15:00 of summer time is 13:00 UTC; in winter the same line is there an hour off the clock."""
    summer = datetime(2025, 6, 21, 15, tzinfo=SUMMER).timestamp()
    assert BERLIN.day(6, 21)[75] == BERLIN.at(6, 21, 15) == summer
    assert np.abs(BERLIN.hour(15) - summer).min() < 3 * 86400
    assert ((BERLIN.hour(15) - summer) % 86400 == 0).all()


def near(picture, colour, x, y):
    return np.abs(picture[int(y), int(x)].astype(int) - 255 * np.asarray(colour)).max() < 3


def test_the_sun_is_drawn_where_it_stands():
    picture = heliodon(BERLIN, "Berlin", theme=LIGHT, scale=1.0)
    x, y = BERLIN.place(*BERLIN.now())
    assert near(picture, MARKS[SUN], x, y)
    assert near(picture, LIGHT.today, *BERLIN.place(*BERLIN.sun(BERLIN.at(6, 21, 18))))
    night = Heliodon(datetime(2025, 6, 21, 1, tzinfo=SUMMER), 52.52, 13.41)
    dark = heliodon(night, "Berlin", theme=LIGHT, scale=1.0)
    assert not near(dark, MARKS[SUN], x, y)
    assert not (np.abs(dark.astype(int) - 255 * np.array(MARKS[SUN])).max(axis=-1) < 3).any()
