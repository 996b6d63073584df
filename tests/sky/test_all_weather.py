"""Perez' skies against Radiance's gendaylit, and hours read from weather files."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.all_weather import Weather, all_weather_sky, weather
from spectral_skylight.addon.sky.epw import Station, read_hour, read_station
from spectral_skylight.addon.sky.mixed_sky import PHOTOPIC
from spectral_skylight.addon.sky.simulation import simulate

GENDAYLIT = {
    (15, 1.0, 0.2): (0.585401, -0.543684, 0.940101, -0.685229, 0.018315),
    (70, 1.03, 0.35): (0.992917, -0.336130, 1.905010, -1.008414, -0.086608),
    (40, 1.15, 0.4): (-0.946019, -1.418889, 9.665641, -2.697982, 0.083868),
    (70, 1.3, 0.1): (-1.007661, -0.602909, 15.048257, -3.867150, 0.085296),
    (15, 1.7, 0.3): (-1.220083, -0.762344, 11.160280, -3.111891, -0.004745),
    (40, 2.3, 0.3): (-1.052509, -0.885272, 12.261886, -3.109346, 0.016489),
    (70, 3.5, 0.2): (-0.844053, -0.432863, 12.749722, -3.543009, 0.099507),
    (15, 5.0, 0.15): (-0.997516, -0.263449, 12.266676, -3.857465, 0.470967),
    (40, 7.0, 0.1): (-0.950851, -0.146092, 18.629763, -5.488369, 1.174049),
}
"""Sun's elevation, ε, Δ: a to e as `gendaylit -ang ELEVATION 0 -P ε Δ` of Radiance writes them."""


@pytest.mark.parametrize("given", GENDAYLIT)
def test_coefficients_are_radiances(given):
    elevation, clearness, brightness = given
    found = Weather(clearness, brightness, elevation).coefficients()
    # Written with six decimals, computed in single precision.
    np.testing.assert_allclose(found, GENDAYLIT[given], atol=4e-6)


@pytest.mark.parametrize(
    ("elevation", "direct", "diffuse", "illuminance"),
    [
        (55.0, 700.0, 120.0, 72385),
        (40.0, 300.0, 200.0, 28702),
        (25.0, 50.0, 150.0, 4487),
        (60.0, 400.0, 350.0, 38571),
        (50.0, 850.0, 80.0, 87813),
        (35.0, 150.0, 250.0, 14178),
    ],
)
def test_the_suns_illuminance_is_radiances(elevation, direct, diffuse, illuminance):
    found = weather(direct, diffuse, elevation)
    # Another day's distance of the sun, 1.5 %, is in Δ there.
    assert found.efficacies()[1] * direct == pytest.approx(illuminance, rel=0.002)


def test_overcast_is_cloud_and_clear_is_none():
    assert weather(0.0, 100.0, 40.0).clearness == 1.0
    assert weather(0.0, 100.0, 40.0).cover == 1.0
    assert weather(900.0, 60.0, 60.0).cover == 0.0
    some = weather(300.0, 200.0, 40.0)
    # ε by hand: (500 / 200 + 1.041 * 0.8727³) / (1 + 1.041 * 0.8727³)
    assert some.clearness == pytest.approx(1.8865, abs=1e-3)
    assert 0.6 < some.cover < 0.7


def test_a_sky_gives_the_illuminances_of_its_irradiances():
    clear = simulate(40.0)
    sky = all_weather_sky(clear, 300.0, 200.0)
    by_sky, by_sun = weather(300.0, 200.0, 40.0).efficacies()
    assert sky.irradiance() @ PHOTOPIC == pytest.approx(200.0 * by_sky, rel=1e-5)
    assert sky.direct @ PHOTOPIC == pytest.approx(300.0 * by_sun, rel=1e-9)
    assert 100 < by_sky < 140 and 80 < by_sun < 115  # lm/W of daylight


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ((100.0, 100.0, 0.0), "^sun: its elevation is 0.0°"),
        ((100.0, 0.0, 10.0), "^diffuse irradiance: 0 W/m²"),
        ((-1.0, 10.0, 10.0), "^direct irradiance: -1 W/m²"),
        ((float("nan"), 10.0, 10.0), "^direct irradiance: nan"),
    ],
)
def test_what_is_refused(arguments, part):
    with pytest.raises(InputError, match=part):
        weather(*arguments)


def epw(path, rows=None, *, steps=1, head="LOCATION,Zürich,-,CHE,IWEC,066700,47.4,8.6,1.0,436.0"):
    """Write a weather file of a day, in latin-1 as many are."""
    if rows is None:
        rows = [row(hour, 50.0 * hour, 10.0 * hour) for hour in range(1, 25)]
    names = ("DESIGN", "TYPICAL", "GROUND", "HOLIDAYS", "COMMENTS 1", "COMMENTS 2")
    lines = [
        head,
        *(f"{name},x" for name in names),
        f"DATA PERIODS,1,{steps},Data,Sunday, 1/ 1,12/31",
    ]
    path.write_bytes("\r\n".join([*lines, *rows]).encode("latin-1"))
    return path


def row(hour, direct, diffuse, month=6, day=21, year=1992):
    values = [15.0, 9.0, 60, 96000, 0, 1325, 300, 500, direct, diffuse, 0, 0, 0, 0]
    return f"{year},{month},{day},{hour},60,flags," + ",".join(map(str, values))


