"""The sun's way as curves of few keys: against where it stands, for places all over the earth."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.solar_position import solar_position
from spectral_skylight.addon.sky.sun_course import through_day, through_year
from spectral_skylight.addon.sky.sun_position import local_moment, sun_position

X = np.linspace(0.0, 1.0, 1777)  # no multiple of the samples


@pytest.mark.parametrize("latitude", [-66.0, -23.44, 0.0, 23.4, 48.1, 71.0])
def test_a_day_is_where_the_sun_stands(latitude):
    course = through_day("2025-06-21", "00:00", "24:00", latitude, 11.6, "UTC")
    start = local_moment("2025-06-21", "00:00", "UTC").timestamp()
    elevation, azimuth = solar_position(start + 86400.0 * X, latitude, 11.6)
    day = elevation > -6.0
    assert np.abs(course.elevation.at(X) - elevation)[day].max() < 0.005
    # An azimuth counts for less the higher the sun stands.
    away = (course.azimuth.at(X) - azimuth + 180.0) % 360.0 - 180.0
    assert np.abs(away * np.cos(np.radians(elevation)))[day].max() < 0.02
    assert len(course.elevation.x) <= 33


def test_a_day_of_changed_clocks_goes_on_evenly():
    """In Berlin it is 21 hours from 0:00 to 22:00 when clocks are put forward."""
    course = through_day("2025-03-30", "00:00", "22:00", 52.5, 13.4, "Europe/Berlin")
    middle = sun_position("2025-03-30", "11:30", 52.5, 13.4, "Europe/Berlin")
    assert course.elevation.at(np.array([0.5]))[0] == pytest.approx(middle[0], abs=0.005)


@pytest.mark.parametrize(
    ("zone", "hours", "longitude"),
    [("Europe/Berlin", "+1", 13.4), ("Australia/Sydney", "+10", 151.2)],
)
def test_a_year_keeps_to_winters_time(zone, hours, longitude):
    course = through_year(2025, "12:00", -33.9, longitude, zone)
    for day, place in (("2025-01-01", 0.0), ("2025-07-01", 181 / 364), ("2025-12-31", 1.0)):
        elevation, _ = sun_position(day, "12:00", -33.9, longitude, hours)
        assert course.elevation.at(np.array([place]))[0] == pytest.approx(elevation, abs=0.005)


@pytest.mark.parametrize(
    ("date", "first", "last", "latitude", "line"),
    [
        ("2025-06-21", "20:00", "06:00", 48.0, "06:00 is not later than 20:00"),
        ("2025-06-21", "06:00", "06:00", 48.0, "06:00 is not later than 06:00"),
        ("2025-03-30", "02:30", "20:00", 48.0, "there is no 02:30 on 2025-03-30"),
        ("2025-12-21", "00:00", "24:00", 80.0, "the sun stays at least 13.4° below the horizon"),
        ("2025-06-21", "06:00", "20:00", 91.0, "latitude: 91°"),
        ("2023-02-29", "06:00", "20:00", 48.0, "2023 is no leap year"),
    ],
)
def test_bad_input_is_one_line(date, first, last, latitude, line):
    with pytest.raises(InputError, match=line) as caught:
        through_day(date, first, last, latitude, 11.6, "Europe/Berlin")
    assert "\n" not in str(caught.value)


def test_a_date_that_a_zone_skips():
    """Samoa went over the date line: no December 30."""
    with pytest.raises(InputError, match="there is no 06:00 on 2011-12-30"):
        through_day("2011-12-30", "06:00", "20:00", -13.8, -171.8, "Pacific/Apia")
