"""The library of reflectances in Blender: folders, list, swatches, assigning, dropping files."""

import pytest

bpy = pytest.importorskip("bpy")

from spectral_skylight.addon.spectra import formats  # noqa: E402
from spectral_skylight.addon.ui import choose_reflectance  # noqa: E402

pytestmark = pytest.mark.blender


def test_the_file_browser_shows_what_can_be_read():
    assert choose_reflectance.ENDINGS == formats.ENDINGS
