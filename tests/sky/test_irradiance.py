"""Irradiance is exact; polynomials leave what they are said to leave."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from spectral_skylight.addon.sky.irradiance import (
    RGB_TO_XYZ,
    exact_irradiance,
    fit_coefficients,
    irradiance_map,
)
from spectral_skylight.addon.sky.lat_long import directions, solid_angles
from spectral_skylight.addon.sky.panorama import read_panorama
from spectral_skylight.addon.sky.polynomial import (
    HIGHEST_DEGREE,
    evaluate_polynomial,
    exponents,
    monomials,
)
from spectral_skylight.addon.sky.sun import separate_sun

CLIP = (np.pi / 256) ** 2 / 4
"""4e-5. The row that the horizon of a face that looks up runs through counts wholly or not: half
a row wrong by half of that on average, on both sides: its height squared over 4."""


def random_normals(count, seed=0):
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


NORMALS = np.vstack([random_normals(200), np.eye(3), -np.eye(3)])


def grey(values):
    return np.repeat(np.asarray(values, float)[..., None], 3, axis=2)


@pytest.mark.parametrize("height", [1, 2, 7, 64, 300, 509, 1024])
def test_even_sky_and_hemispheres(height):
    """Every size: split, summed up, prime and even ones."""
    sky = np.ones((height, 2 * height, 3)) * [1.0, 2.0, 3.0]
    np.testing.assert_allclose(exact_irradiance(sky, NORMALS) / [1.0, 2.0, 3.0], 1.0, atol=CLIP)
    if height % 2 == 0:
        sky[height // 2 :] = 0.0  # the closed form of a lit upper hemisphere: (1 + n_z) / 2
        expected = (1.0 + NORMALS[:, 2]) / 2.0
        np.testing.assert_allclose(exact_irradiance(sky, NORMALS)[:, 0], expected, atol=CLIP)
        sky[:] = 0.0
        sky[:, : height // 2] = sky[:, 3 * height // 2 :] = 1.0  # the half with x < 0
        expected = (1.0 - NORMALS[:, 0]) / 2.0
        np.testing.assert_allclose(exact_irradiance(sky, NORMALS)[:, 0], expected, atol=CLIP)


def test_pixels_in_front_of_a_face_are_exact():
    """A pixel's integrals of cosine in closed form, away from the clip: rounding is all."""
    sky = np.zeros((512, 1024, 3))
    sky[100, 700] = 1.0
    top, bottom = (0.5 - np.array([100, 101]) / 512) * np.pi
    left, right = (0.5 - np.array([700, 701]) / 1024) * 2.0 * np.pi
    across = (top - bottom) / 2.0 + (np.sin(2 * top) - np.sin(2 * bottom)) / 4.0
    vector = [
        across * (np.sin(left) - np.sin(right)),
        across * (np.cos(right) - np.cos(left)),
        (np.sin(top) ** 2 - np.sin(bottom) ** 2) / 2.0 * (left - right),
    ]
    cosine = NORMALS @ vector / np.linalg.norm(vector)
    expected = NORMALS @ vector / np.pi
    front, behind = cosine > 0.02, cosine < -0.02  # further than the merged pixel is wide
    result = exact_irradiance(sky, NORMALS)[:, 1]
    np.testing.assert_allclose(result[front], expected[front], rtol=1e-9)
    np.testing.assert_allclose(result[behind], 0.0, atol=1e-9 * expected.max())


