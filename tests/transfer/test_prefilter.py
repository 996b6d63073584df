"""Three numbers a material, exact under the light that they were made for."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.direct_sun import direct_sunlight
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.working_spaces import WORKING_SPACES
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.transfer.prefilter import balanced_rgb, light_rgb, prefiltered

RHO = colorchecker()[1]
SODIUM = np.where(np.abs(WAVELENGTHS - 590.0) < 3.0, 1.0, 1e-6)


@pytest.mark.parametrize("space", WORKING_SPACES)
@pytest.mark.parametrize("light", [direct_sunlight(3.0), D65(), SODIUM], ids=["sun", "D65", "Na"])
def test_the_product_is_the_colour(light, space):
    true = RHO @ (observer(space) * light).T
    product = prefiltered(RHO, light, space) * light_rgb(light, space)
    np.testing.assert_allclose(product, true, rtol=1e-12, atol=1e-12 * true.max())
    np.testing.assert_allclose(prefiltered(RHO[0], light, space), prefiltered(RHO, light, space)[0])


def test_under_D65_it_is_the_base_colour():
    np.testing.assert_allclose(prefiltered(RHO, 9.0 * D65()), rgb_albedo(RHO), rtol=1e-12)


def test_channels_that_the_light_lacks_stay_small():
    """Sodium has -5 % of Rec.709's blue; some light has nothing of it at all."""
    assert np.abs(prefiltered(RHO, SODIUM)).max() < 1.0
    S = observer()
    hollow = SODIUM + WAVELENGTHS * 0.0
    hollow[10] = -(S[2] @ SODIUM - S[2, 10] * SODIUM[10]) / S[2, 10]
    assert abs(S[2] @ hollow) < 1e-9 < light_rgb(hollow)[2]
    assert light_rgb(hollow)[2] == pytest.approx(0.01 * light_rgb(hollow).max())
    assert np.abs(prefiltered(RHO, hollow)).max() < 5.0


def test_dark_is_black():
    assert not prefiltered(RHO, np.zeros(81)).any()
    assert not light_rgb(np.zeros(81)).any()


def test_the_scene_has_its_balance():
    """What is neutral before balancing is white after it, for the sun as for the sky."""
    sun = direct_sunlight(40.0)
    white = observer() @ sun
    np.testing.assert_allclose(balanced_rgb(sun, transfer(white=white)), 1.0, rtol=1e-12)
    np.testing.assert_allclose(balanced_rgb(sun, transfer()), white, rtol=1e-12)


def test_an_unknown_space_is_said():
    with pytest.raises(InputError, match="space"):
        prefiltered(RHO, D65(), "sRGB")
