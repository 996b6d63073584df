"""The sun's place against published ones."""

import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.sun_position import sun_position

pytest.importorskip("pvlib")


def test_reda_and_andreas_example():
    # NREL/TP-560-34302, table A5.1: zenith 50.11162°, refraction and 1830 m of altitude in it
    # (0.02°), azimuth 194.34024°.
    elevation, azimuth = sun_position("2003-10-17", "12:30:30", 39.742476, -105.1786, "-7")
    assert elevation == pytest.approx(90 - 50.11162, abs=0.03)
    assert azimuth == pytest.approx(194.34024, abs=0.001)


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
    ],
)
def test_what_is_wrong_is_said(arguments, part):
    with pytest.raises(InputError, match=part):
        sun_position(*arguments)
