"""PNG files hold the pixels that they were given, and nothing is left half-written."""

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.pictures.png_file import write_png
from spectral_skylight.tests.pictures.reading import read_png


def test_png_keeps_its_pixels(tmp_path):
    pixels = np.random.default_rng(3).integers(0, 256, (5, 7, 3), dtype=np.uint8)
    write_png(tmp_path / "a.png", pixels)
    np.testing.assert_array_equal(read_png(tmp_path / "a.png"), pixels)
    image = pytest.importorskip("matplotlib.image")
    read = image.imread(tmp_path / "a.png")
    np.testing.assert_array_equal(np.round(read[..., :3] * 255), pixels)


def test_what_cannot_be_written_leaves_nothing(tmp_path):
    pixels = np.zeros((2, 2, 3), np.uint8)
    with pytest.raises(InputError, match="choose another place"):
        write_png(tmp_path / "none" / "a.png", pixels)
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(InputError, match="choose another place"):
        write_png(tmp_path / "folder.png", pixels)
    assert [path.name for path in tmp_path.iterdir()] == ["folder.png"]
