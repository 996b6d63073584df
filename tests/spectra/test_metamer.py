"""The nearest spectrum of a wanted colour."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.metamer import with_colour
from spectral_skylight.addon.spectra.sensitivities import camera, observer
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight

part = st.floats(0.0, 1.0)


@given(part, part, part, st.floats(1e-6, 1e6))
def test_every_colour_of_rec709_is_met_by_light(r, g, b, size):
    rgb = size * np.maximum([r, g, b], 1e-3)
    spectrum = with_colour(D65(), rgb, observer())
    assert (spectrum > 0).all()
    # The search ends at 1e-10 of channels of one size, which Rec.709's are to a factor of 2.
    np.testing.assert_allclose(observer() @ spectrum, rgb, atol=1e-9 * rgb.max())


def test_a_spectrum_of_that_colour_already_stays():
    sun = extraterrestrial_sunlight()
    for S in (observer(), camera("Nikon 5100")):
        np.testing.assert_allclose(with_colour(sun, 3.0 * S @ sun, S), 3.0 * sun, rtol=1e-8)


def test_lines_stay_and_the_change_is_smooth():
    """The factor is an exponential of the observer's curves: none of the sun's lines are in it."""
    sun = extraterrestrial_sunlight()
    factor = with_colour(sun, observer() @ sun * [1.1, 1.0, 0.8], observer()) / sun
    curves = np.vstack([observer(), np.ones(81)]).T
    left = np.linalg.lstsq(curves, np.log(factor), rcond=None)[1]
    np.testing.assert_allclose(left, 0.0, atol=1e-20)


@pytest.mark.parametrize(
    "rgb", [(0.0, 0.0, 0.0), (1.6, -0.2, -0.05), (-1.0, -1.0, -1.0), (np.nan, 1.0, 1.0)]
)
def test_no_light_has_these_colours(rgb):
    """Black, a red beyond the spectrum's own, less than nothing, no number."""
    assert with_colour(D65(), rgb, observer()) is None
