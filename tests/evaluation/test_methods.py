"""Identities that the methods hold, whatever the light: exact ones first, then who beats whom."""

import colour
import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.evaluation import methods, upsampling
from spectral_skylight.addon.evaluation.methods import (
    BEST,
    METHODS,
    Sky,
    estimate,
    rgb_times_rgb,
    true_colours,
    with_basis,
)
from spectral_skylight.addon.spectra import bases
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.ensemble import shipped
from spectral_skylight.addon.spectra.grid import resample
from spectral_skylight.addon.spectra.illuminants import D65, daylight
from spectral_skylight.addon.spectra.sensitivities import observer
from spectral_skylight.addon.spectra.working_spaces import XYZ_to_working
from spectral_skylight.addon.transfer import textures
from spectral_skylight.addon.transfer.measures import relative_error
from spectral_skylight.addon.transfer.prediction import rgb_albedo

ROUNDING = 1e-9
"""Of sums of 81 float64 products and small linear systems."""

RNG = np.random.default_rng(4)
ROUGH = RNG.uniform(0.1, 1.0, (7, 81))
"""Lights that no model of skylight knows."""


@pytest.fixture(scope="module")
def checker():
    return colorchecker()[1]


def errors(name, lights, rho, sun_elevation=20.0):
    """Relative errors (k, m) of a method under one sky's lights."""
    method = METHODS.get(name) or with_basis(name)
    colours = estimate(method, [Sky(lights, sun_elevation)], rho)
    return relative_error(colours, true_colours(lights, rho))


def of_the_day():
    return bases.rayleigh() * [[1], [0.3], [0.1]]


def expected():
    """Mixtures of the six functions that the 3x6 matrices rest on, (9, 81)."""
    spectra = shipped().spectra
    functions = methods.six_channels() @ spectra.T @ spectra
    return RNG.uniform(0.5, 1.0, (9, 6)) @ (functions / np.abs(functions).max(axis=1)[:, None])


EXACT = {
    "81 bands": ROUGH,
    "rayleigh": of_the_day(),
    "daylight": bases.daylight(),
    "six channels, 3x6": expected(),
    "best 3x3": of_the_day(),
    "best diagonal": ROUGH[:1],
    "RGB × RGB in Rec.709": D65()[None],
    "RGB × RGB in Rec.2020": 3.0 * D65()[None],
    "RGB × RGB in Rec.709, own white": ROUGH[:1],
    "RGB × RGB in Rec.2020, own white": ROUGH[:1],
    "prefiltered RGB": ROUGH[:1],
}
"""The light under which a method leaves nothing."""


@pytest.mark.parametrize("name", EXACT)
def test_a_method_is_exact_under_the_light_it_is_made_for(name, checker):
    assert errors(name, EXACT[name], checker).max() < ROUNDING


@pytest.mark.parametrize("name", [name for name in EXACT if name != "81 bands"])
def test_and_is_not_under_any_other(name, checker):
    """Otherwise the test above could not fail."""
    assert errors(name, ROUGH, checker).max() > 0.01


COARSE = {f"{count} bands" for count in (4, 8, 16, 31)}


@pytest.mark.parametrize("name", [name for name in METHODS if name not in COARSE])
def test_a_grey_shows_the_light_s_own_colour(name):
    """True of all that hold the light's own RGB; bands are too coarse to hold it."""
    lights = of_the_day()
    grey = errors(name, lights, np.full((1, 81), 0.4)).max()
    # The table of sigmoids is straight between nodes; Otsu's spectra are cut at 0 and 1.
    assert grey < {"Jakob-Hanika": 0.01, "Otsu": 0.05}.get(name, ROUNDING)


@pytest.mark.parametrize("name", METHODS)
def test_light_s_size_and_reflectance_s_size_come_through(name, checker):
    sky = of_the_day()
    colours = estimate(METHODS[name], [Sky(sky, 20.0)], checker)
    twice = estimate(METHODS[name], [Sky(2.0 * sky, 20.0)], 0.5 * checker)
    np.testing.assert_allclose(twice, colours, rtol=1e-6, atol=1e-9 * np.abs(colours).max())


def test_a_texture_is_the_material_that_its_colour_makes(checker):
    """One that is a mixture of the basis already has its own matrix; a measured one is between."""
    mixed = rgb_albedo(checker) @ textures.basis()
    own = "atmosphere, colour and elevation known"
    sky = Sky(of_the_day(), 20.0)
    texture = METHODS["texture, three matrices"]
    np.testing.assert_allclose(
        estimate(texture, [sky], checker), estimate(METHODS[own], [sky], mixed), rtol=1e-9
    )
    left, best, today = (
        errors(name, sky.lights, checker).mean()
        for name in (texture.name, own, "RGB × RGB in Rec.709")
    )
    assert best < 0.7 * left < 0.7 * today


def test_more_bands_leave_less(checker):
    left = [errors(f"{n} bands", bases.daylight()[:1], checker).mean() for n in (4, 8, 16, 31, 81)]
    assert left == sorted(left, reverse=True) and left[0] > 0.01


@pytest.mark.parametrize("count", [1, 2, 6, 31, 80, 81])
def test_bands_hold_each_node_once_and_none_is_empty(count):
    parts = methods._parts(count)
    assert np.all(parts.sum(axis=0) == 1) and np.all(parts.sum(axis=1) >= 1)
    assert np.all(np.diff(np.argmax(parts, axis=0)) >= 0)


