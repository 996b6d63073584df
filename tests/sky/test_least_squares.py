"""Beside SciPy's: the same minimum, or a lower one."""

import numpy as np
import pytest
import scipy.optimize

from spectral_skylight.addon.sky import direct_sun
from spectral_skylight.addon.sky.least_squares import least_squares
from spectral_skylight.addon.spectra.sensitivities import observer

RNG = np.random.default_rng(5)


def theirs(residuals, start, low, high):
    """By SciPy's best: central differences, until nothing moves any more."""
    found = scipy.optimize.least_squares(
        residuals, start, jac="3-point", bounds=(low, high), ftol=1e-15, xtol=1e-15, gtol=1e-15
    )
    return found.x


def test_a_straight_problem_is_the_normal_equations():
    A, b = RNG.normal(size=(9, 3)), RNG.normal(size=9)
    far = np.full(3, 100.0)
    found = least_squares(lambda x: A @ x - b, np.zeros(3), -far, far)
    np.testing.assert_allclose(found, np.linalg.lstsq(A, b, rcond=None)[0], atol=1e-9)


def test_a_limit_holds_and_the_others_settle_along_it():
    A, b = np.diag([1.0, 2.0, 3.0]) + 0.3, np.array([5.0, 1.0, -9.0])
    low, high = np.array([-1.0, -1.0, -1.0]), np.array([1.0, 1.0, 1.0])
    found = least_squares(lambda x: A @ x - b, np.zeros(3), low, high)
    np.testing.assert_allclose(
        found, theirs(lambda x: A @ x - b, np.zeros(3), low, high), atol=1e-6
    )
    assert found[0] == 1.0 and found[2] == -1.0 and -1.0 < found[1] < 1.0


def test_all_at_their_limits():
    found = least_squares(lambda x: x - 5.0, np.zeros(2), np.full(2, -1.0), np.ones(2))
    assert found.tolist() == [1.0, 1.0]


def test_a_bent_valley():
    """Rosenbrock's, whose minimum is known: 0 at (1, 1)."""
    found = least_squares(
        lambda x: np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]),
        np.array([-1.2, 1.0]),
        np.full(2, -3.0),
        np.full(2, 3.0),
    )
    np.testing.assert_allclose(found, 1.0, atol=1e-8)


@pytest.mark.parametrize("elevation", [0.0, 3.0, 12.0, 50.0, 90.0])
def test_the_sun_s_air_is_no_less_likely_than_scipy_s(elevation, monkeypatch):
    """Colours that a sun has, that it nearly has, and that none has."""
    problems = []

    def noting(residuals, start, low, high):
        found = least_squares(residuals, start, low, high)
        problems.append((residuals, found, theirs(residuals, start, low, high)))
        return found

    monkeypatch.setattr(direct_sun, "least_squares", noting)
    S = observer()
    plain = direct_sun.direct_sunlight(elevation)
    tilts = RNG.normal(0.0, 0.5, 4)[:, None] * np.linspace(-1, 1, 81)
    colours = [*(np.exp(tilts) * plain @ S.T), [1, 1, 1], [0.2, 0.9, 0.3], [1, 0.1, 0.01]]
    for colour in colours:
        direct_sun.direct_sunlight(elevation, colour)
    assert len(problems) == len(colours)
    for residuals, ours, best in problems:
        left, least = np.sum(residuals(ours) ** 2), np.sum(residuals(best) ** 2)
        assert left <= least * (1 + 1e-12) + 1e-12
        if left > least - 1e-9:  # not another, deeper valley
            # SciPy's stands still where its differences of 6e-6 cannot tell a slope any more.
            np.testing.assert_allclose(ours, best, atol=1e-5)