@pytest.mark.parametrize("power", [1, 2, 5])
def test_cosine_power_lobes(power):
    """A lobe max(z, 0)^p gives a face that looks up 2 / (p + 2), and one that looks down nothing.

    Level faces see (1 / pi) * integral of sin^p cos^2 over elevation * 2.
    """
    height = 1024
    z = directions(height, 2 * height)[..., 2]
    sky = grey(np.maximum(z, 0.0) ** power)
    up, down, level = exact_irradiance(sky, [[0, 0, 1], [0, 0, -1], [1, 0, 0]])[:, 0]
    t = np.linspace(0.0, np.pi / 2, 20001)
    expected = 2.0 / np.pi * np.mean(np.sin(t) ** power * np.cos(t) ** 2) * np.pi / 2
    # Samples at pixel centres, not means, are off by their height squared over 24 (4e-7) times
    # the curvature, at most p^2 of the value; the quadrature's ends by 1 / 20001 at p = 0 only.
    assert up == pytest.approx(2.0 / (power + 2.0), rel=CLIP)
    assert down == pytest.approx(0.0, abs=1e-12)
    assert level == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("degree", range(7))
def test_spherical_harmonics_keep_their_shape(degree):
    """Convolution scales a harmonic by A_l / pi (Ramamoorthi and Hanrahan 2001,
    DOI 10.1145/383259.383317): 1, 2/3, 1/4, 0, -1/24, 0, 1/64."""
    from scipy.special import lpmv

    factor = [1.0, 2 / 3, 1 / 4, 0.0, -1 / 24, 0.0, 1 / 64][degree]
    height = 512
    to = directions(height, 2 * height)
    order = degree // 2
    turn = np.array([0.36, 0.48, 0.8])  # an axis of no symmetry

    def harmonic(n):
        zonal = lpmv(0, degree, n @ turn)
        return zonal + lpmv(order, degree, n[..., 2]) * np.cos(
            order * np.arctan2(n[..., 1], n[..., 0])
        )

    result = exact_irradiance(grey(harmonic(to)), NORMALS)[:, 0]
    scale = np.abs(harmonic(NORMALS)).max()
    # Centre samples for means: (l + 1)^2 times a pixel's height squared over 24; and the clip.
    tolerance = (degree + 1) ** 2 * (np.pi / height) ** 2 / 24 + 3 * CLIP
    np.testing.assert_allclose(result, factor * harmonic(NORMALS), atol=tolerance * scale)


def test_against_brute_force():
    """Rough skies of 16 x 32 pixels, each pixel cut into 64 x 64 and summed up one by one."""
    rng = np.random.default_rng(3)
    sky = rng.random((16, 32, 3)) ** 8
    fine = sky.repeat(64, axis=0).repeat(64, axis=1).reshape(-1, 3)
    to = directions(1024, 2048).reshape(-1, 3)
    solid = np.repeat(solid_angles(1024, 2048), 2048)
    normals = NORMALS[:12]
    expected = [(np.maximum(to @ n, 0.0) * solid) @ fine / np.pi for n in normals]
    # Both clip a row at its middle; ours are 4 times as tall.
    np.testing.assert_allclose(exact_irradiance(sky, normals), expected, rtol=5e-5)


def test_summing_up_fine_pixels_loses_nothing_but_the_clip():
    """A 2k sky of noise and lone bright pixels against its exact sum, pixel by pixel."""
    rng = np.random.default_rng(4)
    sky = (rng.random((1024, 2048, 3)) ** 20).astype(np.float32)
    to = directions(1024, 2048).reshape(-1, 3)
    solid = np.repeat(solid_angles(1024, 2048), 2048)
    normals = NORMALS[:8]
    expected = [(np.maximum(to @ n, 0.0) * solid) @ sky.reshape(-1, 3) / np.pi for n in normals]
    np.testing.assert_allclose(exact_irradiance(sky, normals), expected, rtol=5e-5)


small_skies = arrays(np.float64, (8, 16, 3), elements=st.floats(0.0, 1e4))


@given(small_skies, small_skies, st.floats(0.0, 10.0))
@settings(max_examples=20)
def test_linear_in_the_sky(one, other, factor):
    normals = NORMALS[:20]
    together = exact_irradiance(one + factor * other, normals)
    apart = exact_irradiance(one, normals) + factor * exact_irradiance(other, normals)
    # Differences of running sums: rounding of the largest sum, 1e-16 times some hundred terms.
    np.testing.assert_allclose(together, apart, atol=1e-12 * (one.max() + factor * other.max()))


