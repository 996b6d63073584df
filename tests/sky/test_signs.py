"""Numbers that are not light: tone-mapped skies and those in other primaries are said to be so."""

import numpy as np
import pytest

from spectral_skylight.addon.sky.hdri_checks import flat_white, signs
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import from_pixels, read_panorama, write_panorama
from spectral_skylight.addon.spectra.working_spaces import primaries_to_rec709, rec709_to_working

REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
SRGB_IN_D50 = (0.6485, 0.3309, 0.3212, 0.5979, 0.1559, 0.0661, 0.3457, 0.3585)
ACESCG = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)


def tone_mapped(rgb, exposure):
    """What an 8-bit file holds: clipped at white, sRGB's curve, 255 steps."""
    linear = np.clip(rgb * (exposure / np.median(rgb)), 0.0, 1.0)
    curve = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(curve * 255.0) / np.float32(255.0)


def sky(height=64):
    """Blue, and white around one place, unclipped."""
    place = np.linspace(0.0, 1.0, height)[:, None, None] * np.ones((1, 2 * height, 1))
    return (np.array([0.2, 0.35, 0.7]) + 4.0 * np.exp(-40.0 * (place - 0.3) ** 2)).astype("f4")


def test_tone_mapped_is_seen():
    assert flat_white(sky()) == 0.0
    found = flat_white(tone_mapped(sky(), 0.5))
    assert found > 0.1
    assert any("tone-mapped" in note for note in signs(from_pixels(tone_mapped(sky(), 0.5), "x")))
    # Brought back to linear it is still clipped.
    assert flat_white(np.minimum(sky(), 1.0)) > 0.1


@pytest.mark.parametrize("value", [1.0, [0.9, 1.0, 1.0]])
def test_even_and_grey_skies_are_not_flat(value):
    assert flat_white(np.full((16, 32, 3), value, np.float32)) == 0.0
    grey = np.clip(sky().mean(axis=2, keepdims=True).repeat(3, axis=2), 0.0, 1.0)
    assert flat_white(grey) == 0.0  # an overcast sky is brightest over much of itself


def test_real_skies_and_the_same_tone_mapped(shared_data):
    for path in sorted((shared_data / "hdri").glob("*/*.[eh][xd]r")):
        panorama = read_panorama(path)
        assert signs(panorama) == []
        if "mud_road" not in path.name:  # overcast: nothing in it is brighter than white
            assert signs(from_pixels(tone_mapped(panorama.rgb[::2, ::2], 0.25), "x"))


def test_primaries_of_a_header(tmp_path):
    for chromaticities, other in ((REC709, False), (SRGB_IN_D50, False), (ACESCG, True)):
        write_panorama(tmp_path / "sky.exr", sky(), {"chromaticities": chromaticities})
        panorama = read_panorama(tmp_path / "sky.exr")
        assert any("primaries" in note for note in signs(panorama)) is other
        to_rec709 = primaries_to_rec709(chromaticities) if other else np.eye(3)
        np.testing.assert_allclose(panorama.rgb, sky() @ to_rec709.T, rtol=1e-5)  # float32


def test_primaries_as_working_spaces():
    back = rec709_to_working("ACEScg") @ primaries_to_rec709(ACESCG)
    np.testing.assert_allclose(back, np.eye(3), atol=1e-12)  # rounding of float64


def test_all_that_is_wrong_is_noted(tmp_path):
    rgb = tone_mapped(sky(), 0.5)
    rgb[3, 4, 1] = -1.0
    light = analyse(from_pixels(rgb, "sky"), 1)
    assert len(light.notes) == 3 and light.report()["notes"] == light.notes
    assert "tone-mapped" in light.notes[0] and light.notes[1].startswith("1 negative value")
    plain = analyse(from_pixels(sky(), "sky"), 1)
    assert plain.notes == [light.notes[2]] and plain.notes[0].startswith("no sun found")
