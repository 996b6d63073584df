import numpy as np
import pytest
from scipy.integrate import trapezoid

from spectral_skylight.addon.spectra.bases import daylight, rayleigh
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, WEIGHTS, band_average, resample
from spectral_skylight.addon.spectra.sensitivities import cmfs
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight

ROUNDING = 1e-12


def test_weights_integrate_straight_lines_exactly():
    # int_380^780 (a + b l) dl
    exact = 2.0 * 400 + 0.01 * (780**2 - 380**2) / 2
    assert WEIGHTS @ (2.0 + 0.01 * WAVELENGTHS) == pytest.approx(exact, rel=ROUNDING)


def test_band_average_keeps_straight_lines():
    x = np.linspace(300.0, 900.0, 1234)
    means = band_average(x, 2.0 + 0.01 * x)
    centred = means[1:-1]  # an end node has half a hat, whose centre lies a third of a step inside
    np.testing.assert_allclose(centred, 2.0 + 0.01 * WAVELENGTHS[1:-1], rtol=1e-9)
    assert means[0] == pytest.approx(2.0 + 0.01 * (380 + 5 / 3), rel=1e-9)


def test_band_average_makes_the_quadrature_exact_for_lines():
    """A spectral line between nodes is weighed as a straight-lined sensitivity would see it."""
    x = np.arange(379.0, 782.0, 0.25)
    line = np.where(np.abs(x - 433.25) < 0.3, 1.0, 0.0)
    sensitivity = np.sin(WAVELENGTHS / 50) + 2
    fine = np.interp(x, WAVELENGTHS, sensitivity)
    # Simpson's rule on the fine grid is exact for line x straight pieces.
    exact = np.sum((line[1:] * fine[1:] + line[:-1] * fine[:-1]) * 2) / 6 * 0.25
    exact += np.sum(line[1:] * fine[:-1] + line[:-1] * fine[1:]) / 6 * 0.25
    assert (sensitivity * WEIGHTS) @ band_average(x, line) == pytest.approx(exact, rel=1e-9)


def test_sunlight_conserves_energy_where_point_samples_alias():
    from colour.plotting.datasets.astm_g_173 import SD_ASTMG173_ETR as table

    inside = (table.wavelengths >= 380) & (table.wavelengths <= 780)
    exact = trapezoid(table.values[inside], table.wavelengths[inside])
    assert WEIGHTS @ extraterrestrial_sunlight() == pytest.approx(exact, rel=1e-9)
    points = np.interp(WAVELENGTHS, table.wavelengths, table.values)
    # This is why: the largest error of a point sample is no rounding matter.
    assert np.abs(points / extraterrestrial_sunlight() - 1).max() > 0.1


def test_resample_leaves_samples_on_the_grid_alone():
    rng = np.random.default_rng(1)
    values = rng.uniform(0, 1, (81, 3))
    np.testing.assert_allclose(resample(WAVELENGTHS, values), values.T, atol=ROUNDING)


def test_resample_never_overshoots_a_step():
    x = np.arange(380.0, 781.0, 20.0)
    step = np.where(x < 560, 0.02, 0.97)
    values = resample(x, step)
    assert values.min() >= 0.02 and values.max() <= 0.97


def test_resample_holds_the_ends():
    values = resample([400.0, 500.0, 700.0], [0.2, 0.5, 0.7])
    assert np.all(values[WAVELENGTHS < 400] == 0.2) and np.all(values[WAVELENGTHS > 700] == 0.7)


def test_resample_averages_noise_of_dense_samples():
    x = np.arange(370.0, 790.0, 0.5)
    noisy = 0.5 + 0.1 * np.random.default_rng(2).standard_normal(x.size)
    # A hat of 10 nm over samples 0.5 nm apart averages about 13 of them.
    assert np.std(resample(x, noisy)) < 0.1 / np.sqrt(10)


def test_observer_sees_the_equal_energy_white_as_published():
    # CIE 15: x = y = 1/3 for illuminant E; 5 nm sums are good to 1e-4.
    XYZ = cmfs() @ WEIGHTS
    np.testing.assert_allclose(XYZ / XYZ.sum(), 1 / 3, atol=1e-4)


def test_bases_hold_what_they_say():
    i = np.flatnonzero(WAVELENGTHS == 550)[0]
    basis = rayleigh()
    np.testing.assert_allclose(basis[:, i], extraterrestrial_sunlight()[i], rtol=ROUNDING)
    ratio = (550 / WAVELENGTHS) ** 4
    np.testing.assert_allclose(basis[2] / basis[1], ratio, rtol=ROUNDING)
    # CIE 15:2004 table T.2 at 380, 560 and 780 nm.
    columns = np.searchsorted(WAVELENGTHS, [380, 560, 780])
    np.testing.assert_allclose(
        daylight()[:, columns], [[63.4, 100, 65.0], [38.5, 0, -10.4], [3.0, 0, 6.8]], atol=1e-9
    )
