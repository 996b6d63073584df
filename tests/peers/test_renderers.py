"""Renderers on one small scene: each errs by what its arithmetic of colour explains."""

import numpy as np
import pytest

from spectral_skylight.addon.evaluation.evaluation import evaluate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.tests.peers import renderers, scene
from spectral_skylight.tests.peers.peer import MISSING, PYTHON

pytestmark = [
    pytest.mark.peers,
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON.exists(), reason=MISSING),
]

CYAN = 17
"""The one patch outside Rec.709: its red is negative."""


@pytest.fixture(scope="module")
def found():
    """Errors (3, 24) and sums of all methods, by name."""
    return {method.name: renderers.errors(method) for method in renderers.METHODS}


@pytest.fixture(scope="module")
def computed():
    """Mean CIEDE2000 without any renderer, from the faces' spectra, by method."""
    _, rho = colorchecker()
    methods = evaluate(
        scene.irradiance(), rho, ("rayleigh", "atmosphere"), sun_elevation=scene.SUN_ELEVATION
    )
    return {one.method: one.delta_E.mean() for one in methods}


def test_a_spectral_renderer_finds_our_truth(found):
    """Mitsuba takes the sky as a spectrum and shares no code with us: only its noise is left."""
    _, result = found["Mitsuba 3, spectral"]
    # 9,000 samples a patch leave 0.2. A method without any error has that mean, or a little less.
    assert result.mean_delta_E < 0.1 + 1.3 * result.noise_delta_E
    assert result.noise_delta_E < 0.4
    # 0.004: noise, and our sky is cut into pixels of 0.7 degrees.
    assert result.luminance_error < 0.01


def test_radiance_errs_by_its_bands(found):
    """By what 20 box-shaped bands of light times reflectance leave: they cut across its steps."""
    true, white = scene.true_colours()
    _, rho = colorchecker()
    light = renderers.in_bands(scene.irradiance(), renderers.BANDS)
    reflected = light[:, None] * renderers.in_bands(rho, renderers.BANDS)
    S = renderers.in_bands_summed(observer() * scene.EXPOSURE)
    banded = delta_E(reflected @ S.T, true, white[:, None]).mean()
    _, result = found["Radiance, 20 bands"]
    # 0.48 for 0.46. The sky's 8 bits and 256 rays add at most what they make in other directions.
    assert result.mean_delta_E == pytest.approx(banded, abs=0.1)
    assert result.luminance_error < 0.01


def test_cycles_errs_by_multiplying_rgb(found, computed):
    _, result = found["Cycles, RGB × RGB"]
    # Noise is 0.04.
    assert result.mean_delta_E == pytest.approx(computed["RGB × RGB in Rec.709"], abs=0.1)


@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("ours in Cycles, rayleigh", "rayleigh"),
        ("ours in Cycles, atmosphere", "atmosphere, elevation known"),
    ],
)
def test_our_materials_err_by_their_basis(found, computed, name, method):
    errors, result = found[name]
    # The polynomial of the sky's light adds 0.3 % of luminance: CIEDE2000 0.05 on a grey.
    assert result.mean_delta_E == pytest.approx(computed[method], abs=0.1)
    assert result.noise_delta_E < 1e-3
    # A fifth at most of what RGB × RGB leaves: as for whole skies of this kind.
    assert result.mean_delta_E < 0.2 * found["Cycles, RGB × RGB"][1].mean_delta_E
    assert errors.max() < 1.0


def test_eevee_shows_what_cycles_shows(found):
    """But for the one colour whose negative red Eevee sets to zero."""
    cycles, eevee = (found[f"ours in {engine}, rayleigh"][0] for engine in ("Cycles", "Eevee"))
    rest = np.arange(24) != CYAN
    # Eevee stores a picture in half floats, 0.05 %.
    np.testing.assert_allclose(eevee[:, rest], cycles[:, rest], atol=0.1)
    assert np.all(eevee[:, CYAN] > 2 * cycles[:, CYAN])


def test_spectra_from_rgb_are_between(found):
    """Mitsuba's upsampling of the sky's RGB loses less than RGB × RGB; skylight's own basis, less.

    0.31 of which 0.2 is noise, against 1.48 and our 0.21.
    """
    upsampled = found["Mitsuba 3, RGB sky"][1].mean_delta_E
    assert upsampled < 0.4 * found["Cycles, RGB × RGB"][1].mean_delta_E
    assert upsampled > found["ours in Cycles, atmosphere"][1].mean_delta_E
