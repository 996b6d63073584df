"""Skies of spectra in OpenEXR, as Fichet, Pacanowski and Wilkie lay them out."""

import numpy as np
import OpenEXR
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.clear_sky import SCALE, picture
from spectral_skylight.addon.sky.exr_file import decode_by_openexr
from spectral_skylight.addon.sky.exr_header import header_of
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import read_panorama, write_spectral
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.sky.spectral_layout import find_spectra
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.tests.sky.spectral_files import radiance, stokes, write_fichet
from spectral_skylight.tests.sky.test_known_spectrum import COARSE
from spectral_skylight.tests.sky.test_radiance_hsr import seen

NODES = np.arange(400.0, 701.0, 10.0)

ROUNDING = 1e-5
"""Of float32 sums of some thirty products."""


@pytest.fixture(scope="module")
def values():
    return radiance(NODES)


def near(sky, values, wavelengths=NODES, tolerance=ROUNDING):
    true = seen(values, wavelengths)
    assert np.abs(sky.rgb - np.maximum(true, 0.0)).max() < tolerance * true.max()
    assert analyse(sky).spectrum is not None
    return sky


@pytest.mark.parametrize("packing", ["NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24"])
def test_it_is_read_however_it_is_packed(tmp_path, values, packing):
    compression = getattr(OpenEXR, f"{packing}_COMPRESSION")
    file = write_fichet(tmp_path / "a.exr", stokes(values, NODES), compression=compression)
    # PXR24 keeps 24 bits of each number.
    near(read_panorama(file), values, tolerance=1e-4 if packing == "PXR24" else ROUNDING)


def test_half_floats_and_other_channels_beside(tmp_path, values):
    channels = stokes(values, NODES) | stokes(0.1 * values, NODES, "S1") | {"A": values[..., 0]}
    sky = near(
        read_panorama(write_fichet(tmp_path / "a.exr", channels, half=True)), values, tolerance=1e-3
    )
    assert any("polarisation" in note for note in sky.notes)
    preview = {letter: np.ones_like(values[..., 0]) for letter in "RGB"}
    mixed = stokes(values, NODES) | stokes(values, NODES, "T") | preview
    sky = near(read_panorama(write_fichet(tmp_path / "b.exr", mixed)), values)
    assert any("reflectances" in note for note in sky.notes)


@pytest.mark.parametrize(
    "called",
    [
        lambda nm: f"{nm:.0f}nm",
        lambda nm: f"{nm:.6f}nm",
        lambda nm: f"{nm / 1e3:.4f}um",
        lambda nm: f"{nm / 1e3:.4f}μm",
        lambda nm: f"{nm * 1e-9:.4e}m",
        lambda nm: f"{299792.458 / nm:.6f}THz",
        lambda nm: f"{299792458e9 / nm:.8e}Hz",
    ],
)
def test_wavelengths_in_any_unit(tmp_path, values, called):
    channels = {f"S0.{called(nm).replace('.', ',')}": values[..., k] for k, nm in enumerate(NODES)}
    near(read_panorama(write_fichet(tmp_path / "a.exr", channels)), values, tolerance=1e-4)


def test_layers_parts_and_samples_out_of_sight(tmp_path, values):
    wide = np.arange(300.0, 1001.0, 10.0)
    more = radiance(wide)
    sky = near(read_panorama(write_fichet(tmp_path / "a.exr", stokes(more, wide))), more, wide)
    layout = find_spectra(header_of(tmp_path / "a.exr"), "a.exr")
    assert layout.wavelengths == pytest.approx(np.arange(380.0, 781.0, 10.0))
    layered = {f"sky.{name}": plane for name, plane in stokes(values, NODES).items()}
    near(read_panorama(write_fichet(tmp_path / "b.exr", layered)), values)
    planes = {n: np.ascontiguousarray(p, np.float32) for n, p in stokes(values, NODES).items()}
    rgb = {letter: np.ones_like(planes["S0.400,0nm"]) for letter in "RGB"}
    parts = [
        OpenEXR.Part({"name": "preview", "type": OpenEXR.scanlineimage}, rgb),
        OpenEXR.Part({"name": "spectra", "type": OpenEXR.scanlineimage}, planes),
    ]
    OpenEXR.File(parts).write(str(tmp_path / "c.exr"))
    sky = near(read_panorama(tmp_path / "c.exr"), values)
    assert any("units of its light are not said" in note for note in sky.notes)
    assert "whiteLuminance" not in sky.metadata


def test_finer_ones_are_averaged(tmp_path):
    fine = np.arange(380.0, 781.0, 1.0)
    dense = radiance(fine, rows=8)
    sky = read_panorama(write_fichet(tmp_path / "a.exr", stokes(dense, fine)))
    # Straight between 5 nm nodes by construction, so means under hats differ by curvature alone.
    true = seen(dense[..., ::5], fine[::5])
    assert np.abs(sky.rgb - true).max() < 0.01 * true.max()


