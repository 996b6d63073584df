"""Skies scattered once, and pictures of them: closed forms, plausible figures, finer steps."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky import atmosphere
from spectral_skylight.addon.sky import clear_sky as pictures
from spectral_skylight.addon.sky.atmosphere import Atmosphere, medium, rayleigh_optical_depth
from spectral_skylight.addon.sky.scattering import direction, scattered_once, sun_transmittance
from spectral_skylight.addon.spectra.bases import rayleigh
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight

CLEAN = Atmosphere(haze=0.0, ozone=0.0, water=0.0, oxygen=False, ground=0.0)
HEIGHT = 32


def clear_sky(elevation, height, **settings):
    """Scattered once, and not from the cache: the code under test is patched here."""
    return pictures.clear_sky(elevation, height, orders=1, cached=False, **settings)


def test_thin_air_scatters_in_proportion_to_its_depth(monkeypatch):
    """With little air the sky is sunlight times depth times phase over the zenith's cosine."""
    thin = rayleigh_optical_depth() * 1e-5
    monkeypatch.setattr(atmosphere, "rayleigh_optical_depth", lambda dispersion: thin)
    sky = clear_sky(60.0, HEIGHT, atmosphere=CLEAN)
    elevation = np.pi * (0.5 - 0.5 / HEIGHT)  # the row at the zenith
    # Column 3/4 looks south, where the sun is; the zenith angle between is 30 degrees less a bit.
    view = np.array([0.0, -np.cos(elevation), np.sin(elevation)])
    sun = np.array([0.0, -np.cos(np.radians(60)), np.sin(np.radians(60))])
    cosine = view @ sun
    phase = 3 / (16 * np.pi) * (1 + cosine**2)
    expected = extraterrestrial_sunlight() * thin * phase / np.sin(elevation)
    # The air above 100 km (3.7e-6 of it) and the earth's curve are what is neglected; the two
    # columns next to due south are half a pixel away from it.
    np.testing.assert_allclose(sky[0, 3 * HEIGHT // 2], expected, rtol=2e-3)


def test_air_alone_scattered_once_lies_near_the_papers_basis():
    """High sun, thin air: a zenith spectrum is a mixture of the basis but for the third power."""
    zenith = clear_sky(60.0, HEIGHT, atmosphere=CLEAN)[0, 0]
    B = rayleigh()
    mixture = np.linalg.lstsq(B.T, zenith, rcond=None)[0] @ B
    np.testing.assert_allclose(mixture, zenith, rtol=0.02)


@pytest.mark.parametrize("elevation", [60.0, 20.0, 2.0, -4.0])
def test_finer_shells_change_little(elevation):
    sun = direction(np.radians(elevation), 0.0)
    views = direction(*np.radians(np.meshgrid([1.0, 5.0, 20.0, 60.0], [0.0, 40.0, 90.0])))
    coarse, fine = (
        scattered_once(medium(Atmosphere(), shells), sun, views.reshape(-1, 3)).sum(axis=0)
        for shells in (atmosphere.SHELLS, 4 * atmosphere.SHELLS)
    )
    lit = fine > 1e-3 * fine.max(axis=0)
    # What `SHELLS` promises on average, and single directions near the shadow's edge.
    assert np.mean(np.abs(coarse / fine - 1)[lit]) < 3e-3
    assert np.max(np.abs(coarse / fine - 1)[lit]) < 0.03


def test_illuminance_is_plausible():
    """Single scattering falls short of measured clear skies, but not by orders of magnitude."""
    S = 683.0 * observer()[1]  # Rec.709 green is near luminance for white light
    sky = clear_sky(45.0, HEIGHT, sensitivities=S[None, :])[: HEIGHT // 2, :, 0]
    edges = np.sin(np.linspace(np.pi / 2, 0, HEIGHT // 2 + 1)) ** 2
    lux = sky.mean(axis=1) @ (edges[:-1] - edges[1:]) * np.pi
    assert 5_000 < lux < 15_000  # CIE clear sky, sun at 45 degrees: about 12 klx


def test_horizon_reddens_and_sky_darkens_as_the_sun_sets():
    high, low = (clear_sky(elevation, HEIGHT) for elevation in (45.0, 1.0))
    assert low[0, 0].sum() < high[0, 0].sum()
    red, blue = np.searchsorted(WAVELENGTHS, [650, 450])
    sunwards = HEIGHT // 2 - 1, 3 * HEIGHT // 2
    assert low[sunwards][red] / low[sunwards][blue] > 3 * high[sunwards][red] / high[sunwards][blue]


def test_twilight_is_lit_from_above():
    sky = clear_sky(-5.0, HEIGHT, sensitivities=observer()[1:2])
    assert np.isfinite(sky).all() and sky[0].mean() > 0


def test_sensitivities_are_a_projection():
    S = observer()
    np.testing.assert_allclose(
        clear_sky(30.0, 16, sensitivities=S), clear_sky(30.0, 16) @ S.T, rtol=1e-4, atol=1e-3
    )


def test_azimuth_turns_the_sky():
    south, west = (clear_sky(20.0, 16, sun_azimuth=a, sensitivities=observer()) for a in (180, 270))
    # West is a quarter turn to the right of south, seen from inside.
    np.testing.assert_allclose(np.roll(south, 8, axis=1), west, rtol=1e-5)


@pytest.mark.parametrize(("elevation", "height"), [(45.0, 16), (45.0, 128), (89.9, 32), (0.1, 32)])
def test_disc_holds_the_sunlight_exactly(elevation, height):
    bare = clear_sky(elevation, height).astype(float)
    disc = clear_sky(elevation, height, sun_disc=True).astype(float) - bare
    edges = np.sin(np.linspace(np.pi / 2, -np.pi / 2, height + 1))
    solid = (edges[:-1] - edges[1:]) * np.pi / height
    received = np.einsum("h,hwn->n", solid, disc)
    expected = sun_transmittance(elevation, Atmosphere()) * extraterrestrial_sunlight()
    np.testing.assert_allclose(received, expected, rtol=1e-4)


def test_ground_reflects_its_spectrum():
    spectrum = np.linspace(0.1, 0.6, 81)
    ground = clear_sky(45.0, 16, atmosphere=Atmosphere(ground=spectrum))[-1, 0]
    white = clear_sky(45.0, 16, atmosphere=Atmosphere(ground=1.0))[-1, 0]
    np.testing.assert_allclose(ground, spectrum * white, rtol=1e-5)


@pytest.mark.parametrize(("elevation", "height"), [(-7.0, 64), (91.0, 64), (45.0, 2), (45.0, 9999)])
def test_out_of_range_is_said(elevation, height):
    with pytest.raises(InputError):
        clear_sky(elevation, height)
