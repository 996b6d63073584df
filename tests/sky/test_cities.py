"""Cities are found by what people type, and lie where independent sources have them."""

import json
from datetime import UTC, datetime

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky import cities
from spectral_skylight.addon.sky.sun_position import sun_position
from spectral_skylight.addon.sky.time_zones import names, time_zone


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Paris", ("France", 48.86, 2.35, "Europe/Paris")),
        ("paris, TEXAS", ("Texas, United States", 33.66, -95.56, "America/Chicago")),
        ("munchen", ("Germany", 48.14, 11.58, "Europe/Berlin")),
        ("Múnich, germ", ("Germany", 48.14, 11.58, "Europe/Berlin")),
        ("Wien", ("Austria", 48.21, 16.37, "Europe/Vienna")),
        ("東京", ("Japan", 35.69, 139.69, "Asia/Tokyo")),
        ("Łódź", ("Poland", 51.76, 19.46, "Europe/Warsaw")),
        ("Quito", ("Ecuador", -0.18, -78.47, "America/Guayaquil")),
        ("Longyearbyen", ("Svalbard and Jan Mayen", 78.22, 15.65, "Arctic/Longyearbyen")),
    ],
)
def test_a_city_by_its_name(text, found):
    """Coordinates are those of the Wikipedia article, to what a city is wide."""
    one = cities.city(text)
    assert (one.region, one.timezone) == (found[0], found[3])
    assert (one.latitude, one.longitude) == pytest.approx(found[1:3], abs=0.1)


def test_what_is_typed_is_completed():
    assert "München, Germany" in cities.suggestions("munch")
    assert cities.suggestions("Zürich")[0] == "Zürich, Switzerland"
    assert cities.suggestions("aires")[0] == "Buenos Aires, Argentina"
    assert cities.suggestions("paris, t") == ["Paris, Texas, United States"]
    assert cities.suggestions(" ") == cities.suggestions("qqqq") == []
    assert len(cities.suggestions("s", 5)) == 5
    for text in ("springf", "san", "to", "мос", "ber"):
        labels = cities.suggestions(text)
        assert labels and [cities.city(label).label for label in labels] == labels


def test_a_city_that_is_not_there():
    with pytest.raises(InputError, match="^city: 'Entenhausen' is not in the list; give"):
        cities.city("Entenhausen")
    with pytest.raises(InputError, match="did you mean Paris, France or"):
        cities.city("Paris, Atlantis")
    with pytest.raises(InputError, match="^city: '' is not"):
        cities.city("")


def test_every_city_has_a_place_and_a_zone():
    with np.load(cities.FILE) as file:
        about = json.loads(file["about"].tobytes())
        latitude, longitude = file["places"] / 100.0
        zones = np.array(about["zones"])[file["zones"]]
        assert file["regions"].max() < len(about["regions"])
    assert latitude.size == zones.size > 30_000
    assert np.abs(latitude).max() < 80 and np.abs(longitude).max() <= 180
    assert set(about["zones"]) <= set(names())
    assert "CC BY 4.0" in about["source"]
    # Clocks follow the sun: winter's time of a zone is within some hours of the meridian's.
    new_year = datetime(2025, 1, 1, tzinfo=UTC)
    hours = {
        name: new_year.astimezone(time_zone(name)).utcoffset().total_seconds() / 3600
        for name in about["zones"]
    }
    off = np.abs((np.array([hours[z] for z in zones]) - longitude / 15 + 12) % 24 - 12)
    assert np.percentile(off, 99) < 3.0 and off.max() < 4.0


def test_zones_are_those_of_python():
    """Where the computer has the tz database too, both tell the same."""
    from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

    moments = [
        datetime(year, month, day, hour)
        for year in (1975, 2003, 2024, 2038, 2090)
        for month, day in ((1, 15), (3, 31), (7, 1), (10, 27))
        for hour in (1, 12)
    ]
    compared = 0
    for name in ("Europe/Berlin", "America/New_York", "Asia/Kolkata", "Australia/Lord_Howe"):
        try:
            theirs = ZoneInfo(name)
        except ZoneInfoNotFoundError:
            continue
        compared += 1
        ours = time_zone(name)
        for moment in moments:
            ours_has, theirs_has = (moment.replace(tzinfo=zone) for zone in (ours, theirs))
            assert ours_has.utcoffset() == theirs_has.utcoffset(), (name, moment)
            assert ours_has.dst() == theirs_has.dst(), (name, moment)
    if not compared:
        pytest.skip("this computer has no tz database to compare with")


def test_zones_need_no_tables_of_the_computer():
    """As on Windows, where Python has none."""
    import zoneinfo

    zoneinfo.reset_tzpath(to=[])
    try:
        time_zone.cache_clear()
        summer = sun_position("2025-06-21", "14:30", 52.5, 13.4, "Europe/Berlin")
    finally:
        zoneinfo.reset_tzpath()
    assert summer == sun_position("2025-06-21", "14:30", 52.5, 13.4, "+2")
    with pytest.raises(KeyError):
        time_zone("Mars/Olympus")
