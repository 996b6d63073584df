import colour
import numpy as np
import pytest

from spectral_skylight.addon.spectra import illuminants
from spectral_skylight.addon.spectra.grid import WAVELENGTHS

THEIRS = {**colour.SDS_LIGHT_SOURCES, **colour.SDS_ILLUMINANTS}


@pytest.mark.parametrize("kelvin", [4000.0, 5003.0, 6504.0, 7000.0, 7001.0, 12_345.0, 25_000.0])
def test_daylight_is_colour_science_s(kelvin):
    xy = colour.temperature.CCT_to_xy_CIE_D(kelvin)
    sd = colour.sd_CIE_illuminant_D_series(xy, shape=colour.SpectralShape(380, 780, 5))
    np.testing.assert_allclose(illuminants.daylight(kelvin), sd.values, rtol=1e-12)


def test_daylight_keeps_to_its_temperatures():
    spectra = illuminants.daylight([[1000.0, 4000.0], [25_000.0, 1e9]])
    assert spectra.shape == (2, 2, WAVELENGTHS.size)
    np.testing.assert_array_equal(spectra[:, 0], spectra[:, 1])


@pytest.mark.parametrize("name", THEIRS)
def test_all_names_are_found_whatever_their_case_and_spaces(name):
    found = illuminants.named(f" {name.swapcase()}".replace(" ", "  "))
    theirs = THEIRS[name]
    assert np.isfinite(found).all() and (found >= 0).all()
    if theirs.shape.interval >= 2.5:  # finer ones are averaged
        # At the nodes that the table has itself there is nothing between samples to choose.
        nodes = np.isin(WAVELENGTHS, theirs.wavelengths)
        at = np.isin(theirs.wavelengths, WAVELENGTHS)
        expected = np.maximum(theirs.values[at], 0.0)
        np.testing.assert_allclose(found[nodes], expected, rtol=1e-12, atol=1e-15)


def test_other_names_are_none():
    assert illuminants.named("FL99") is illuminants.named("") is None
