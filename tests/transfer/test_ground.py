"""Light from below: taken apart, modelled, and what the short cuts cost."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.clear_sky import SCALE, picture
from spectral_skylight.addon.sky.direct_sun import restored_sun
from spectral_skylight.addon.sky.irradiance import exact_irradiance, spread
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import Panorama, read_panorama
from spectral_skylight.addon.sky.polynomial import evaluate_polynomial
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.reflectance import read_reflectances
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.transfer.ground import ground_light, split
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import rgb_albedo
from spectral_skylight.addon.transfer.prefilter import prefiltered
from spectral_skylight.tests.stability.lights import LEAVES, daylight, skylight


def short_cuts(mapping, lights, first, second):
    """Return what ways to shade light that was reflected twice are off by, CIEDE2000 (k, a, b).

    Lights (k, 81) fall on materials ``first`` (a, 81) and from these on ``second`` (b, 81). Lab
    white is the perfect diffuser in the first light. By way: ``"matrix of the product"``
    M(rho1 rho2); ``"product of matrices"`` M(rho2) M(rho1); ``"as sky"``, M(rho2) times the true
    RGB of what the first reflects; ``"RGB × RGB"``, both albedos times the light's RGB.
    """
    lights, first, second = (np.atleast_2d(each) for each in (lights, first, second))
    S_out, rgb = mapping.S_out, lights @ mapping.S_in.T
    white = (lights @ S_out.T)[:, None, None]
    twice = np.einsum("al,bl->abl", first, second)
    between = np.einsum("il,al,kl->kai", mapping.S_in, first, lights, optimize=True)
    M_1, M_2 = mapping.matrices(first), mapping.matrices(second)
    albedo = rgb_albedo(first, mapping.space)[:, None] * rgb_albedo(second, mapping.space)
    ways = {
        "matrix of the product": np.einsum("abij,kj->kabi", mapping.matrices(twice), rgb),
        "product of matrices": np.einsum("bij,ajl,kl->kabi", M_2, M_1, rgb, optimize=True),
        "as sky": np.einsum("bij,kaj->kabi", M_2, between),
        "RGB × RGB": albedo * white,
    }
    true = np.einsum("il,abl,kl->kabi", S_out, twice, lights, optimize=True)
    return {name: delta_E(each, true, white, mapping.space) for name, each in ways.items()}


S = observer()
NAMES, RHO = colorchecker()
GRASS = np.interp(
    WAVELENGTHS,
    [380, 500, 550, 600, 670, 690, 740, 780],
    [0.03, 0.04, 0.09, 0.06, 0.04, 0.06, 0.4, 0.45],
)
QUALITY = Quality(once=(24, 13), more=(12, 9), ways=128, shells=30)
DOWN = np.array([[0.0, 0.0, -1.0]])


@pytest.fixture(scope="module")
def meadow():
    """A sky over grass with its sun at 40°: the HDRI's light, and the true spectrum from below."""
    sky = simulate(40.0, Atmosphere(ground=GRASS), quality=QUALITY, cached=False)
    rgb = picture(sky, 128, 180.0, True, S * SCALE)
    lit = sky.irradiance() + sky.direct * np.sin(np.radians(40.0))
    return analyse(Panorama(rgb.astype(np.float32), "meadow")), lit * GRASS * SCALE / np.pi


def colours(found, normals):
    """Of the ColorChecker in the light from below, (n, m, 3)."""
    light = evaluate_polynomial(found.coefficients, normals)
    return light[:, None] * prefiltered(RHO, found.spectrum)


@pytest.mark.parametrize("height", [4, 5])
def test_the_halves_are_the_whole(height):
    rgb = np.arange(height * 2 * height * 3, dtype=np.float32).reshape(height, 2 * height, 3)
    upper, lower = split(rgb)
    np.testing.assert_array_equal(upper + lower, rgb)
    assert not upper[-(height // 2) :].any() and not lower[: height // 2].any()
    if height % 2:
        np.testing.assert_array_equal(upper[2], lower[2])


def test_halves_light_what_the_whole_does(meadow):
    normals = spread(20)
    halves = [exact_irradiance(half, normals) for half in split(meadow[0].sky)]
    np.testing.assert_allclose(sum(halves), exact_irradiance(meadow[0].sky, normals), rtol=1e-4)


def test_a_modelled_ground_is_the_true_one(meadow):
    light, true = meadow
    found = ground_light("modelled", light, transfer(), restored_sun(light.sun, light), GRASS)
    normals = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.6, 0.0, 0.8]])
    # An even plane below fills (1 - z) / 2 of what a face sees, cosines counted.
    seen = np.array([1.0, 0.5, 0.1])[:, None, None] * (RHO @ (S * true).T)
    white = np.array([1.0, 0.5, 0.1])[:, None, None] * (S @ true)
    off = delta_E(colours(found, normals), seen, white / 0.06)
    # The sky's and the sun's spectra are restored from RGB; the ground is dark: white is the light
    # that it is lit by, some 16 times its own.
    assert off.mean() < 0.1 and off.max() < 0.4
    assert "reflects 7 %" in found.line


