"""Skies that hold their own spectra: kept in a file, and matrices that are the best for them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spectral_skylight.addon.sky.clear_sky import SCALE, picture, spectrum_of
from spectral_skylight.addon.sky.direct_sun import restored_sun
from spectral_skylight.addon.sky.irradiance import spread
from spectral_skylight.addon.sky.known_spectrum import ATTRIBUTE, KnownSpectrum
from spectral_skylight.addon.sky.lat_long import directions, solid_angles
from spectral_skylight.addon.sky.light import FACES, analyse
from spectral_skylight.addon.sky.panorama import Panorama, read_panorama, write_panorama
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.ensemble import shipped
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.choice import choose
from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import OWN, transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import predict
from spectral_skylight.addon.transfer.white import estimate_white

COARSE = Quality(once=(24, 13), more=(10, 7), ways=32, shells=16)
"""Grainy, which no method minds: its grain is in the truth too."""

HEIGHT = 256
FINE = 72
"""Rows of the sky that the truth is taken from: nine times as many cells as are kept."""

MEASURED = Path(__file__).resolve().parents[3] / "shared" / "data" / "reflectance"

REACHED = 0.05
"""Mean CIEDE2000 that a full spectral integration may find under our own skies."""


def of_sky(elevation, disc=True):
    """A simulated sky, and its panorama as a file gives it back."""
    sky = simulate(elevation, quality=COARSE)
    rgb = picture(sky, HEIGHT, 130.0, disc, observer() * SCALE)
    return sky, Panorama(rgb, "sky", spectrum=spectrum_of(sky, 130.0, disc))


@pytest.fixture(scope="module", params=[-6.0, 2.0, 35.0])
def lit(request):
    sky, panorama = of_sky(request.param, request.param > 0.0)
    return sky, panorama, analyse(panorama)


@pytest.fixture(scope="module")
def reflectances():
    """The ColorChecker, and measured surfaces that are there."""
    rho = [colorchecker()[1]]
    for name in ("ptb_surfaces/sur_vrhel.csv", "slum_sample/slum_sample_15.csv"):
        file = MEASURED / name
        rho += [read_reflectances(file).values] if file.is_file() else []
    return np.vstack(rho)


def irradiances(sky, normals):
    """The spectra (n, 81) that faces have of a sky in fact, and what the sun adds to each."""
    radiance = picture(sky, FINE, 130.0) * SCALE
    weight = np.repeat(solid_angles(FINE, 2 * FINE), 2 * FINE)[:, None] / np.pi
    cosine = np.maximum(directions(FINE, 2 * FINE).reshape(-1, 3) @ normals.T, 0.0)
    light = (cosine * weight).T @ radiance.reshape(-1, 81)
    height, azimuth = np.radians([sky.sun_elevation, 90.0 - 130.0])
    towards = [np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)]
    sun = np.maximum(normals @ towards, 0.0)[:, None] * sky.direct * SCALE / np.pi
    return light, sun * (sky.sun_elevation > 0.0)


def error(mapping, rho, light, exact=0.0):
    """CIEDE2000 of matrices under light (n, 81), beside other light that is exact."""
    S = observer()
    true = np.einsum("il,ml,kl->kmi", S, rho, light + exact, optimize=True)
    shown = np.einsum("mij,kj->kmi", mapping.matrices(rho), light @ S.T)
    shown = shown + np.einsum("il,ml,kl->kmi", S, rho, exact + 0.0 * light, optimize=True)
    return delta_E(shown, true, ((light + exact) @ S.T)[:, None])


def test_the_whole_integration_finds_next_to_nothing_left(lit, reflectances):
    """Faces all around, in the sun and out of it, whoever carries the sun's light."""
    sky, _, light = lit
    mapping = transfer("atmosphere", known=light.spectrum.members)
    normals = spread(97, 1.0)  # none that the matrices were fitted to
    shade, sun = irradiances(sky, normals)
    assert mapping.basis == OWN
    assert error(mapping, reflectances, shade).mean() <= REACHED
    assert error(mapping, reflectances, shade + sun).mean() <= REACHED
    assert error(mapping, reflectances, shade, sun).mean() <= REACHED
    guessed = transfer("atmosphere", sun_elevation=sky.sun_elevation, sky_rgb=light.faces)
    assert (
        error(guessed, reflectances, shade).mean()
        > 2.0 * error(mapping, reflectances, shade).mean()
    )


def test_it_is_the_best_matrix_of_every_reflectance():
    """Moving any entry of a matrix makes the sum of squares over the members larger."""
    _, panorama = of_sky(35.0)
    members = panorama.spectrum.members
    mapping = transfer("atmosphere", known=members)
    rng = np.random.default_rng(0)
    rho = rng.uniform(0.0, 1.0, 81)
    true, seen = members @ (mapping.S_out * rho).T, members @ mapping.S_in.T

    def left(M):
        return np.sum((seen @ M.T - true) ** 2)

    # The expected basis pulls a little: a hundred times less than these moves.
    M = mapping.matrices(rho)
    for _ in range(20):
        assert left(M + 1e-3 * rng.standard_normal((3, 3))) > left(M)
    assert np.allclose(mapping.to_working, np.eye(3), atol=1e-9)