@given(small_skies, st.integers(0, 15))
@settings(max_examples=20)
def test_turns_with_the_sky(sky, columns):
    """A sky moved right by some columns looks clockwise from above; so must its faces."""
    angle = -columns * 2.0 * np.pi / 16
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    turned = exact_irradiance(np.roll(sky, columns, axis=1), NORMALS[:20] @ turn.T)
    np.testing.assert_allclose(turned, exact_irradiance(sky, NORMALS[:20]), atol=1e-12 * sky.max())


@given(small_skies)
@settings(max_examples=20)
def test_opposite_faces_differ_by_the_vector_integral(sky):
    """What one of them sees the other does not, wherever the horizon is taken."""
    vector = (exact_irradiance(sky, np.eye(3)) - exact_irradiance(sky, -np.eye(3))).T
    n = NORMALS[:20]
    difference = exact_irradiance(sky, n) - exact_irradiance(sky, -n)
    # Odd harmonics over 1 cancel but for the clip, which is the same for both.
    np.testing.assert_allclose(difference, n @ vector.T, atol=1e-10 * sky.max())


def test_energy():
    """The mean of E / pi over all faces is the mean radiance, for A_0 = pi."""
    sky = np.random.default_rng(6).random((8, 16, 3)) ** 6
    values = irradiance_map(sky, 128).astype(float)
    mean = np.einsum("h,hwc->c", solid_angles(64, 128), values)
    expected = np.einsum("h,hwc->c", solid_angles(8, 16), sky)
    # The map's faces sample a smooth function: the midpoint rule's (pi / 64)^2 / 24 = 1e-4.
    np.testing.assert_allclose(mean, expected, rtol=1.5e-4)


def test_map_is_the_irradiance_of_its_pixels():
    sky = np.random.default_rng(5).random((8, 16, 3))
    values = irradiance_map(sky, 12)
    assert values.shape == (6, 12, 3)
    np.testing.assert_allclose(
        values.reshape(-1, 3), exact_irradiance(sky, directions(6, 12).reshape(-1, 3)), rtol=1e-6
    )
    with pytest.raises(ValueError, match="width 7"):
        irradiance_map(sky, 7)


def test_exponents_and_monomials():
    assert exponents(1) == [(0, 0, 0), (0, 1, 0), (1, 0, 0), (0, 0, 1)]
    highest = exponents(HIGHEST_DEGREE)
    assert len(set(highest)) == 49
    for degree in range(7):
        assert len(exponents(degree)) == (degree + 1) ** 2
        assert [e for e in highest if e[0] + e[1] + e[2] <= degree] == exponents(degree)
        x, y, z = NORMALS.T
        expected = np.stack([x**a * y**b * z**c for a, b, c in exponents(degree)], axis=1)
        np.testing.assert_allclose(monomials(NORMALS, degree), expected, rtol=1e-13)
        # As many as there are harmonics, and independent: they span them.
        assert np.linalg.matrix_rank(monomials(random_normals(200), degree)) == (degree + 1) ** 2
    with pytest.raises(ValueError, match="3 coefficients"):
        evaluate_polynomial(np.zeros((3, 3)), NORMALS)


@pytest.mark.parametrize("degree", range(7))
def test_a_sky_that_is_a_polynomial_is_fitted_exactly(degree):
    """Its irradiance is one too, of the same degree (by the harmonics' factors)."""
    rng = np.random.default_rng(degree)
    coefficients = rng.uniform(-1, 1, ((degree + 1) ** 2, 3)) / (degree + 1) ** 2
    coefficients[0] = 3.0
    to = directions(512, 1024)
    sky = evaluate_polynomial(coefficients, to.reshape(-1, 3)).reshape(to.shape)
    fit = fit_coefficients(sky, degree=degree)
    assert fit.degree == degree
    assert fit.coefficients.shape == ((degree + 1) ** 2, 3)
    np.testing.assert_allclose(
        evaluate_polynomial(fit.coefficients, NORMALS),
        exact_irradiance(sky, NORMALS),
        rtol=5 * CLIP,  # the clip's error is not a polynomial
    )
    assert fit.errors[degree].worst < 5 * CLIP
    if degree > 2 and degree % 2:  # A_3 = A_5 = 0: they leave no trace in irradiance
        assert fit.errors[degree - 1].worst < 5 * CLIP