def test_nothing_of_its_kind_beats_a_limit(checker):
    """Least squares made these: no other of the same form leaves a smaller sum of squares."""
    true = true_colours(ROUGH, checker)

    def squares(name):
        return ((estimate(METHODS[name], [Sky(ROUGH, 20.0)], checker) - true) ** 2).sum()

    diagonal = ["RGB × RGB in Rec.709", "RGB × RGB in Rec.709, own white"]
    matrices = ["rayleigh", "daylight", "atmosphere, elevation known", "Mallett-Yuksel"]
    assert all(squares("best diagonal") < squares(other) for other in diagonal)
    assert all(squares(BEST) < squares(other) for other in [*diagonal, *matrices, "best diagonal"])


def test_six_numbers_know_more_than_three(checker):
    """Under simulated light: half of what three leave is no close call (a third seen)."""
    lights = shipped().spectra[shipped().ozone][::50]
    six = errors("six channels, 3x6", lights, checker).mean()
    assert six < 0.5 * errors("rayleigh", lights, checker).mean()
    multiplied = errors("six channels multiplied", lights, checker).mean()
    assert six < multiplied < errors("RGB × RGB in Rec.709", lights, checker).mean()


def test_a_method_sees_only_what_it_is_told(checker):
    """Lights of the same RGB (metamers) look alike to whoever reads RGB, not to bands."""
    S = observer()
    flat = np.ones(81)
    ripple = np.sin(np.arange(81) / 5.0)
    metamer = flat + 0.5 * (ripple - np.linalg.pinv(S) @ (S @ ripple))
    rough = Sky(np.stack([flat, metamer]), 20.0)
    for name, method in METHODS.items():
        first, second = estimate(method, [rough], checker)
        alike = np.allclose(first, second, rtol=1e-6, atol=1e-9)
        knows_more = method.family in ("bands", "six channels")
        assert alike == (not knows_more), name


def test_told_methods_are_told_each_sky_alone(checker):
    """Two skies at once give what each gives by itself."""
    skies = [Sky(of_the_day(), 3.0), Sky(bases.daylight(), 60.0)]
    for method in METHODS.values():
        if not method.is_limit:
            both = estimate(method, skies, checker)
            alone = np.concatenate([estimate(method, [sky], checker) for sky in skies])
            np.testing.assert_allclose(both, alone, atol=ROUNDING * np.abs(alone).max())
    assert METHODS["best 3x3"].is_limit


def test_a_sun_that_is_not_known_is_asked_for(checker):
    with pytest.raises(InputError, match="sun elevation"):
        estimate(METHODS["atmosphere, elevation known"], [Sky(ROUGH)], checker)


def test_the_product_s_space_matters_only_off_its_own_light(checker):
    """A new entry is one call: the same product in another space."""
    acescg = rgb_times_rgb("in ACEScg", lambda: XYZ_to_working("ACEScg"))
    lights = np.stack([D65(), of_the_day()[0]])
    (exact, _), (_, other) = (
        relative_error(estimate(m, [Sky(lights)], checker), true_colours(lights, checker)).max(1)
        for m in (acescg, acescg)
    )
    assert exact < ROUNDING and other > 0.01


COLOURS = np.array([[0.2, 0.3, 0.5], [0.5, 0.4, 0.1], [0.3, 0.5, 0.4]])


@pytest.mark.parametrize("rgb", COLOURS)
def test_upsampling_is_that_of_colour_science(rgb):
    """Theirs solves for each colour; ours reads tables. Both take these as reflectances."""
    from colour.recovery.jakob2019 import find_coefficients_Jakob2019, sd_Jakob2019

    XYZ = colour.RGB_to_XYZ(rgb, "sRGB")
    coefficients, _ = find_coefficients_Jakob2019(XYZ, max_error=1e-5)
    sigmoid = sd_Jakob2019(coefficients, colour.SpectralShape(380, 780, 5)).values
    components = colour.recovery.XYZ_to_sd_Otsu2018(XYZ)
    otsu = resample(components.wavelengths, components.values)
    # Published RGB matrices have four digits, and the table's cells are a sixteenth wide.
    for restore, theirs in ((upsampling.jakob_hanika(), sigmoid), (upsampling.otsu(), otsu)):
        ours = restore(rgb[:, None])[:, 0] / upsampling._neutral()
        np.testing.assert_allclose(ours, theirs, atol=3e-3)


def test_upsampled_light_has_the_colour_it_was_made_of():
    lights = RNG.uniform(0.05, 1.0, (200, 3)) * 10.0 ** RNG.uniform(-3, 3, (200, 1))
    back = (observer() @ upsampling.jakob_hanika()(lights.T)).T
    # A twentieth of the brightest component is the table's outermost cell, where it bends most.
    assert np.max(np.abs(back - lights) / lights.max(axis=1, keepdims=True)) < 0.01
    spectra = upsampling.mallett_yuksel()
    np.testing.assert_allclose(observer() @ spectra, np.eye(3), atol=ROUNDING)


def test_black_and_impossible_light_give_no_nonsense():
    lights = np.array([[0.0, 0.0, 0.0], [-0.1, 0.2, 0.9]])
    ways = upsampling.jakob_hanika(), upsampling.otsu(), upsampling.nearest_daylight()
    for restore in ways:
        black, blue = restore(lights.T).T
        assert np.all(np.abs(black) < 1e-20) and np.all(blue >= 0) and blue.max() > 0


def test_a_known_daylight_is_found_again_and_others_keep_their_colour():
    known = np.geomspace(4000.0, 25000.0, 24)  # the temperatures that it knows
    restore = upsampling.nearest_daylight()
    spectra = daylight(known)
    np.testing.assert_allclose(restore(observer() @ spectra.T).T, spectra, rtol=1e-9)
    between = of_the_day()
    seen = observer() @ between.T
    np.testing.assert_allclose(observer() @ restore(seen), seen, rtol=1e-6)