def test_an_even_sky_is_told_the_rest_by_the_expected_basis():
    """One spectrum everywhere: exact under it, and sane under any other."""
    spectrum = shipped().spectra[5]
    cells = np.broadcast_to(spectrum, (24, 48, 81))
    mapping = transfer("atmosphere", known=KnownSpectrum(cells).members)
    rho = colorchecker()[1]
    assert error(mapping, rho, spectrum[None]).max() < 0.01
    assert mapping.largest < 1.1


def test_grain_does_not_make_matrices_large():
    """A sky of one spectrum whose numbers are off by a hundredth at random, whatever its lines."""
    rng = np.random.default_rng(0)
    for spectrum in (shipped().spectra[5], np.exp(-(((WAVELENGTHS - 545.0) / 8.0) ** 2)) + 1e-3):
        cells = spectrum * (1.0 + 0.01 * rng.standard_normal((24, 48, 81)))
        mapping = transfer("atmosphere", known=KnownSpectrum(cells).members)
        assert mapping.largest <= 2.0


def test_a_file_keeps_it(lit, tmp_path):
    _, panorama, light = lit
    text = panorama.spectrum.to_text()
    assert len(text) < 100_000
    write_panorama(tmp_path / "sky.exr", panorama.rgb, {ATTRIBUTE: text})
    again = read_panorama(tmp_path / "sky.exr")
    assert not again.notes
    one, other = (transfer("atmosphere", known=s.members) for s in (again.spectrum, light.spectrum))
    rho = colorchecker()[1]
    # Twelve components and 24 bits.
    assert np.allclose(one.matrices(rho), other.matrices(rho), atol=2e-4)
    assert np.allclose(
        again.spectrum.irradiance(FACES),
        panorama.spectrum.irradiance(FACES),
        rtol=2e-3,
        atol=1e-4 * panorama.spectrum.cells.max(),
    )


def test_a_damaged_one_is_not_used(tmp_path):
    _, panorama = of_sky(35.0)
    text = panorama.spectrum.to_text()
    other = "B" if text[4000] == "A" else "A"
    for harmed in (text[:-8], text[100:], "!" + text, "", "AxgMAHic"):
        assert KnownSpectrum.from_text(harmed) is None
    harmed = text[:4000] + other + text[4001:]
    write_panorama(tmp_path / "sky.exr", panorama.rgb, {ATTRIBUTE: harmed})
    again = read_panorama(tmp_path / "sky.exr")
    assert again.spectrum is None
    assert "damaged" in again.notes[0]


def test_numbers_that_were_changed_are_not_of_those_spectra(lit):
    """A tint, a turned sky, another sky; a brighter one alone is still the same."""
    _, panorama, _ = lit
    for rgb in (panorama.rgb * np.float32([1.0, 1.0, 0.9]), np.roll(panorama.rgb, 90, axis=1)):
        light = analyse(replace(panorama, rgb=rgb))
        assert light.spectrum is None
        assert any("no longer those of the spectra" in note for note in light.notes)
    brighter = analyse(replace(panorama, rgb=panorama.rgb * np.float32(3.0)))
    own = brighter.spectrum.irradiance(FACES) @ observer().T
    assert np.allclose(own, brighter.faces, rtol=0.03, atol=0.01 * own.max())


def test_the_sun_has_its_own_spectrum():
    sky, panorama = of_sky(35.0)
    light = analyse(panorama)
    sun = restored_sun(light.sun, light)
    assert np.allclose(sun.spectrum, sky.direct * SCALE / np.pi, rtol=2e-3)
    assert np.allclose(sun.rgb, light.sun.irradiance, rtol=0.05)  # the disc is 2 pixels wide
    assert "own spectrum" in sun.line
    # A clipped disc is not that of the known sun.
    clipped = analyse(replace(panorama, rgb=np.minimum(panorama.rgb, np.float32(60.0))))
    assert clipped.sun is None or clipped.spectrum is None or clipped.spectrum.sun is None


def test_errors_are_those_of_the_light_itself(lit):
    """What is predicted is what the full integration finds on the same faces."""
    sky, _, light = lit
    mapping = transfer("atmosphere", known=light.spectrum.members)
    rho = colorchecker()[1]
    known = KnownLight.of(light)
    found = predict(mapping, rho, known)
    shade, _ = irradiances(sky, FACES)
    assert found.known
    assert np.allclose(found.matrix, error(mapping, rho, shade).mean(axis=0), atol=0.01)
    assert (found.bound["3x3"] >= found.matrix).all()
    assert (choose(mapping, rho, known).prediction.rgb > 3.0 * found.matrix).sum() > 12
    assert not estimate_white(light, mapping).suspected


def test_a_basis_that_is_asked_for_is_taken(lit):
    members = lit[2].spectrum.members
    plain = transfer("rayleigh").restoration
    assert np.array_equal(transfer("rayleigh", known=members).restoration, plain)
    assert WAVELENGTHS.shape == members.shape[1:]


def test_a_disc_that_is_not_found_stays_in_the_sky():
    """As of a sun whose light is less than a hundredth of the sky's."""
    sky = simulate(35.0, quality=COARSE)
    sky = replace(sky, direct=5e-4 * sky.direct)
    rgb = picture(sky, HEIGHT, 130.0, True, observer() * SCALE)
    light = analyse(Panorama(rgb, "sky", spectrum=spectrum_of(sky, 130.0, True)))
    shade, sun = irradiances(sky, FACES)
    assert light.sun is None
    assert np.allclose(light.spectrum.irradiance(FACES), shade + sun, rtol=0.01)
