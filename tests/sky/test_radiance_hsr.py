"""Radiance's hyperspectral skies."""

import numpy as np
import pytest

from spectral_skylight.addon import cli
from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.sky.radiance_hsr import GENSSKY
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.tests.sky.spectral_files import SUN, radiance, write_hsr

BANDS = np.arange(390.0, 771.0, 20.0)

STEP = 1.5 / 256
"""Of one byte below the largest of a pixel, which may lie anywhere in the upper half."""


@pytest.fixture
def values():
    return radiance(BANDS)


def seen(values, wavelengths=BANDS):
    """Linear Rec.709 (h, w, 3) of radiance by straight lines, 1 for 10,000 cd/m²."""
    nodes = np.arange(380.0, 781.0, 5.0)
    onto = np.array([np.interp(nodes, wavelengths, one) for one in np.eye(len(wavelengths))])
    return values @ (onto @ observer().T) * 683.002 / 1e4


@pytest.mark.parametrize("splits", ["780 588 480 380", "380 480 588 780"])
@pytest.mark.parametrize("size", ["-Y {} +X {}", "-Y       {} +X      {}"])
def test_it_is_read_as_any_sky_is(tmp_path, values, splits, size):
    """In either order of the components; `genssky` writes the size with blanks before it."""
    sky = read_panorama(write_hsr(tmp_path / "sky.hsr", values, splits, size=size))
    true = seen(values)
    assert np.abs(sky.rgb - true).max() < 3.0 * STEP * true.max()
    assert sky.metadata["whiteLuminance"] == 1e4
    assert not sky.space  # Blender shows nothing of such a file
    light = analyse(sky)
    assert light.spectrum is not None
    face = light.spectrum.irradiance([[0.0, 0.0, 1.0]])[0]
    assert np.allclose(observer() @ face, light.faces[0], rtol=0.02)


def test_what_values_were_multiplied_by_is_divided_out(tmp_path, values):
    plain = read_panorama(write_hsr(tmp_path / "a.hsr", values))
    brighter = read_panorama(write_hsr(tmp_path / "b.hsr", 4.0 * values, exposure=4.0))
    assert np.allclose(plain.rgb, brighter.rgb, rtol=1e-5)


def test_the_sky_of_genssky_stands_where_the_sky_is(tmp_path):
    """Its samples lie on poles and seam, and its azimuths grow from left to right."""
    rows = 64
    azimuth = np.linspace(-np.pi, np.pi, 2 * rows)
    height = np.linspace(np.pi / 2, -np.pi / 2, rows)[:, None]
    level = np.cos(height)
    towards = np.stack(
        [level * np.cos(azimuth), level * np.sin(azimuth), np.sin(height) + 0 * azimuth], axis=-1
    )
    near = np.maximum(towards @ SUN, 0.0)[..., None] ** 30
    sky = read_panorama(write_hsr(tmp_path / "sky.hsr", 0.1 + near * np.ones(20)))
    assert GENSSKY in sky.notes
    row, column = np.unravel_index(np.argmax(sky.rgb[..., 1]), sky.rgb.shape[:2])
    found = 180.0 - (column + 0.5) / rows * 180.0
    assert abs(found - np.degrees(np.arctan2(SUN[1], SUN[0]))) < 3.0  # a pixel
    assert abs(90.0 - (row + 0.5) / rows * 180.0 - np.degrees(np.arcsin(SUN[2]))) < 3.0


def test_matrices_of_the_command_are_from_it(tmp_path, values, capsys):
    paint = tmp_path / "paint.csv"
    rows = [f"{nm},{0.1 + 0.5 * (nm > 580)}" for nm in range(400, 701, 20)]
    paint.write_text("\n".join(["nm,red", *rows]))
    file = write_hsr(tmp_path / "sky.hsr", values)
    assert cli.main(["matrix", str(paint), "--sky", str(file), "--json"]) == 0
    assert '"basis": "own spectrum"' in capsys.readouterr().out


def harmed(path, change):
    path.write_bytes(change(path.read_bytes()))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda data: data[:-5000], "ends early: scanline 29 of 32"),
        (lambda data: data.replace(b"NCOMP=20", b"NCOMP=2x"), "NCOMP=2x"),
        (lambda data: data.replace(b"NCOMP=20\n", b""), "does not say how many components"),
        (lambda data: data.replace(b"NCOMP=20", b"NCOMP=99999999"), "NCOMP=99999999"),
        (lambda data: data.replace(b"780 588 480 380", b"780 480 588 380"), "in order"),
        (lambda data: data.replace(b"780 588 480 380", b"780 588 480"), "in order"),
        (lambda data: data.replace(b"780 588 480 380", b"780 nan 480 380"), "in order"),
        (lambda data: data.replace(b"780 588 480 380", b"0.78 0.6 0.5 0.38"), "in order"),
        (lambda data: data.replace(b"780 588 480 380", b"640 588 480 380"), "reach from 386.5"),
        (lambda data: data.replace(b"-Y 32 +X 64", b"-Y 64 +X 32"), "not 2:1"),
        (lambda data: data.replace(b"-Y 32 +X 64", b"+X 64 -Y 32"), "rotated"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, values, change, told):
    file = write_hsr(tmp_path / "sky.hsr", values)
    harmed(file, change)
    with pytest.raises(InputError, match=told) as error:
        read_panorama(file)
    assert str(file) in str(error.value) and "\n" not in str(error.value)


def test_a_black_one_is_no_sky(tmp_path, values):
    with pytest.raises(InputError, match="completely black"):
        read_panorama(write_hsr(tmp_path / "sky.hsr", 0.0 * values))
