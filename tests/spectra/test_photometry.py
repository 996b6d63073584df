"""Photometric quantities and color temperatures: standards' and other programs' numbers."""

import warnings

import colour
import numpy as np
import pytest

from spectral_skylight.addon.choices import QUANTITIES
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.spectra import illuminants, photometry
from spectral_skylight.addon.spectra.colour_temperature import cct_and_duv, planckian
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, WEIGHTS
from spectral_skylight.addon.spectra.photometry import ALPHA_OPIC, D65_EFFICACY, quantity
from spectral_skylight.addon.spectra.sensitivities import cmfs
from spectral_skylight.addon.transfer.matrices import transfer

LUX = quantity("illuminance").row


def efficacies(spectrum):
    """α-opic efficacies of luminous radiation [mW/lm], (5,), by the product's rows."""
    edi = np.array([quantity(name).row @ spectrum for name in ALPHA_OPIC])
    return 1e3 * edi * list(D65_EFFICACY.values()) / (LUX @ spectrum)


def test_action_spectra_are_those_of_their_own_sources():
    ours = photometry.action_spectra()
    cones = colour.MSDS_CMFS["Stockman & Sharpe 10 Degree Cone Fundamentals"]
    inside = cones.wavelengths[0] <= WAVELENGTHS
    rows = np.searchsorted(cones.wavelengths, WAVELENGTHS[inside])
    for k, column in enumerate((2, 1, 0)):
        theirs = np.nan_to_num(cones.values[rows, column])
        # The CIE's table has five digits, theirs six.
        np.testing.assert_allclose(ours[k, inside], theirs, atol=6e-6)
        assert not ours[k, ~inside].any()  # not defined under 390 nm
    scotopic = colour.SDS_LEFS["CIE 1951 Scotopic Standard Observer"]
    theirs = np.interp(WAVELENGTHS, scotopic.wavelengths, scotopic.values)
    np.testing.assert_allclose(ours[3], theirs, atol=1e-6)
    assert WAVELENGTHS[ours[4].argmax()] == 490.0 and ours[4].max() == 1.0  # S 026's peak


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # CIE S 026:2018: the constants of D65 [mW/lm].
        ("D65", [0.8173, 1.4558, 1.6289, 1.4497, 1.3262]),
        # luox (M. Spitschan et al. 2021, DOI 10.12688/wellcomeopenres.16595.2), which the CIE has
        # checked: its tests' numbers for the CIE's F2 and F3, in steps of 5 nm as published.
        ("FL2", [0.50829, 1.28123, 1.61608, 0.92436, 0.75508]),
        ("FL3", [0.37863, 1.19980, 1.62351, 0.73296, 0.55404]),
    ],
)
def test_alpha_opic_efficacies_are_the_published_ones(name, expected):
    # Ours are sums over 5 nm; of band-averaged lines they differ by less than 0.1 % from points.
    assert efficacies(illuminants.named(name)) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "ratio"),
    # CIE S 026's α-opic toolbox, of three digits and in steps of 1 nm.
    [("D65", 1.000), ("A", 0.496), ("E", 0.906), ("FL11", 0.564), ("LED-B3", 0.633)],
)
def test_melanopic_daylight_efficacy_ratios(name, ratio):
    spectrum = illuminants.named(name)
    assert quantity("melanopic").row @ spectrum / (LUX @ spectrum) == pytest.approx(ratio, abs=1e-3)


def test_a_thousand_lux_of_daylight_are_a_thousand_of_each():
    spectrum = illuminants.D65() * 1000.0 / (LUX @ illuminants.D65())
    for name in QUANTITIES:
        # The constants have four digits.
        assert quantity(name).row @ spectrum == pytest.approx(1000.0, rel=3e-4)
    # Half of it is sent back by a gray of a half, into pi steradians.
    seen = quantity("luminance").row_on(spectrum[:, None] / np.pi, np.full(81, 0.5))
    assert seen == pytest.approx(500.0 / np.pi)


