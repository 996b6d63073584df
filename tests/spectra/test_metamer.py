"""The nearest spectrum of a wanted colour."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.metamer import spectrum_with_colour
from spectral_skylight.addon.spectra.sensitivities import camera, cmfs, observer
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight

part = st.floats(0.0, 1.0)


@given(part, part, part, st.floats(1e-6, 1e6))
def test_every_colour_of_rec709_is_met_by_light(r, g, b, size):
    rgb = size * np.maximum([r, g, b], 1e-3)
    spectrum = spectrum_with_colour(D65(), rgb, observer())
    assert (spectrum > 0).all()
    # The search ends at 1e-10 of channels of one size, which Rec.709's are to a factor of 2.
    np.testing.assert_allclose(observer() @ spectrum, rgb, atol=1e-9 * rgb.max())


def test_a_spectrum_of_that_colour_already_stays():
    sun = extraterrestrial_sunlight()
    for S in (observer(), camera("Nikon 5100")):
        np.testing.assert_allclose(
            spectrum_with_colour(sun, 3.0 * S @ sun, S), 3.0 * sun, rtol=1e-8
        )


def test_lines_stay_and_the_change_is_smooth():
    """The factor bends where the eye sees: none of the sun's lines are in it."""
    sun = extraterrestrial_sunlight()
    factor = spectrum_with_colour(sun, observer() @ sun * [1.1, 1.0, 0.8], observer()) / sun
    assert np.abs(np.diff(np.log(factor), 2)).max() < 2e-3
    assert np.abs(np.diff(np.log(sun), 2)).max() > 0.2


def test_smooth_reflectances_are_found_again():
    """Light on a ramp, as soil is: in the mean over what the eye sees to 3 %; at its ends to 14."""
    ramp = np.linspace(0.1, 0.3, 81)
    light = D65() * ramp
    found = spectrum_with_colour(D65(), observer() @ light, observer())
    seen = cmfs().sum(axis=0) * light
    assert np.average(np.abs(found / light - 1.0), weights=seen) < 0.03


@pytest.mark.parametrize(
    "rgb", [(0.0, 0.0, 0.0), (1.6, -0.2, -0.05), (-1.0, -1.0, -1.0), (np.nan, 1.0, 1.0)]
)
def test_no_light_has_these_colours(rgb):
    """Black, a red beyond the spectrum's own, less than nothing, no number."""
    assert spectrum_with_colour(D65(), rgb, observer()) is None
