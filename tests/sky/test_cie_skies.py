"""The CIE's standard skies against the formulas and values that were published before them."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.cie_skies import (
    STANDARDS,
    cie_luminance,
    cie_sky,
    overcast_illuminance,
)
from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.simulation import nodes, simulate
from spectral_skylight.addon.spectra.grid import WEIGHTS
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.photometry import LUMINOUS_EFFICACY
from spectral_skylight.addon.spectra.sensitivities import cmfs

ELEVATION, AZIMUTH = np.radians(np.mgrid[1:90:4, 0:180:7].astype(float))
PHOTOPIC = LUMINOUS_EFFICACY * WEIGHTS * cmfs()[1]


def chi_of(sun):
    """The angle [rad] of the directions from the sun [degrees]."""
    sun = np.radians(sun)
    cosine = np.sin(sun) * np.sin(ELEVATION)
    return np.arccos(cosine + np.cos(sun) * np.cos(ELEVATION) * np.cos(AZIMUTH))


@pytest.mark.parametrize("sun", [5.0, 35.0, 80.0])
def test_the_clear_sky_is_kittlers(sun):
    """CIE 1973, No. 22 (Kittler 1967): the same formula with its constants multiplied out."""

    def f(angle):
        return 0.91 + 10 * np.exp(-3 * angle) + 0.45 * np.cos(angle) ** 2

    wanted = f(chi_of(sun)) * (1 - np.exp(-0.32 / np.sin(ELEVATION)))
    wanted /= f(np.radians(90 - sun)) * 0.274  # 1 - exp(-0.32), as it was published
    # 0.91 and 0.274 are rounded to two and three digits: 0.3 % and 0.1 %.
    np.testing.assert_allclose(cie_luminance(12, sun, ELEVATION, AZIMUTH), wanted, rtol=4e-3)


@pytest.mark.parametrize("sun", [5.0, 35.0, 80.0])
def test_the_polluted_sky_is_gusevs(sun):
    """The turbid sky of the CIE's guide: 0.856 + 16 exp(-3 χ) + 0.3 cos² χ."""

    def f(angle):
        return 0.856 + 16 * np.exp(-3 * angle) + 0.3 * np.cos(angle) ** 2

    wanted = f(chi_of(sun)) * (1 - np.exp(-0.32 / np.sin(ELEVATION)))
    wanted /= f(np.radians(90 - sun)) * (1 - np.exp(-0.32))
    np.testing.assert_allclose(cie_luminance(13, sun, ELEVATION, AZIMUTH), wanted, rtol=1e-3)


def test_the_overcast_sky_is_moon_and_spencers():
    """Type 1 stands for (1 + 2 sin γ) / 3, 1942: its horizon is 1 : 3, E = 7 π / 9 L_z."""
    assert cie_luminance(1, 30.0, 0.0, 1.0) == pytest.approx(1 / 3, abs=0.002)
    elevation, azimuth, share = nodes(96, 181)
    relative = cie_luminance(1, 30.0, *np.broadcast_arrays(elevation[:, None], azimuth))
    assert (share * relative).sum() == pytest.approx(7 * np.pi / 9, rel=0.015)


@pytest.mark.parametrize("number", STANDARDS)
def test_each_is_one_in_the_zenith_and_symmetric(number):
    assert cie_luminance(number, 25.0, np.pi / 2, 0.0) == pytest.approx(1.0)
    left, right = (cie_luminance(number, 25.0, ELEVATION, sign * AZIMUTH) for sign in (1, -1))
    np.testing.assert_array_equal(left, right)
    assert left.min() > 0
    towards = cie_luminance(number, 25.0, np.radians([25.0, 25.0]), np.array([0.0, np.pi]))
    uniform = STANDARDS[number].indicatrix == 1
    assert towards[0] == towards[1] if uniform else towards[0] > 1.3 * towards[1]


@pytest.fixture(scope="module")
def clear():
    return simulate(30.0)


@pytest.mark.parametrize("number", [1, 7, 12])
def test_a_sky_has_the_standards_luminance_and_the_illuminance_asked_for(clear, number):
    sky = cie_sky(number, clear, 12345.0)
    assert sky.irradiance() @ PHOTOPIC == pytest.approx(12345.0, rel=1e-5)  # tables of float32
    found = sky.radiance(ELEVATION, AZIMUTH) @ PHOTOPIC
    found /= sky.radiance(np.pi / 2, 0.0) @ PHOTOPIC
    wanted = cie_luminance(number, 30.0, ELEVATION, AZIMUTH)
    np.testing.assert_allclose(found, wanted, rtol=1e-5)
    seen = sky.seen_by(PHOTOPIC[None])
    np.testing.assert_allclose(
        seen.radiance(ELEVATION, AZIMUTH)[..., 0], sky.radiance(ELEVATION, AZIMUTH) @ PHOTOPIC, 1e-5
    )


def test_spectra_are_the_clouds_or_the_clear_skys(clear):
    def shape(spectrum):
        return spectrum / (spectrum @ PHOTOPIC)

    place = np.radians(50.0), 1.0
    cloud, blue = shape(D65()), shape(clear.radiance(*place))
    for number, wanted in ((3, cloud), (12, blue), (8, (cloud + blue) / 2)):
        found = shape(cie_sky(number, clear).radiance(*place))
        np.testing.assert_allclose(found, wanted, rtol=1e-4)
        direct = cie_sky(number, clear).direct
        np.testing.assert_allclose(direct, clear.direct * (1 - STANDARDS[number].cover))


def test_illuminance_by_itself(clear):
    assert overcast_illuminance(30.0) == pytest.approx(10800.0)
    assert cie_sky(1, clear).irradiance() @ PHOTOPIC == pytest.approx(10800.0, rel=1e-5)
    by_day = clear.irradiance() @ PHOTOPIC
    assert cie_sky(12, clear).irradiance() @ PHOTOPIC == pytest.approx(by_day, rel=1e-5)


def test_a_picture_of_one(clear):
    grey = picture(cie_sky(5, clear, 10000.0), 32, 180.0, sensitivities=PHOTOPIC[None])[..., 0]
    np.testing.assert_allclose(grey[:16], 10000.0 / np.pi, rtol=1e-4)
    np.testing.assert_allclose(grey[16:], 0.2 * 10000.0 / np.pi, rtol=1e-4)  # overcast: no sun


def test_what_is_refused(clear):
    for number in (0, 16, -1):
        with pytest.raises(InputError, match="^cie: there is no standard sky"):
            cie_sky(number, clear)
    for lux in (0.0, -5.0, float("nan"), float("inf")):
        with pytest.raises(InputError, match="^illuminance: "):
            cie_sky(1, clear, lux)
    with pytest.raises(InputError, match="^sun elevation: .* need one of 0 to 90"):
        cie_sky(1, simulate(-3.0))