def test_a_row_on_rgb_is_the_quantity_of_the_restored_spectrum():
    mapping = transfer("rayleigh", white=(1.2, 1.0, 0.8))
    rgb = np.array([0.3, 0.4, 0.6])
    spectrum = mapping.restoration @ (rgb * mapping.white)
    to_spectrum = mapping.unbalanced(mapping.restoration)
    row = quantity("melanopic").row_on(to_spectrum, white_luminance=photometry.LUMINOUS_EFFICACY)
    assert row @ rgb == pytest.approx(np.pi * (quantity("melanopic").row @ spectrum))
    # Linear Rec.709's own weights are what luminance makes of it, where nothing is balanced.
    plain = transfer("rayleigh")
    relative = quantity("luminance").row_on(plain.restoration, white_luminance=1.0)
    np.testing.assert_allclose(relative, [0.2126, 0.7152, 0.0722], atol=1e-4)
    brick = np.linspace(0.1, 0.5, 81)
    by_matrix = relative @ plain.matrices(brick)
    np.testing.assert_allclose(
        quantity("luminance").row_on(plain.restoration, brick, 1.0), by_matrix, atol=1e-12
    )


def test_other_names_are_refused():
    with pytest.raises(InputError, match="'brightness' is not a quantity; choose illuminance"):
        quantity("brightness")


def xyz(spectrum):
    return cmfs() * WEIGHTS @ np.asarray(spectrum).T


def whites(count):
    """CIE 1960 u, v of colors about the Planckian locus, and their XYZ."""
    rng = np.random.default_rng(3)
    u, v = rng.uniform(0.17, 0.34, count), rng.uniform(0.28, 0.38, count)
    x, y = 3 * u / (2 * u - 8 * v + 4), 2 * v / (2 * u - 8 * v + 4)
    return np.stack([u, v], axis=1), np.stack([x / y, np.ones(count), (1 - x - y) / y], axis=1)


def test_temperatures_are_those_of_the_nearest_black_bodies():
    uv, colours = whites(200)
    T, Duv = cct_and_duv(colours)
    told = np.flatnonzero(np.isfinite(T))
    assert len(told) > 100
    for k in told:
        low, high = 0.9 * T[k], 1.1 * T[k]
        for _ in range(6):
            kelvin = np.linspace(low, high, 101)
            X, Y, Z = xyz(planckian(kelvin))
            away = np.hypot(*(np.array([4 * X, 6 * Y]) / (X + 15 * Y + 3 * Z) - uv[k, :, None]))
            at = int(away.argmin())
            low, high = kelvin[max(at - 1, 0)], kelvin[min(at + 1, 100)]
        assert T[k] == pytest.approx(kelvin[at], rel=3e-5)
        assert abs(Duv[k]) == pytest.approx(away[at], abs=1e-6)


def test_temperatures_are_those_of_colour_science():
    uv, colours = whites(100)
    T, Duv = cct_and_duv(colours)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = np.array([colour.temperature.uv_to_CCT_Ohno2013(each) for each in uv])
    told = np.isfinite(T) & (theirs[:, 0] < 20_000)
    assert told.sum() > 50
    # Their locus is that of 360 to 830 nm: it lies 3e-5 beside ours, 0.3 % where it is slow.
    np.testing.assert_allclose(T[told], theirs[told, 0], rtol=3e-3)
    np.testing.assert_allclose(Duv[told], theirs[told, 1], atol=4e-5)


@pytest.mark.parametrize(
    ("name", "kelvin"), [("A", 2856), ("D50", 5003), ("D65", 6504), ("D75", 7504), ("FL11", 3999)]
)
def test_temperatures_of_standard_illuminants(name, kelvin):
    T, _ = cct_and_duv(xyz(illuminants.named(name)))
    # Daylight's nominal temperatures, and the end of the grid at 380 nm.
    assert T == pytest.approx(kelvin, rel=6e-4)


def test_black_bodies_have_their_own_temperature():
    kelvin = np.geomspace(1010.0, 99_000.0, 60)
    T, Duv = cct_and_duv(planckian(kelvin) @ (cmfs() * WEIGHTS).T)
    np.testing.assert_allclose(T, kelvin, rtol=2e-5)
    assert np.abs(Duv).max() < 1e-6


def test_what_is_no_white_has_no_temperature():
    green = xyz(np.eye(81)[30])  # 530 nm alone
    colours = np.array([[0.0, 0.0, 0.0], green])
    T, Duv = cct_and_duv(colours)
    assert np.isnan(T).all() and np.isnan(Duv[0]) and Duv[1] > 0.05