def test_the_hdris_ground_keeps_its_colour(meadow):
    light, true = meadow
    found = ground_light("hdri", light, transfer(), restored_sun(light.sun, light))
    lower = split(light.sky)[1]
    normals = spread(50, 0.7)
    shown = evaluate_polynomial(found.coefficients, normals)
    exact = exact_irradiance(lower, normals)
    # Degree 2 of half a sphere, evenly bright: 1/64 of it is in the fourth.
    np.testing.assert_allclose(shown, exact, atol=0.025 * exact.max())
    np.testing.assert_allclose(S @ found.spectrum, exact_irradiance(lower, DOWN)[0], rtol=1e-8)
    # Of grass its colour tells most: 0.4 where sky of that colour gives 1.4; who knows it, 0.1.
    white = S @ true / 0.06
    right = RHO @ (S * true).T
    ours = delta_E(prefiltered(RHO, found.spectrum) * (S @ true), right, white).mean()
    as_sky = delta_E(transfer().matrices(RHO) @ (S @ true), right, white).mean()
    assert ours < 0.4 * as_sky


def test_no_ground(meadow):
    light = meadow[0]
    found = ground_light("none", light, transfer())
    assert not found.spectrum.any() and not found.coefficients.any()
    black = ground_light("hdri", replace(light, sky=split(light.sky)[0]), transfer())
    assert black.choice == "none" and "black" in black.line
    with pytest.raises(InputError, match="choose hdri, modelled or none"):
        ground_light("sand", light, transfer())


def test_a_balanced_hdris_ground_is_balanced(meadow):
    """Balanced or not, the scene differs by its white alone."""
    light = meadow[0]
    white = np.array([1.2, 1.0, 0.8])
    sun = restored_sun(light.sun, light)
    balanced = replace(light, sky=light.sky / white.astype(np.float32))
    for choice in ("hdri", "modelled"):
        plain = ground_light(choice, light, transfer(), sun)
        other = ground_light(choice, balanced, transfer(white=white), sun)
        np.testing.assert_allclose(other.spectrum, plain.spectrum, rtol=1e-4)
        size = np.abs(plain.coefficients).max()
        np.testing.assert_allclose(other.coefficients * white, plain.coefficients, atol=1e-4 * size)


def test_a_photographed_ground(shared_data):
    """The polynomial's worst as a part of all light, on faces that look up or sideways."""
    for name, most in (("venice_sunset_1k.hdr", 0.02), ("immenstadter_horn_1k.hdr", 0.01)):
        light = analyse(read_panorama(shared_data / "hdri" / "polyhaven" / name), 0)
        found = ground_light("hdri", light, transfer())
        normals = spread(300, 0.5)
        normals = normals[normals[:, 2] > -0.5]
        exact = exact_irradiance(split(light.sky)[1], normals)
        off = np.abs(evaluate_polynomial(found.coefficients, normals) - exact).max(axis=1)
        assert (off / exact_irradiance(light.sky, normals).min(axis=1)).max() < most


LIGHTS = {
    "sky": skylight(40.0),
    "sun and sky": daylight(40.0),
    "low sun": daylight(10.0),
}
RED, WHITE = RHO[[NAMES.index("red")]], RHO[[18]]


@pytest.mark.parametrize(
    ("name", "first", "second", "ours", "others"),
    [
        ("red wall, white floor", RED, WHITE, 0.8, 1.5),
        ("red wall, red wall", RED, RED, 0.8, 2.9),
        ("lawn, white soffit", LEAVES[None], WHITE, 0.25, 0.5),
    ],
)
def test_what_short_cuts_cost(name, first, second, ours, others):
    """CIEDE2000 of light reflected twice: ours at most, each of both short cuts at least.

    The matrix of the product leaves what the sky's basis leaves; taking red light for a sky's, by
    its RGB or by two matrices in turn, is off two to ten times as much.
    """
    for light in LIGHTS.values():
        found = short_cuts(transfer(), light, first, second)
        assert found["matrix of the product"].max() < ours
        assert found["product of matrices"].min() > others
        assert found["as sky"].min() > others


def test_what_short_cuts_cost_over_a_checker():
    found = short_cuts(transfer(), np.stack(list(LIGHTS.values())), RHO, RHO)
    mean = {name: each.mean() for name, each in found.items()}
    assert mean["matrix of the product"] < 0.25
    assert 1.0 < mean["product of matrices"] < 2.0 and 1.0 < mean["as sky"] < 2.0
    assert 2.0 < mean["RGB × RGB"] < 3.0
    assert found["RGB × RGB"].shape == (3, 24, 24)
    np.testing.assert_allclose(
        found["matrix of the product"], found["matrix of the product"].swapaxes(1, 2), atol=1e-9
    )


def test_what_short_cuts_cost_in_london(shared_data):
    """Stones, bricks and roofs are so dull that the short cuts are no worse than the basis."""
    path = shared_data / "reflectance" / "slum_sample" / "slum_sample_15.csv"
    rho = read_reflectances(path).values
    found = short_cuts(transfer(), np.stack(list(LIGHTS.values())), rho, rho)
    assert found["matrix of the product"].mean() < 0.25
    assert found["product of matrices"].mean() < 0.3
    assert found["RGB × RGB"].mean() > 2.0 * found["matrix of the product"].mean()