def test_an_hour_is_read(tmp_path):
    path = epw(tmp_path / "a.epw")
    found = read_hour(path, "2025-06-21", "14:30")  # the 15th hour
    assert (found.direct, found.diffuse, found.extraterrestrial) == (750.0, 150.0, 1325.0)
    assert found.station == read_station(path) == Station("Zürich", 47.4, 8.6, "+1")
    text = path.read_bytes().decode("latin-1")
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"):
        path.write_bytes(text.encode(encoding))
        assert read_hour(path, "2025-06-21", "14:30") == found


@pytest.mark.parametrize(
    ("file", "time", "part"),
    [
        ({"rows": [row(15, 9999, 100)]}, "14:30", "line 9: direct radiation .* not measured"),
        ({"rows": [row(15, 100, 9999)]}, "14:30", "line 9: diffuse radiation .* not measured"),
        ({"rows": [row(15, 100, "x")]}, "14:30", "line 9: 'x' is no number"),
        ({"rows": [row(15, 100, 100)]}, "15:00", "has no hour 16 of day 21, month 6"),
        ({"rows": [row(15, 100, 100)[:40]]}, "14:30", "line 9: ends early"),
        ({"rows": []}, "14:30", "has no hour 15"),
        ({"steps": 4}, "14:30", "has 4 values an hour"),
        ({"head": "wavelength,a"}, "14:30", "does not begin with LOCATION"),
        ({"head": "LOCATION,a,b,c,d,e,north,8,1,0"}, "14:30", "line 1: 'north' is no number"),
        ({}, "25:00", "^date: .* is not a date and time"),
        ({"rows": [row(15, 100, "")]}, "14:30", "line 9: diffuse radiation .* not measured"),
        ({"rows": [row(15, -9999, 9)]}, "14:30", "line 9: direct radiation .* not measured"),
        ({"rows": [row(0, 0, 0), row(14, 1, 1)]}, "14:30", "line 9: counts hours from 0"),
        ({"rows": [row(15, 1, 1), row(15, 2, 2)]}, "14:30", "line 10: is the same hour as line 9"),
        (
            {"rows": [row(15, 1, 1, year=2019), row(15, 2, 2, year=2021)]},
            "14:30",
            "has that hour in 2019, 2021; give a date in one of these years",
        ),
        ({"head": "LOCATION;a;b;c;d;e;1;2;0;9"}, "14:30", "is not separated by commas"),
        ({"head": "LOCATION,a,b,c,d,e,999,8,1,0"}, "14:30", "line 1: the latitude is 999; mend"),
        ({"head": "LOCATION,a,b,c,d,e,9,,1,0"}, "14:30", "line 1: the longitude is 9999"),
        ({"head": "LOCATION,a,b,c,d,e,9,8,60,0"}, "14:30", "line 1: the time zone is 60"),
    ],
)
def test_files_that_are_none(tmp_path, file, time, part):
    with pytest.raises(InputError, match=part):
        read_hour(epw(tmp_path / "a.epw", **file), "2025-06-21", time)


def test_an_hour_of_the_dates_own_year(tmp_path):
    rows = [row(15, 100.0 + year, 50, year=year) for year in (2024, 2025)]
    found = read_hour(epw(tmp_path / "a.epw", rows), "2025-06-21", "14:30")
    assert found.direct == 2125.0


def test_the_last_hour_and_a_leap_day(tmp_path):
    rows = [row(24, 1, 2), row(12, 3, 4, month=2, day=29)]
    path = epw(tmp_path / "a.epw", rows)
    assert read_hour(path, "2025-06-21", "23:59").direct == 1.0
    assert read_hour(path, "2024-02-29", "11:00").direct == 3.0
    with pytest.raises(InputError, match="has no hour 12 of day 29.* typical years have no leap"):
        read_hour(epw(tmp_path / "b.epw"), "2024-02-29", "11:00")


@pytest.mark.parametrize(
    "head",
    [
        'LOCATION,"Washington, DC",-,USA,TMY3,1,47.4,8.6,1.0,436.0',
        "LOCATION,Frankfurt, Main,-,DEU,IWEC,1,47.4,8.6,1.0,436.0",
        "LOCATION,Zürich\x85,-,CHE,IWEC,1,47.4,8.6,1.0,436.0,,,,",
        "LOCATION,Zürich,-,CHE,IWEC,1,47.4,8.6,1.0,",
    ],
)
def test_first_lines_of_many_kinds(tmp_path, head):
    """Commas in names, what is the end of a line in other encodings, a spreadsheet's padding."""
    found = read_hour(epw(tmp_path / "a.epw", head=head), "2025-06-21", "14:30").station
    assert (found.latitude, found.longitude, found.timezone) == (47.4, 8.6, "+1")


def test_files_cut_off_anywhere(tmp_path):
    line = row(15, 700, 100)
    content = epw(tmp_path / "a.epw", [line]).read_bytes()
    told = len(content) - len(line) + line.index("700,100,") + len("700,100,")
    for length in range(told):
        (tmp_path / "b.epw").write_bytes(content[:length])
        with pytest.raises(InputError):
            read_hour(tmp_path / "b.epw", "2025-06-21", "14:30")
    with pytest.raises(InputError, match="no such file|does not exist"):
        read_hour(tmp_path / "none.epw", "2025-06-21", "14:30")
