"""What is on the locus of skies, what is off it, and what no colour can tell."""

import numpy as np
import pytest
from colour.colorimetry import SDS_ILLUMINANTS, SDS_LIGHT_SOURCES

from spectral_skylight.addon.sky import daylight_ensemble
from spectral_skylight.addon.spectra import daylight_locus, sensitivities
from spectral_skylight.addon.spectra.daylight_locus import LIMIT, locus_distance
from spectral_skylight.addon.spectra.ensemble import shipped
from spectral_skylight.addon.spectra.grid import resample
from spectral_skylight.addon.spectra.light import read_light
from spectral_skylight.addon.spectra.sensitivities import cmfs, observer

S = observer()


def spectrum(name):
    source = SDS_ILLUMINANTS[name] if name in SDS_ILLUMINANTS else SDS_LIGHT_SOURCES[name]
    return resample(source.wavelengths, source.values)


@pytest.fixture(scope="module")
def unseen():
    """Light of atmospheres that are not in the ensemble: spectra, elevations, whether the sun."""
    rng = np.random.default_rng(77)
    lights, elevations, suns = [], [], []
    for elevation in (-5.5, -2.5, 1.3, 4.2, 9.0, 27.0, 62.0):
        for kind, light in daylight_ensemble.lights(
            elevation, daylight_ensemble.draw_atmosphere(rng), rng
        ):
            lights.append(light / (cmfs()[1] @ light))
            elevations.append(elevation)
            suns.append(kind == "sun")
    return np.array(lights), np.array(elevations), np.array(suns)


def test_the_direct_sun_is_the_ensemble_s():
    assert daylight_locus._DIRECT_SUN in daylight_ensemble.KINDS


@pytest.mark.parametrize("S", [S, sensitivities.camera("Nikon 5100")], ids=["observer", "camera"])
def test_members_are_on_it_whatever_their_size(S):
    members = shipped().spectra[::7]
    distance = locus_distance(members @ S.T, S, direct_sun=True)
    # A member has another near it, but for those that photons threw far: not one in a hundred.
    assert np.mean(distance < LIMIT) > 0.99
    sizes = np.geomspace(1e-6, 1e6, len(members))[:, None]
    # Rounding alone: float64 sums over a chromaticity of order 1.
    np.testing.assert_allclose(
        locus_distance(sizes * members @ S.T, S, direct_sun=True), distance, atol=1e-12
    )


@pytest.mark.parametrize("camera", [None, "Nikon 5100", "Sigma"])
def test_unseen_atmospheres_are_on_it(unseen, camera):
    """With and without their elevation, for any sensor: the limit is above nearly all of them."""
    lights, elevations, suns = unseen
    S = observer() if camera is None else sensitivities.camera(camera)
    free = locus_distance(lights[~suns] @ S.T, S)
    assert np.mean(free <= LIMIT) >= 0.98
    assert np.percentile(free, 95) < LIMIT / 2  # what reason the limit has
    told = np.concatenate(
        [
            locus_distance(lights[(elevations == e) & ~suns] @ S.T, S, e)
            for e in np.unique(elevations)
        ]
    )
    assert np.mean(told <= LIMIT) >= 0.95


def test_measured_daylight_is_on_it(shared_data):
    light = read_light(shared_data / "sky/stanford_dicarlo/daylightSpectra.csv").values
    assert locus_distance(light @ S.T).max() < LIMIT / 2
    for name in ("sun_hourly_june.spct_MODELLED", "gap_72_measured_1nm"):
        light = read_light(shared_data / f"sky/photobiology_sun/{name}.csv").values
        assert locus_distance(light @ S.T).max() < LIMIT / 2


@pytest.mark.parametrize("name", ["A", "LED-B1", "LED-RGB1", "HPS", "LPS", "Super HPS"])
def test_warm_lamps_are_off_it_by_day_and_in_the_twilight(name):
    for elevation in (-3.0, 10.0, 20.0, 60.0):
        assert locus_distance(S @ spectrum(name), sun_elevation=elevation) > 2 * LIMIT


def test_sodium_is_off_it_always_unless_the_sun_itself_may_be_red():
    for name in ("HPS", "LPS", "Super HPS"):
        assert locus_distance(S @ spectrum(name)) > 3 * LIMIT
    assert locus_distance(S @ spectrum("LPS"), direct_sun=True) < 2 * LIMIT


def test_leaves_and_grass_are_off_it():
    D65 = spectrum("D65")
    for colour in (daylight_ensemble._LEAVES, daylight_ensemble._GRASS):
        assert locus_distance(S @ (colour * D65)) > 3 * LIMIT


def test_what_no_colour_can_tell():
    """Lamps made to look like daylight, and soil like a lower sun: outside, and yet on it."""
    D65 = spectrum("D65")
    for light in (spectrum("LED-B5"), spectrum("FL7"), daylight_ensemble._SOIL * D65):
        assert locus_distance(S @ light) < LIMIT


def test_colours_without_a_place():
    distance = locus_distance(np.array([[[0.0, 0, 0], [-1, -1, -1], [0, 0, 1], [0.95, 1, 1.1]]]))
    assert distance.shape == (1, 4)
    assert distance[0, 0] == 0 and np.isinf(distance[0, 1])
    assert distance[0, 2] > 0.1 and distance[0, 3] < LIMIT
