"""u'v' against colour-science, and sRGB's curve against its inverse: each stands once."""

import re
from pathlib import Path

import colour
import numpy as np
import pytest

from spectral_skylight.addon.sky.irradiance import RGB_TO_XYZ
from spectral_skylight.addon.spectra.chromaticity import uv
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE, from_srgb, srgb

ADDON = Path(__file__).resolve().parents[2] / "addon"
XYZ = np.random.default_rng(0).uniform(0.01, 1.0, (5, 4, 3))


def test_uv_is_colour_sciences():
    expected = colour.Luv_to_uv(colour.XYZ_to_Luv(XYZ))
    assert uv(XYZ) == pytest.approx(expected, abs=1e-12)


def test_dark_colours_come_out_towards_nothing():
    least = 1e-3
    dark = 1e-6 * XYZ
    assert np.abs(uv(dark, least)).max() < 0.03
    assert uv(XYZ, least) == pytest.approx(uv(XYZ), abs=0.0)


def test_srgb_is_colour_sciences_and_undone():
    linear = np.linspace(0.0, 1.0, 1001)
    assert srgb(linear) == pytest.approx(colour.cctf_encoding(linear), abs=1e-12)
    # The published limits of the two straight parts, 0.0031308 and 0.04045, leave a gap of 1e-8.
    assert from_srgb(srgb(linear)) == pytest.approx(linear, abs=3e-8)


def test_luminance_is_rec709s():
    """ITU-R BT.709-6 rounds to four digits what its primaries and white say."""
    assert RGB_TO_XYZ[1] == pytest.approx(LUMINANCE, abs=5e-5)


@pytest.mark.parametrize("number", ("0.2126", "12.92", "0.0031308", "0.04045"))
def test_the_standards_numbers_stand_in_one_file(number):
    found = [
        path.name
        for path in ADDON.rglob("*.py")
        if re.search(rf"(?<![\d.]){re.escape(number)}", path.read_text(encoding="utf-8"))
    ]
    assert found == ["working_spaces.py"]
