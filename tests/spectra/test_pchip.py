import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from spectral_skylight.addon.spectra.pchip import pchip

SAME = 1e-12
"""The same algorithm; its sums round otherwise."""


@pytest.mark.parametrize("samples", [2, 3, 4, 31, 200])
@pytest.mark.parametrize("kind", ["noise", "steps", "rise"])
def test_the_same_as_scipy_s(samples, kind):
    rng = np.random.default_rng(samples)
    for _ in range(50):
        x = 380.0 + np.cumsum(rng.uniform(0.5, 20.0, samples))
        y = rng.random((samples, 4))
        if kind == "steps":  # flat pieces, where slopes are 0
            y = np.round(y)
        elif kind == "rise":
            y = np.cumsum(y, axis=0) / samples
        at = np.concatenate([x, rng.uniform(x[0], x[-1], 100)])
        theirs = PchipInterpolator(x, y)(at)
        np.testing.assert_allclose(pchip(x, y, at), theirs, rtol=0, atol=SAME)
        np.testing.assert_allclose(pchip(x, y[:, 0], at), theirs[:, 0], rtol=0, atol=SAME)


def test_samples_are_met_and_never_overshot():
    rng = np.random.default_rng(0)
    x, y = np.arange(20.0), rng.random((20, 100))
    np.testing.assert_allclose(pchip(x, y, x), y, rtol=0, atol=1e-15)
    fine = pchip(x, y, np.linspace(0, 19, 1901))
    low, high = np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])
    between = fine[:-1].reshape(19, 100, 100)
    assert (between >= low[:, None] - 1e-15).all() and (between <= high[:, None] + 1e-15).all()
