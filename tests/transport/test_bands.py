"""Sixteen bands beside all wavelengths, for paints in light that other paints have reflected."""

import numpy as np
import pytest

from spectral_skylight.addon.spectra import bases
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transport.bands import COUNT, Bands


@pytest.mark.parametrize("bounces", [0, 1, 2])
def test_paints_in_light_off_paints(bounces):
    """CIEDE2000, all pairs and triples of the checker's paints: what the eye does not see."""
    S = observer()
    _, paints = colorchecker()
    sky = bases.basis("rayleigh", S).sum(axis=0)
    sun = extraterrestrial_sunlight()
    bands = Bands(sky + sun)
    for light in (sky, sun):
        e = bands.light(light)
        true, banded = np.broadcast_to(light, (1, 81)), np.broadcast_to(e, (1, COUNT))
        for _ in range(bounces):
            true = (true[:, None] * paints).reshape(-1, 81)
            banded = (banded[:, None] * bands.share(paints)).reshape(-1, COUNT)
        seen = np.einsum("cl,ml,kl->kmc", S, paints, true, optimize=True)
        told = np.einsum("mcb,kb->kmc", bands.colours(paints, S), banded, optimize=True)
        white = (true @ S.T)[:, None]
        error = delta_E(told, seen, white)
        assert error.mean() < (0.01, 0.05, 0.07)[bounces]
        assert error.max() < (0.02, 0.3, 0.6)[bounces]


def test_grey_keeps_its_share():
    bands = Bands(np.linspace(1.0, 3.0, 81))
    np.testing.assert_allclose(bands.share(np.full(81, 0.3)), 0.3)
    np.testing.assert_allclose(bands.light(bands.shape), 1.0)
    S = observer()
    np.testing.assert_allclose(
        bands.colours(np.ones(81), S) @ np.ones(COUNT), S @ bands.shape, rtol=1e-9
    )