def test_our_own_spectral_file_is_our_own_sky(tmp_path):
    """What `sky --spectral` writes is what `sky --out` is, its sun included."""
    sky = simulate(40.0, quality=COARSE)
    write_spectral(tmp_path / "a.exr", picture(sky, 128, 160.0, True), WAVELENGTHS)
    found = read_panorama(tmp_path / "a.exr")
    rgb = picture(sky, 128, 160.0, True, observer() * SCALE)
    assert np.allclose(found.rgb, rgb, rtol=1e-3, atol=1e-5 * np.median(rgb))
    light = analyse(found)
    if light.sun is not None:
        own = light.spectrum.sun
        assert np.allclose(own, sky.direct * SCALE / np.pi, rtol=0.01)


def test_the_suns_spectrum_is_its_own(tmp_path):
    """Its disc is found by its brightness, and what shines around it is not its own."""
    lit, dark = (radiance(NODES, rows=128, sun=sun) for sun in (2e4, 0.0))
    light = analyse(read_panorama(write_fichet(tmp_path / "a.exr", stokes(lit, NODES))))
    assert light.sun is not None
    found = light.spectrum.sun / light.spectrum.sun.max()
    disc = np.interp(WAVELENGTHS, NODES, (lit - dark).max(axis=(0, 1)))
    assert np.allclose(found, disc / disc.max(), atol=2e-3)
    above = analyse(read_panorama(write_fichet(tmp_path / "b.exr", stokes(dark, NODES))))
    up = [[0.0, 0.0, 1.0]]
    one, other = (each.spectrum.irradiance(up)[0] for each in (light, above))
    assert np.allclose(one, other, rtol=5e-3)


def test_sensitivities_of_channels_are_undone(tmp_path, values):
    """Each channel the mean under a hat 30 nm wide at its foot, as a filter would."""
    fine = np.arange(400.0, 701.0)
    spectra = values @ np.array([np.interp(fine, NODES, one) for one in np.eye(NODES.size)])
    header, channels = {}, {}
    for nm in NODES:
        name = f"S0.{nm:.1f}nm".replace(".", ",").replace("S0,", "S0.")
        curve = {at: max(0.0, 1.0 - abs(at - nm) / 15.0) for at in np.arange(nm - 15, nm + 16, 5)}
        header[name] = ";".join(f"{at:g}nm:{value:.6f}" for at, value in curve.items())
        weight = np.maximum(0.0, 1.0 - np.abs(fine - nm) / 15.0)
        channels[name] = spectra @ weight / weight.sum()
    near(read_panorama(write_fichet(tmp_path / "a.exr", channels, header)), values, tolerance=2e-3)


def test_what_a_header_asks_for_is_told(tmp_path, values):
    header = {"EV": 1.5, "emissiveUnits": "nits", "cameraResponse": "400nm:1;700nm:1;"}
    sky = read_panorama(write_fichet(tmp_path / "a.exr", stokes(values, NODES), header))
    told = " ".join(sky.notes)
    assert "nits" in told and "cameraResponse" in told
    assert "1.5 EV" in told


def wrong(values):
    """Channels and a word of what is said of them."""
    holed = values.copy()
    holed[3, 5, 7] = np.nan
    return {
        "reflective": (stokes(values, NODES, "T"), "reflectances"),
        "bispectral": (
            {f"T.400,0nm.{nm:.1f}nm".replace(".0nm", ",0nm"): values[..., 0] for nm in NODES},
            "reflectances",
        ),
        "polarised": (stokes(values, NODES, "S1"), "polarisation .* alone"),
        "short": (stokes(values[..., 6:], NODES[6:]), "reach from 460 to 700 nm"),
        "single": ({"S0.550,0nm": values[..., 0]}, "reach from 550 to 550 nm"),
        "gap": (
            stokes(np.delete(values, range(9, 15), axis=2), np.delete(NODES, range(9, 15))),
            "nothing from 480 to 550 nm",
        ),
        "twice": (
            stokes(values, NODES) | {"S0.0,55um": values[..., 0]},
            "two channels of one wavelength: S0.0,55um, S0.550,0nm",
        ),
        "nan": (stokes(holed, NODES), "1 numbers of spectral channel 8 .* x = 5, y = 3"),
        "black": (stokes(0.0 * values, NODES), "completely black"),
        "square": (stokes(values[:, :32], NODES), "not 2:1"),
    }


@pytest.mark.parametrize("name", wrong(radiance(NODES, rows=8)))
def test_what_is_wrong_is_one_line(tmp_path, values, name):
    channels, told = wrong(values)[name]
    file = write_fichet(tmp_path / "sky.exr", channels)
    with pytest.raises(InputError, match=told) as error:
        read_panorama(file)
    assert str(file) in str(error.value) and "\n" not in str(error.value)


def test_a_damaged_one_is_one_line(tmp_path, values):
    file = write_fichet(tmp_path / "a.exr", stokes(values, NODES))
    data = file.read_bytes()
    for harmed in (data[: len(data) // 2], data[:-2000] + bytes(2000)):
        file.write_bytes(harmed)
        with pytest.raises(InputError) as error:
            read_panorama(file, decode=decode_by_openexr)
        assert "\n" not in str(error.value)
