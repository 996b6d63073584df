"""The balance of an HDRI: seen where it is, not seen where it is not, and worth undoing."""

from dataclasses import replace

import numpy as np
import pytest
from colour.colorimetry import SDS_ILLUMINANTS

from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.daylight_ensemble import draw_atmosphere
from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.light import FACES, SkyLight
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.sky.sun import separate_sun
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import resample
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.white import AUTO, estimate_white, settle_white

S = observer()
MAPPING = transfer()
ROUGH = Quality(once=(24, 13), more=(12, 9), ways=128, shells=30)


def light_of(rgb):
    """What `analyse` finds, but for the polynomial and the map, which are not asked here."""
    sky, sun = separate_sun(rgb)
    return SkyLight("sky", sky, None, sun, exact_irradiance(sky, FACES), None)


@pytest.fixture(scope="module")
def skies():
    """Unseen atmospheres: sun elevation, the picture's light, spectrum of the sky alone."""
    rng = np.random.default_rng(4711)
    result = []
    for elevation in (9.0, 14.0, 22.0, 35.0, 50.0, 70.0):
        sky = simulate(elevation, draw_atmosphere(rng), quality=ROUGH, cached=False)
        rgb = picture(sky, 256, 180.0, True, S)
        result.append((elevation, light_of(rgb), sky.irradiance()))
    return result


def balanced(light, white):
    """Balancing scales every pixel, so irradiances too."""
    sun = light.sun and replace(light.sun, irradiance=light.sun.irradiance / white)
    return estimate_white(replace(light, faces=light.faces / white, sun=sun), MAPPING)


def error(spectrum, white, undone):
    """True mean CIEDE2000 under the sky of a picture that is and stays balanced by ``white``."""
    rho, light = colorchecker()[1], S @ spectrum / white
    M = transfer(white=undone).matrices(rho)
    return delta_E(M @ light, (rho * spectrum) @ S.T / white, light).mean()


def whites(spectrum):
    A = SDS_ILLUMINANTS["A"]
    neutral = S @ spectrum
    return {
        "the sky made grey": neutral / neutral[1],
        "lamplight": (tungsten := S @ resample(A.wavelengths, A.values)) / tungsten[1],
        "a green tint": np.array([1.0, 1.3, 1.0]),
    }


def test_an_unbalanced_sky_raises_no_alarm(skies):
    for _, light, _ in skies:
        found = balanced(light, np.ones(3))
        assert not found.suspected and found.line == ""


def test_a_balance_is_seen_and_undoing_it_pays(skies):
    """Left alone it costs about one ΔE or more; the estimate gives back nearly all of it."""
    for kind, known in (("the sky made grey", 0.5), ("lamplight", 1.0), ("a green tint", 1.0)):
        seen, left, undone, told = [], [], [], []
        for _, light, spectrum in skies:
            white = whites(spectrum)[kind]
            found = balanced(light, white)
            seen.append(found.suspected)
            left.append(error(spectrum, white, None))
            undone.append(error(spectrum, white, found.white))
            told.append(error(spectrum, white, white))
        assert np.mean(seen) >= known, kind
        assert np.mean(left) > 0.9, kind
        gained = (np.mean(left) - np.mean(undone)) / (np.mean(left) - np.mean(told))
        assert gained > 0.7, kind


def test_the_error_that_it_adds_is_as_large_as_it_says(skies):
    """Two directions of chance: 95 in 100 lie within 2.45 standard deviations."""
    within = []
    for _, light, spectrum in skies:
        white = whites(spectrum)["the sky made grey"]
        found = balanced(light, white)
        rho, rgb = colorchecker()[1], S @ spectrum / white
        ours, right = (transfer(white=w).matrices(rho) @ rgb for w in (found.white, white))
        within.append(delta_E(ours, right, rgb).mean() <= 2.45 * found.added_delta_E)
        assert found.added_delta_E < 0.6
    assert np.mean(within) >= 0.8  # of six


def test_what_is_said_can_be_typed(skies):
    _, light, spectrum = skies[3]
    found = balanced(light, whites(spectrum)["lamplight"])
    r, g, b = found.white
    assert f"set its neutral light to {r:.2f},{g:.2f},{b:.2f} (or auto)" in found.line
    assert f"ΔE {found.ignored_delta_E:.1f}" in found.line and found.ignored_delta_E > 2
    assert "\n" not in found.line


def test_auto_undoes_what_is_suspected_and_nothing_else(skies):
    _, light, spectrum = skies[3]
    white = whites(spectrum)["lamplight"]
    sure, plain = balanced(light, white), balanced(light, np.ones(3))
    found, line = settle_white(AUTO, lambda: sure)
    np.testing.assert_allclose(found, sure.white, atol=1e-4)  # as many digits as are printed
    assert "estimated from the sky" in line
    assert settle_white(None, lambda: sure) == (None, sure.line)
    assert settle_white(None, lambda: plain) == (None, "")
    assert settle_white(AUTO, lambda: plain) == (
        None,
        "this sky does not appear white-balanced; no white balance is undone",
    )

    def never():
        raise AssertionError("a white that is given needs no estimate")

    assert settle_white([1, 2, 3], never) == ((1.0, 2.0, 3.0), "")


def test_a_camera_s_own_green_is_no_balance(skies):
    """Raw numbers are green; by the camera's sensitivities that is known."""
    _, light, spectrum = skies[3]
    camera = transfer(camera="Nikon 5100")
    shown = camera.S_in @ spectrum
    raw = replace(light, sun=None, faces=np.tile(shown, (len(FACES), 1)))
    assert not estimate_white(raw, camera, 35.0).suspected
    tinted = replace(raw, faces=raw.faces / [0.5, 1.0, 0.6])
    assert estimate_white(tinted, camera, 35.0).suspected


def test_another_working_space_sees_the_same(skies):
    from spectral_skylight.addon.spectra.working_spaces import rec709_to_working

    _, light, _ = skies[3]
    wide = transfer(space="Linear Rec.2020")
    there = estimate_white(light, wide, to_working=rec709_to_working("Linear Rec.2020"))
    assert not there.suspected


def test_a_grey_sky_tells_a_tint_and_nothing_else():
    """Without a sun, blue and grey may be cloud; green may not."""
    grey = light_of(np.ones((32, 64, 3), np.float32))
    assert not balanced(grey, [1.0, 1.0, 1.0]).suspected
    assert not balanced(grey, [0.85, 1.0, 1.3]).suspected
    assert balanced(grey, [1.0, 1.6, 1.0]).suspected


def test_nothing_to_tell_by():
    violet = np.zeros((32, 64, 3), np.float32)
    violet[..., 2] = 1.0
    found = balanced(light_of(violet), np.ones(3))
    assert not found.suspected and np.array_equal(found.white, np.ones(3))


def test_real_skies(shared_data):
    """Nobody says how these were balanced. One fires: its sun at 10° is as white as at 40°."""
    alarms = []
    for path in sorted((shared_data / "hdri").glob("*/*.[eh][xd]r")):
        found = estimate_white(light_of(read_panorama(path).rgb), MAPPING)
        if found.suspected:
            alarms.append(path.name)
    assert set(alarms) <= {"rooitou_park_1k.hdr"}


def test_it_does_not_mind_what_white_was_told_before(skies):
    _, light, _ = skies[2]
    one = estimate_white(light, MAPPING)
    other = estimate_white(light, transfer(white=[0.5, 1.0, 2.0]))
    np.testing.assert_array_equal(one.white, other.white)
    assert one.added_delta_E == other.added_delta_E
