"""Harmonics against their own definition, and a sky fitted to them against the sky itself."""

import numpy as np
import pytest

from spectral_skylight.addon.sky import harmonics
from spectral_skylight.addon.sky.irradiance import spread
from spectral_skylight.addon.sky.lat_long import directions


def test_harmonics_are_orthonormal():
    basis = harmonics.harmonics(spread(20000))
    # A spiral of 20,000 points integrates polynomials of degree 6 to some 1e-6.
    np.testing.assert_allclose(4 * np.pi * basis.T @ basis / 20000, np.eye(16), atol=1e-4)


def test_harmonics_are_those_of_scipy():
    special = pytest.importorskip("scipy.special")
    where = spread(50)
    theta, azimuth = np.arccos(where[:, 2]), np.arctan2(where[:, 1], where[:, 0])
    basis = harmonics.harmonics(where)
    for index, (degree, order) in enumerate(harmonics.KEYS):
        # Its Legendre functions have the Condon-Shortley sign (-1)^m, ours have not.
        m = abs(order)
        legendre = special.lpmv(m, degree, np.cos(theta)) * (-1) ** m
        scale = (2 * degree + 1) / (4 * np.pi)
        scale *= special.factorial(degree - m) / special.factorial(degree + m)
        wave = np.cos(m * azimuth) if order >= 0 else np.sin(m * azimuth)
        expected = np.sqrt(scale * (2 if order else 1)) * legendre * wave
        np.testing.assert_allclose(basis[:, index], expected, atol=1e-12)


@pytest.mark.parametrize("angle", [0.3, -2.0])
def test_rotate_turns_the_function(angle):
    rng = np.random.default_rng(0)
    coefficients = rng.normal(size=16)
    where = spread(100)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    before = harmonics.harmonics(where) @ coefficients
    after = harmonics.harmonics(where @ turn.T) @ harmonics.rotate(coefficients, angle)
    np.testing.assert_allclose(after, before, atol=1e-12)


def test_a_sky_of_harmonics_is_fitted_exactly():
    rng = np.random.default_rng(1)
    wanted = rng.normal(size=(16, 3)) * 0.1
    wanted[0] = [3.0, 4.0, 5.0]
    sky = harmonics.harmonics(directions(180, 360)) @ wanted
    fit = harmonics.fit_sky(sky, 16)
    where = spread(500)
    where = where[where[:, 2] > 0.05]
    # Pixels are brought to cells of 3 degrees: a mean over them is not the value at their middle.
    np.testing.assert_allclose(
        harmonics.harmonics(where) @ fit.coefficients,
        harmonics.harmonics(where) @ wanted,
        atol=0.02,
    )
    assert fit.errors[16][1] < 2e-3


def test_what_lies_below_the_horizon_changes_nothing():
    sky = np.ones((32, 64, 3))
    black = sky.copy()
    black[16:] = 0.0
    both = [harmonics.fit_sky(each).coefficients for each in (sky, black)]
    np.testing.assert_array_equal(*both)


def test_count_is_chosen_by_need():
    even, ragged = np.ones((64, 128, 3)), np.ones((64, 128, 3))
    ragged[20:28, 30:45] = 30.0
    assert harmonics.fit_sky(even).count == 9
    fit = harmonics.fit_sky(ragged)
    assert fit.count == 16
    assert fit.errors[16][0] < fit.errors[9][0]
    np.testing.assert_array_equal(harmonics.fit_sky(even).coefficients[9:], 0.0)
    with pytest.raises(ValueError, match="9 or 16"):
        harmonics.fit_sky(even, 4)
