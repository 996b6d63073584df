"""Color rendering: the CIE's own figures, and colour-science."""

import colour
import numpy as np
import pytest

from spectral_skylight.addon.spectra import illuminants
from spectral_skylight.addon.spectra.colour_rendering import rendering_index, rendering_indices
from spectral_skylight.addon.spectra.colour_temperature import planckian

PUBLISHED = dict(zip(range(1, 13), (76, 64, 57, 51, 72, 59, 90, 95, 90, 81, 83, 83), strict=True))
"""Ra of fluorescent lamps F1 to F12, CIE 015:2018, table 10."""


@pytest.mark.parametrize("number", PUBLISHED)
def test_fluorescent_lamps_have_the_published_index(number):
    # Whole numbers, and wavelengths from 380 nm; F8's 95.5 is between two of them.
    found = rendering_index(illuminants.named(f"FL{number}"))
    assert found == pytest.approx(PUBLISHED[number], abs=0.6)


@pytest.mark.parametrize("name", ["FL2", "FL11", "LED-B3", "HP1"])
def test_each_test_colour_is_colour_sciences(name):
    theirs = colour.colour_rendering_index(colour.SDS_ILLUMINANTS[name], additional_data=True)
    expected = [theirs.Q_as[k].Q_a for k in range(1, 9)]
    ours = rendering_indices(illuminants.named(name))[:8]
    # Their temperature and grid differ a little: most under lamps of few lines.
    np.testing.assert_allclose(ours, expected, atol={"FL11": 0.8, "HP1": 1.5}.get(name, 0.3))


def test_the_reference_renders_perfectly():
    light = planckian(3200.0)
    np.testing.assert_allclose(rendering_indices(light), 100.0, atol=0.01)
    np.testing.assert_allclose(rendering_indices(illuminants.D65(), illuminants.D65()), 100.0)
    np.testing.assert_allclose(rendering_indices(3.0 * light, light), 100.0)  # size is nothing
    green = np.zeros(81)
    green[30] = 1.0
    assert np.isnan(rendering_index(green))