def test_fit_is_least_squares_and_errors_are_what_they_say(shared_data):
    sky, _ = separate_sun(read_panorama(shared_data / "hdri/polyhaven/venice_sunset_1k.hdr").rgb)
    fit = fit_coefficients(sky)
    normals = random_normals(3000, seed=9)
    normals[:, 2] = np.abs(normals[:, 2])
    truth = exact_irradiance(sky, normals) @ RGB_TO_XYZ.T
    for error in fit.errors[::2]:
        coefficients = fit_coefficients(sky, error.degree).coefficients
        estimate = evaluate_polynomial(coefficients, normals) @ RGB_TO_XYZ.T
        relative = np.abs(estimate[:, 1] / truth[:, 1] - 1.0)
        # Two random sets of directions: means agree to a few per cent, extremes less well, and
        # most at the very edge of the hemisphere.
        assert relative.mean() == pytest.approx(error.mean, rel=0.1)
        assert relative.max() == pytest.approx(error.worst, rel=0.25)
        uv = [v[:, :2] * [4, 9] / (v @ [1, 15, 3])[:, None] for v in (estimate, truth)]
        assert np.linalg.norm(uv[0] - uv[1], axis=1).max() == pytest.approx(
            error.chromaticity, rel=0.25
        )
    assert fit.degree == min(e.degree for e in fit.errors if e.worst <= 0.01)
    assert fit_coefficients(sky, tolerance=0.1).degree < fit.degree
    assert fit_coefficients(sky, tolerance=1e-9).degree == 6
    with pytest.raises(ValueError, match="degree 7"):
        fit_coefficients(sky, 7)


def test_what_each_degree_leaves(shared_data, capsys):
    """Over the photographed skies, sun's disc out: the figures that the design expects."""
    table = {}
    for path in sorted((shared_data / "hdri").glob("*/*.[eh][xd]r")):
        sky, _ = separate_sun(read_panorama(path).rgb)
        fit = fit_coefficients(sky)
        table[path.stem] = fit.errors
        low = random_normals(500)
        low[:, 2] = -np.abs(low[:, 2])
        truth = exact_irradiance(sky, low) @ RGB_TO_XYZ[1]
        estimate = evaluate_polynomial(fit.coefficients, low) @ RGB_TO_XYZ[1]
        # Soffits stay sane: within a tenth, where the upper faces are right to a few per cent.
        assert np.abs(estimate / truth - 1.0).max() < 0.1
    assert len(table) == 11
    with capsys.disabled():
        print("\nluminance mean / worst [%], worst u'v', by degree, sun's disc out")
        for name, errors in table.items():
            cells = (f"{100 * e.mean:.2f}/{100 * e.worst:.2f}/{e.chromaticity:.4f}" for e in errors)
            print(f"{name:28}", *cells)
    mean = np.mean([[e.mean for e in errors] for errors in table.values()], axis=0)
    worst = np.max([[e.worst for e in errors] for errors in table.values()], axis=0)
    colour = np.max([[e.chromaticity for e in errors] for errors in table.values()], axis=0)
    assert mean[6] < 0.005
    # Degree 2: 3.8 % mean at most, 18 % worst; degree 4: 0.9 to 1 %, 3.7 to 4.2 %; degree 6: 2.5 %
    # (the aureole, which stays in the sky, costs more than the courtyard).
    assert worst[2] < 0.18
    assert worst[4] < 0.045
    assert worst[6] < 0.027
    assert colour[6] < 0.002
