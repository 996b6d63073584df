"""The sun's place against NREL's solar position algorithm, which pvlib has."""

import numpy as np
import pytest

from spectral_skylight.addon.sky.solar_position import refraction, solar_position

AIR = {"elev": 0.0, "pressure": 1013.25, "temp": 15.0, "atmos_refract": 0.5667}


def moments(first, last, count, seed):
    """Random instants [s] between two years, and places [degrees]."""
    random = np.random.default_rng(seed)
    years = random.uniform(first, last, count)
    seconds = np.round((years - 1970) * 365.2425 * 86400)
    latitude = np.degrees(np.arcsin(random.uniform(-1, 1, count)))
    return years, seconds, latitude, random.uniform(-180, 180, count)


def by_nrel(years, seconds, latitude, longitude):
    """Apparent elevation, elevation and azimuth of Reda and Andreas [degrees]."""
    spa = pytest.importorskip("pvlib.spa")
    ahead = spa.calculate_deltat(years.astype(int), np.full(years.size, 6))
    found = spa.solar_position(seconds, latitude, longitude, delta_t=ahead, **AIR)
    return found[2], found[3], found[4]


def apart(elevation, azimuth, other_elevation, other_azimuth):
    """The angle [degrees] between two directions."""

    def vectors(elevation, azimuth):
        up, turn = np.radians(elevation), np.radians(azimuth)
        return np.array([np.cos(up) * np.sin(turn), np.cos(up) * np.cos(turn), np.sin(up)])

    chord = vectors(elevation, azimuth) - vectors(other_elevation, other_azimuth)
    return np.degrees(2 * np.arcsin(np.linalg.norm(chord, axis=0) / 2))


@pytest.mark.parametrize(
    ("first", "last", "most"),
    [(1950, 2100, 0.005), (1600, 2400, 0.005), (1, 3000, 0.013)],  # as the docstring says
)
def test_random_instants_and_places(first, last, most):
    years, *where = moments(first, last, 1500, seed=first)
    _, elevation, azimuth = by_nrel(years, *where)
    assert apart(*solar_position(*where), elevation, azimuth).max() < most


def test_the_refracted_sun():
    years, *where = moments(1950, 2100, 1500, seed=3)
    apparent, elevation, azimuth = by_nrel(years, *where)
    found = solar_position(*where, refracted=True)
    # Where the upper limb just touches the horizon the lift begins at once: a step.
    clear = abs(elevation + 0.26667 + 0.5667) > 0.01
    assert clear.sum() > 1490
    assert apart(*found, apparent, azimuth)[clear].max() < 0.01
    # Saemundsson's 29 minutes of arc on the horizon.
    assert refraction(0.0) == pytest.approx(0.48, abs=0.01)
    assert refraction(-5.0) == 0 and refraction(90.0) == pytest.approx(0.0, abs=1e-4)


def test_reda_and_andreas_example():
    # NREL/TP-560-34302, table A5.1, 2003-10-17 19:30:30 UTC: topocentric elevation without
    # refraction e0 39.872046°, azimuth 194.340241°.
    elevation, azimuth = solar_position(1066419030.0, 39.742476, -105.1786)
    assert elevation == pytest.approx(39.872046, abs=0.005)
    assert azimuth == pytest.approx(194.340241, abs=0.005)


def test_the_poles_see_one_sun():
    seconds = 1.75e9 + np.arange(24) * 3600.0
    for pole, sign in ((90.0, 1), (-90.0, -1)):
        elevation, azimuth = solar_position(seconds, pole, 0.0)
        assert np.ptp(elevation) < 0.4  # what the declination changes in a day
        turned = np.diff(np.unwrap(azimuth, period=360.0)) * sign
        np.testing.assert_allclose(turned, 15.0, atol=0.02)


def test_shapes_are_broadcast():
    elevation, azimuth = solar_position(np.zeros((2, 1)), [10.0, 20.0, 30.0], 5.0)
    assert elevation.shape == azimuth.shape == (2, 3)
    np.testing.assert_array_equal(elevation[0], elevation[1])
