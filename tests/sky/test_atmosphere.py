"""What the air is made of, against published figures and other people's spectra."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky import atmosphere, gases
from spectral_skylight.addon.sky.atmosphere import (
    EARTH_RADIUS,
    Atmosphere,
    medium,
    rayleigh_optical_depth,
)
from spectral_skylight.addon.sky.path_lengths import columns_to_space
from spectral_skylight.addon.sky.scattering import sun_transmittance
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, band_average
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight

GROUND = np.array(EARTH_RADIUS)


def test_rayleigh_optical_depth_is_bodhaines():
    # Bodhaine et al. 1999, table 3 (sea level, 360 ppm CO2): 400, 550 and 700 nm.
    at = np.searchsorted(WAVELENGTHS, [400, 550, 700])
    np.testing.assert_allclose(
        rayleigh_optical_depth()[at], [0.36022, 0.09724, 0.03650], rtol=0.005
    )


def test_without_dispersion_air_is_a_power():
    exact = rayleigh_optical_depth(dispersion=False)
    np.testing.assert_allclose(exact * WAVELENGTHS**4, exact[0] * WAVELENGTHS[0] ** 4, rtol=1e-12)
    # Bodhaine's formula itself is given to 0.01 %.
    assert exact[34] == pytest.approx(rayleigh_optical_depth()[34], rel=2e-4)


def test_air_thins_out_as_the_standard_has_it():
    # U.S. Standard Atmosphere 1976, table I, geometric altitude: rho / rho0.
    altitude = np.array([0.0, 5e3, 10e3, 20e3, 30e3, 40e3, 60e3, 80e3])
    published = [1.0, 0.60117, 0.33756, 0.072579, 0.015029, 3.2618e-3, 2.5280e-4, 1.5068e-5]
    np.testing.assert_allclose(atmosphere._air_density(altitude), published, rtol=2e-4)


def test_ozone_lies_where_it_is_found():
    edges, density = atmosphere._shells(100)
    middle = 0.5 * (edges[1:] + edges[:-1])
    assert 20e3 < middle[density[:, 2].argmax()] < 24e3
    # The table's own column, 345 DU by its authors: a slip in a digit would show.
    density, altitude = atmosphere._OZONE_DENSITIES * 1e17, atmosphere._OZONE_ALTITUDES
    total = np.sum(0.5 * (density[1:] + density[:-1]) * np.diff(altitude))
    assert total / gases.DOBSON == pytest.approx(345.0, rel=0.02)


def test_a_vertical_column_is_one():
    columns = columns_to_space(medium(Atmosphere()), GROUND, np.array(1.0))
    np.testing.assert_allclose(columns, 1.0, rtol=1e-12)


def test_ozone_keeps_the_means_of_its_table():
    sigma = gases.ozone_cross_section()
    fine = np.arange(385.0, 775.0, 0.1)
    curve = np.interp(fine, WAVELENGTHS, sigma)
    for k, mean in enumerate(gases._OZONE):
        low = gases._OZONE_BINS[k]
        if 390 <= low <= 760:
            inside = (fine >= low) & (fine < low + 10)
            # Hats of 5 nm smooth the curve: 3 % of the band's height is what that takes at its
            # narrow features.
            assert curve[inside].mean() == pytest.approx(mean, abs=0.03 * sigma.max())
    assert WAVELENGTHS[sigma.argmax()] == 605.0


@pytest.mark.parametrize("kind", [0, 1])
def test_bands_are_linear_when_thin_and_square_root_like_when_thick(kind):
    columns = np.zeros((4, 2))
    columns[:, kind] = [1e-9, 2e-9, 1e3, 2e3]
    depth = gases.band_depth(columns)[:, gases.band_absorption()[1][kind] > 1.0]
    np.testing.assert_allclose(depth[1] / depth[0], 2.0, rtol=1e-3)
    # The exponent of the model is 1 - 0.45.
    np.testing.assert_allclose(depth[3] / depth[2], 2.0**0.55, rtol=1e-3)


def test_optical_depths_are_spectrl2s():
    """Bird and Riordan's formulas, as pvlib has them, at their own wavelengths."""
    spectrl2 = pytest.importorskip("pvlib.spectrum.spectrl2")
    table = spectrl2._SPECTRL2_COEFFS
    nodes = table["wavelength"]
    visible = (nodes >= 380) & (nodes <= 780)
    nodes = nodes[visible]
    air, haze, ozone = medium(Atmosphere(haze=0.1, angstrom=1.14)).extinction
    mu = nodes / 1000
    # Their fit of 1981 is 1.2 % above Bodhaine's measured air throughout.
    theirs = 1 / (mu**4 * (115.6406 - 1.3366 / mu**2))
    np.testing.assert_allclose(np.interp(nodes, WAVELENGTHS, air), theirs, rtol=0.015)
    np.testing.assert_allclose(
        np.interp(nodes, WAVELENGTHS, haze), 0.1 * (550 / nodes) ** 1.14, rtol=1e-3
    )
    # Given to 0.001 / cm and from before 1980: 0.0025 at the peak of 0.038 for 300 DU.
    theirs = table["ozone_absorption"][visible] * 0.3
    np.testing.assert_allclose(np.interp(nodes, WAVELENGTHS, ozone), theirs, atol=0.0025)


def test_direct_sun_is_astms(shared_data):
    """ASTM G173-03 direct: air mass 1.5, 1.42 cm of water, 343.8 DU, haze 0.084 at 500 nm."""
    table = np.genfromtxt(
        shared_data / "sky" / "astm_g173" / "ASTMG173.csv", delimiter=",", skip_header=2
    )
    direct = band_average(table[:, 0], table[:, 3])
    air = Atmosphere(haze=0.084 * (500 / 550) ** 1.3, ozone=343.8, water=14.2)
    ours = sun_transmittance(90.0 - 48.236, air) * extraterrestrial_sunlight()
    # Its haze (Shettle and Fenn's rural) bends where Ångström's law is straight: 1.3 % at 400 nm,
    # 2.3 % at 380 nm; and it counts light from within 2.9° of the sun. Air, ozone and the way
    # through them are ours; the bands were found from this very spectrum.
    np.testing.assert_allclose(ours, direct, rtol=0.025)
    np.testing.assert_allclose(ours[4:], direct[4:], rtol=0.015)


def test_ways_along_the_horizon_are_chapmans():
    """Kasten and Young 1989 (DOI 10.1364/AO.28.004735) fitted the air mass of this same air."""
    elevation = np.array([90.0, 60.0, 30.0, 10.0, 5.0])
    published = 1 / (np.sin(np.radians(elevation)) + 0.50572 * (elevation + 6.07995) ** -1.6364)
    columns = columns_to_space(medium(Atmosphere()), GROUND, np.sin(np.radians(elevation)))
    # Theirs holds refraction, which shortens the way by 1.5 % at 5°.
    np.testing.assert_allclose(columns[:, 0], published, rtol=0.02)


def test_the_earth_is_in_the_way():
    air = medium(Atmosphere())
    below = columns_to_space(air, GROUND + 1e4, np.cos(np.radians([93.0, 94.0])))
    # The horizon dips by arccos(R / (R + 10 km)) = 3.2°.
    assert np.isfinite(below[0]).all() and np.isinf(below[1]).all()


@pytest.mark.parametrize(
    "settings",
    [{"haze": -1}, {"ozone": 2000}, {"asymmetry": 1.0}, {"ground": 1.2}, {"ground": [0.1, 0.2]}],
)
def test_out_of_range_is_said(settings):
    with pytest.raises(InputError, match=next(iter(settings))):
        Atmosphere(**settings)
