"""Textures: colours that are met, and what their spectra are off by."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.illuminants import D65
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.working_spaces import WORKING_SPACES, rec709_to_working
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E, to_Lab
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.transfer.prefilter import light_rgb, prefiltered
from spectral_skylight.addon.transfer.textures import basis, carried
from spectral_skylight.tests.stability.lights import daylight, skylight

S = observer()
RHO = colorchecker()[1]
LIGHTS = np.stack([skylight(40.0), daylight(40.0), daylight(10.0)])
part = st.floats(0.0, 1.0)


def true(rho):
    return np.einsum("il,ml,kl->kmi", S, rho, LIGHTS)


def off(estimate, rho):
    """CIEDE2000 (lights, m)."""
    return delta_E(estimate, true(rho), (LIGHTS @ S.T)[:, None])


@pytest.mark.parametrize("space", WORKING_SPACES)
def test_white_is_white_and_colours_are_met(space):
    np.testing.assert_allclose(basis(space).sum(axis=0), 1.0, rtol=1e-12)
    np.testing.assert_allclose(rgb_albedo(basis(space), space), np.eye(3), atol=1e-12)
    rgb = np.array([0.5, 0.3, 0.1])
    there = rec709_to_working(space) @ rgb
    # White is the same to five digits.
    np.testing.assert_allclose(there @ basis(space), rgb @ basis(), rtol=1e-4)


@given(part, part, part)
def test_colours_of_rec709_are_reflectances(r, g, b):
    rho = np.array([r, g, b]) @ basis()
    # Bringing the functions to D65 and this grid moves them by 1e-4.
    assert rho.min() >= -1e-3 and rho.max() <= 1.0 + 1e-3


def test_it_is_colour_sciences():
    from colour.recovery import RGB_to_sd_Mallett2019

    for rgb in ([0.2, 0.5, 0.8], [1.0, 0.0, 0.0]):
        theirs = RGB_to_sd_Mallett2019(np.array(rgb)).values
        np.testing.assert_allclose(np.array(rgb) @ basis(), theirs, atol=1e-3)


def test_three_matrices_and_three_prefiltered_colours_are_the_mixtures():
    mapping, light = transfer(), LIGHTS[2]
    rgb = rgb_albedo(RHO)
    matrices = np.einsum("mj,jab->mab", rgb, mapping.matrices(basis()))
    np.testing.assert_allclose(matrices, mapping.matrices(rgb @ basis()), atol=1e-12)
    colour = rgb @ prefiltered(basis(), light) * light_rgb(light)
    np.testing.assert_allclose(colour, (rgb @ basis() * light) @ S.T, rtol=1e-9, atol=1e-9)
    # And under D65 it is the texture as everyone has it.
    np.testing.assert_allclose(prefiltered(basis(), D65()), np.eye(3), atol=1e-9)


def texture_errors(rho):
    """Mean CIEDE2000 of a texture's three matrices, of RGB × RGB and of measured matrices."""
    mapping, rgb = transfer(), LIGHTS @ S.T
    albedo = rgb_albedo(rho)
    texture = np.einsum("mij,kj->kmi", mapping.matrices(albedo @ basis()), rgb)
    ours = np.einsum("mij,kj->kmi", mapping.matrices(rho), rgb)
    return tuple(off(each, rho).mean() for each in (texture, albedo * rgb[:, None], ours))


def test_a_checker_as_a_texture():
    """Colours alone leave twice what measured reflectances leave, today's way twice that."""
    texture, today, ours = texture_errors(RHO)
    assert ours < 0.3 and texture < 0.5 and today > 0.7
    assert texture < 0.7 * today


@pytest.mark.parametrize(
    "file",
    [
        "slum_sample/slum_sample_15.csv",
        "ptb_surfaces/sur_vrhel.csv",
        "colour_science_checkers/PMC.csv",
    ],
)
def test_measured_materials_as_textures(shared_data, file):
    rho = read_reflectances(shared_data / "reflectance" / file).values
    texture, today, ours = texture_errors(rho)
    assert ours < texture < 0.8 * today


def test_a_carried_texture_is_the_measurement_at_its_mean():
    mean = np.array([0.3, 0.25, 0.2])
    for space in WORKING_SPACES:
        for rho in RHO:
            mixed = carried(rho, mean, space)
            np.testing.assert_allclose(mean @ mixed, rho, atol=1e-9)
            np.testing.assert_allclose(0.3 * mean @ mixed, 0.3 * rho, atol=1e-9)
            # Any pixel has the texture's own colour, as it is brought to the measured one.
            pixel = np.array([0.1, 0.4, 0.3])
            wanted = pixel * rgb_albedo(rho, space) / mean
            np.testing.assert_allclose(rgb_albedo(pixel @ mixed, space), wanted, atol=1e-9)


def test_a_channel_that_a_texture_lacks():
    mixed = carried(RHO[14], [0.4, 0.0, 0.0])
    assert np.isfinite(mixed).all() and np.abs(mixed).max() < 5.0
    assert np.isfinite(carried(np.zeros(81), [0.0, 0.0, 0.0])).all()


def test_neighbours_are_better_carried(shared_data):
    """A material of nearly the same colour, as a pixel of a texture that another was measured of.

    Of Vrhel's 170 things (wood, leaves, skin, paint) and 30 of artists' pigments all pairs within
    10 of each other in Lab.
    """
    for file, most in (
        ("ptb_surfaces/sur_vrhel.csv", 0.8),
        ("colour_science_checkers/PMC.csv", 0.2),
    ):
        rho = read_reflectances(shared_data / "reflectance" / file).values
        rgb = rgb_albedo(rho)
        Lab = to_Lab(rgb, np.ones(3))
        near = np.linalg.norm(Lab[:, None] - Lab, axis=-1) < 10.0
        one, other = np.nonzero(near & ~np.eye(len(rho), dtype=bool))
        guess = np.stack(
            [rgb[b] @ carried(rho[a], rgb[a]) for a, b in zip(one, other, strict=True)]
        )
        with_csv = off(true(guess), rho[other]).mean()
        without = off(true(rgb[other] @ basis()), rho[other]).mean()
        assert with_csv < most * without
