"""The map of an HDRI: each kind of pixel is found, counted by its light, and shown."""

import json

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.light import FACES, analyse
from spectral_skylight.addon.sky.panorama import from_pixels, read_panorama
from spectral_skylight.addon.sky.sky_classification import (
    FOREIGN,
    GROUND,
    KINDS,
    SKY,
    SUN,
    classify,
    outside,
)
from spectral_skylight.addon.spectra.bases import rayleigh
from spectral_skylight.addon.spectra.sensitivities import camera, observer
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE
from spectral_skylight.tests.pictures.reading import read_png

HEIGHT = 64
BLUE = observer() @ rayleigh()[1]  # sunlight scattered once
WHITE = observer() @ rayleigh()[0]
LEAF = np.array([0.3, 1.0, 0.1])


def sky(upper=BLUE, lower=WHITE):
    """Two even halves of the same luminance."""
    rgb = np.empty((HEIGHT, 2 * HEIGHT, 3))
    rgb[: HEIGHT // 2], rgb[HEIGHT // 2 :] = (
        upper / (upper @ LUMINANCE),
        lower / (lower @ LUMINANCE),
    )
    return rgb


def test_what_is_what():
    labels = classify(sky())
    assert (labels[: HEIGHT // 2] == SKY).all() and (labels[HEIGHT // 2 :] == GROUND).all()
    labels = classify(sky(upper=LEAF, lower=LEAF))
    assert (labels == FOREIGN).all()


def test_shares_are_the_faces_own():
    """Even halves: an upright face gets half its light from each, one that looks up all of one."""
    found = outside(sky(BLUE, LEAF), None, FACES)
    shares = found.shares
    # Integrals over rows are exact but for the clip at mid-height (see `irradiance`).
    np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(shares[0], [1, 0, 0, 0], atol=1e-3)
    tilted = (1 - np.cos(np.pi / 4)) / 2  # what a face at 45° sees of the ground
    np.testing.assert_allclose(shares[1:5, FOREIGN], tilted, atol=1e-3)
    np.testing.assert_allclose(shares[5:, FOREIGN], 0.5, atol=1e-3)
    # The mean is under a half: part, not most of it.
    assert "partly outside" in found.verdict and "at most 50 %" in found.verdict
    assert not found.mostly


def test_a_world_that_is_mostly_outside_is_said_to_be_so():
    found = outside(sky(LEAF, BLUE), None, FACES)
    assert found.mostly and found.verdict.startswith("mostly outside the model of skylight")
    plain = outside(sky(), None, FACES)
    assert plain.verdict == "its light has the colors of skylight" and not plain.mostly
    dark = outside(np.zeros((8, 16, 3)), None, FACES)
    assert dark.verdict == "the sky is dark" and not dark.shares.any()


def test_the_sun_is_a_kind_of_its_own():
    rgb = sky().repeat(4, axis=0).repeat(4, axis=1).astype(np.float32)  # the sun, not a lamp of 3°
    toward = np.array([0.6, 0.0, 0.8])
    row, column = np.unravel_index(np.argmax(directions(256, 512) @ toward), (256, 512))
    rgb[row, column] = 5000.0 * WHITE / WHITE.max()
    light = analyse(from_pixels(rgb, "sky"))
    labels = light.outside.labels
    assert labels[row, column] == SUN
    assert (labels == SUN).sum() <= 9  # a pixel, and those that its half diagonal touches
    assert light.outside.shares[0, SUN] == pytest.approx(light.sun.share, rel=1e-3)
    direct = light.sun.irradiance @ LUMINANCE  # beside the even sphere's own light of 1
    east, west = light.outside.shares[[6, 8], SUN]
    assert east == pytest.approx(0.6 * direct / (1.0 + 0.6 * direct), rel=0.01)  # pixels of 0.7°
    assert west == 0.0


def test_a_balanced_sky_is_all_foreign_until_its_white_is_told():
    """Unless the balance runs along the skies' own colours: then it is a sky of another hour."""
    white = np.array([0.8, 1.2, 0.8])
    balanced = sky() / white
    assert (classify(balanced)[: HEIGHT // 2] == FOREIGN).all()
    labels = classify(balanced, S_in=observer() / white[:, None])
    assert (labels[: HEIGHT // 2] == SKY).all()


def test_a_camera_s_numbers_are_known_by_its_sensitivities():
    S = camera("Nikon 5100") * [[0.5], [1.0], [0.5]]  # as raw numbers are: green before balancing
    raw = sky(S @ rayleigh()[1], S @ rayleigh()[0])
    assert (classify(raw)[: HEIGHT // 2] == FOREIGN).all()
    assert (classify(raw, S_in=S)[: HEIGHT // 2] == SKY).all()


def test_fine_skies_are_looked_at_in_blocks():
    """A checker of magenta and green, finer than the blocks, is white."""
    rgb = np.ones((512, 1024, 3), np.float32)
    odd = np.indices((512, 1024)).sum(axis=0) % 2 == 1
    rgb[odd], rgb[~odd] = [2.0, 0.0, 2.2], [0.0, 2.0, 0.0]
    assert classify(rgb).shape == (256, 512)
    assert not (classify(rgb) == FOREIGN).any()


# Foreign light that a person sees in the picture: grass and orange walls, leaves, tarpaulins.
FOREIGN_IN_REAL_SKIES = {
    "blender_studiolights/courtyard.exr": (0.12, 0.25),
    "blender_studiolights/forest.exr": (0.05, 0.15),
    "polyhaven/rooitou_park_1k.hdr": (0.06, 0.18),
    "polyhaven/mud_road_puresky_1k.hdr": (0.0, 0.002),
    "polyhaven/wasteland_clouds_puresky_1k.hdr": (0.0, 0.12),  # a greenish blue, at the limit
    "polyhaven/venice_sunset_1k.hdr": (0.01, 0.08),
}


@pytest.mark.parametrize("name", FOREIGN_IN_REAL_SKIES)
def test_real_skies(shared_data, name):
    found = analyse(read_panorama(shared_data / "hdri" / name)).outside
    low, high = FOREIGN_IN_REAL_SKIES[name]
    assert low <= found.shares[:, FOREIGN].mean() <= high
    # The upper eighth of each sky is sky, but for a roof, twigs and that blue.
    above = found.labels[: len(found.labels) // 8]
    if not name.endswith(("courtyard.exr", "forest.exr", "wasteland_clouds_puresky_1k.hdr")):
        assert np.mean(above == SKY) > 0.99


def test_the_command_writes_the_map_and_the_figures(tmp_path, capsys):
    from spectral_skylight.addon.sky.panorama import write_panorama

    write_panorama(tmp_path / "sky.exr", sky(LEAF, BLUE))
    out = ["--out", str(tmp_path / "e.exr"), "--map", str(tmp_path / "map.png")]
    assert cli.main(["irradiance", str(tmp_path / "sky.exr"), *out, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["outside"]
    assert found["kinds"] == list(KINDS) and np.shape(found["shares"]) == (9, 4)
    assert found["mostly"] and found["verdict"].startswith("mostly outside")
    assert read_png(tmp_path / "map.png").shape == (HEIGHT, 2 * HEIGHT, 3)
    assert cli.main(["irradiance", str(tmp_path / "sky.exr"), *out]) == 0
    assert "mostly outside the model" in capsys.readouterr().out
