"""The node groups show the polynomial times the matrix: in Eevee, in Cycles, for real skies."""

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.materials import spectral_material
from spectral_skylight.addon.scene.world import light_group
from spectral_skylight.addon.sky.irradiance import (
    exact_irradiance,
    fit_coefficients,
)
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.sky.polynomial import evaluate_polynomial
from spectral_skylight.addon.sky.sun import separate_sun
from spectral_skylight.tests import faces

pytestmark = [pytest.mark.blender, pytest.mark.slow]

NORMALS = faces.directions(1000, seed=4)
# Rows with negative entries and every entry different: no transposed or mixed-up row passes.
MATRIX = np.array([[0.62, -0.05, 0.02], [0.07, 0.41, -0.03], [-0.01, 0.09, 0.28]])


@pytest.fixture(scope="module")
def lit(tmp_path_factory):
    """A scene of 1,000 faces under a managed material; each sky only changes its values."""
    folder = tmp_path_factory.mktemp("pixels")
    scene = faces.empty_scene()
    world = faces.light(scene, folder)
    material = bpy.data.materials.new("Matt")
    faces.add_faces(scene, NORMALS).material_slots[0].material = material
    spectral_material.apply(material, world, spectral_material.Surface(MATRIX, "test", "0"))
    return scene, world, folder


def assert_shows(pixels, expected):
    # Eevee keeps half floats, which round by up to 0.05 %; its own shading adds about 0.1 %.
    assert np.abs(pixels / expected - 1).max() < 0.002
    step = np.abs(faces.chromaticity(pixels) - faces.chromaticity(expected))
    assert np.linalg.norm(step, axis=1).max() < 0.0003


@pytest.mark.parametrize("degree", [0, 1, 2, 3, 4, 5, 6])
def test_every_degree_of_a_made_up_sky(lit, degree):
    scene, world, folder = lit
    coefficients = fit_coefficients(faces.smooth_sky(degree), degree).coefficients
    light_group.set_coefficients(world, coefficients)
    expected = evaluate_polynomial(coefficients, NORMALS) @ MATRIX.T
    assert_shows(faces.seen(scene, folder, len(NORMALS)), expected)


def test_each_coefficient_lies_where_its_name_says(lit):
    """49 random coefficients beside a constant that keeps the sum positive."""
    scene, world, folder = lit
    coefficients = np.random.default_rng(5).uniform(-0.1, 0.1, (49, 3))
    coefficients[0] = 3.0
    light_group.set_coefficients(world, coefficients)
    expected = evaluate_polynomial(coefficients, NORMALS) @ MATRIX.T
    assert_shows(faces.seen(scene, folder, len(NORMALS)), expected)


def test_cycles_shows_the_same(lit):
    scene, world, folder = lit
    coefficients = fit_coefficients(faces.smooth_sky(7), 6).coefficients
    light_group.set_coefficients(world, coefficients)
    expected = evaluate_polynomial(coefficients, NORMALS) @ MATRIX.T
    pixels = faces.seen(scene, folder, len(NORMALS), "cycles")
    # Nothing bounces between isolated faces, so there is no noise: float32 sums of 49 terms only.
    np.testing.assert_allclose(pixels, expected, rtol=2e-5)


def test_real_skies(lit, shared_data, capsys):
    """Measured skies: the polynomial to 0.2 %, exact irradiance to what the fit announced."""
    scene, world, folder = lit
    spectral_material.update(bpy.data.materials["Matt"], np.eye(3))
    table = []
    for path in sorted((shared_data / "hdri").rglob("*.[eh][xd]r")):
        sky, _ = separate_sun(read_panorama(path).rgb)
        fit = fit_coefficients(sky)
        light_group.set_coefficients(world, fit.coefficients)
        pixels = faces.seen(scene, folder, len(NORMALS))
        assert_shows(pixels, evaluate_polynomial(fit.coefficients, NORMALS))
        luminance = np.array([0.2126, 0.7152, 0.0722])
        exact = exact_irradiance(sky, NORMALS)
        left = np.abs(pixels @ luminance / (exact @ luminance) - 1)
        said = fit.errors[fit.degree]
        table.append((path.name, fit.degree, left.mean(), left.max(), said.mean, said.worst))
        # `said` was measured in other directions, so it may miss the peak of the error by a little.
        assert left.mean() < 1.1 * said.mean + 0.002
        assert left.max() < 1.1 * said.worst + 0.002
    spectral_material.update(bpy.data.materials["Matt"], MATRIX)
    with capsys.disabled():
        print("\nsky, degree, mean and worst luminance error rendered, and as the fit announced")
        for name, degree, *errors in table:
            print(f"{name:36s} {degree}", *(f"{100 * e:6.2f} %" for e in errors))
    assert len(table) == 11
    assert np.mean([row[2] for row in table]) < 0.005
