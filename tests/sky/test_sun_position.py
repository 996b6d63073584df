"""The sun's place at local times, and what is no time, place or zone."""

import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.sun_position import sun_position


def test_reda_and_andreas_example():
    # NREL/TP-560-34302, table A5.1: zenith 50.11162°, refraction and 1830 m of altitude in it
    # (0.02°), azimuth 194.34024°.
    elevation, azimuth = sun_position("2003-10-17", "12:30:30", 39.742476, -105.1786, "-7")
    assert elevation == pytest.approx(90 - 50.11162, abs=0.03)
    assert azimuth == pytest.approx(194.34024, abs=0.005)  # what solar_position promises


def test_zones_agree():
    summer = sun_position("2025-06-21", "14:30", 52.5, 13.4, "Europe/Berlin")
    assert summer == pytest.approx(sun_position("2025-06-21", "14:30", 52.5, 13.4, "+2"))
    assert summer == pytest.approx(sun_position("2025-06-21", "12:30", 52.5, 13.4))


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (("2025-02-30", "12:00", 0.0, 0.0), "^date: "),
        (("2025-02-20", "noon", 0.0, 0.0), " time HH:MM"),
        (("2025-02-20", "12:00", 91.0, 0.0), "^latitude: "),
        (("2025-02-20", "12:00", 0.0, 181.0), "^longitude: "),
        (("2025-02-20", "12:00", 0.0, 0.0, "Mars/Olympus"), "^timezone: "),
        (("2025-02-20", "12:00", 0.0, 0.0, "+x"), "^timezone: "),
        (("2025-02-20", "12:00", 0.0, 0.0, "+5:75"), "^timezone: "),
        (("2025-02-20", "12:00", 0.0, 0.0, "+24"), "^timezone: "),
        (("2025-02-20", "12:00", float("nan"), 0.0), "^latitude: "),
        (("2025-02-29", "12:00", 0.0, 0.0), "^date: 2025 is no leap year"),
        (("2025-02-20", "12:00+02:00", 0.0, 0.0), "^time: .* has a time zone in it"),
        (("3001-01-01", "12:00", 0.0, 0.0), "^date: .* too far away"),
        (("0001-01-01", "00:00", 0.0, 0.0, "+2"), "^date: .* too far away"),
        (
            ("2025-03-30", "02:30", 0.0, 0.0, "Europe/Berlin"),
            "^time: there is no 02:30 on 2025-03-30; summer time begins .* an hour later",
        ),
        (  # a whole day, when Samoa went over the date line
            ("2011-12-30", "12:00", 0.0, 0.0, "Pacific/Apia"),
            "^time: there is no 12:00 on 2011-12-30; clocks are put forward .* time or day",
        ),
        (
            ("2025-10-26", "02:30", 0.0, 0.0, "Europe/Berlin"),
            r"^time: 02:30 comes twice on .*; summer time ends .* in hours, \+2:00 or \+1:00",
        ),
    ],
)
def test_what_is_wrong_is_said(arguments, part):
    with pytest.raises(InputError, match=part):
        sun_position(*arguments)


def test_an_hour_that_comes_twice_is_told_apart_by_hours():
    first, second = (
        sun_position("2025-10-26", "02:30", 52.5, 13.4, zone) for zone in ("+2:00", "+1:00")
    )
    assert first == pytest.approx(sun_position("2025-10-26", "00:30", 52.5, 13.4))
    assert second == pytest.approx(sun_position("2025-10-26", "01:30", 52.5, 13.4))


def test_a_leap_day_lies_between_its_neighbors():
    days = ("2024-02-28", "2024-02-29", "2024-03-01")
    before, day, after = (sun_position(each, "12:00", 0.0, 0.0)[0] for each in days)
    assert day == pytest.approx((before + after) / 2, abs=0.01)  # the declination's curvature
    assert after - before == pytest.approx(0.75, abs=0.02)  # 0.38° a day in late winter
