"""The bases: those of measured light, and that of simulated light by sun and colour."""

from dataclasses import replace

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.evaluation.evaluation import evaluate
from spectral_skylight.addon.sky import daylight_ensemble
from spectral_skylight.addon.spectra import bases, sensitivities
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.ensemble import shipped
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.light import read_light
from spectral_skylight.addon.spectra.sensitivities import cmfs, observer
from spectral_skylight.addon.transfer.matrices import transfer

ROUNDING = 1e-9
"""Of solving 3x3 systems whose condition is some thousands, in float64."""


@pytest.fixture(scope="module")
def checker():
    return colorchecker()[1]


def write(path, spectra, wavelengths=WAVELENGTHS):
    header = ",".join(["nm", *(f"light {k}" for k in range(len(spectra)))])
    rows = np.column_stack([wavelengths, *spectra])
    path.write_text("\n".join([header, *(",".join(map(repr, map(float, r))) for r in rows)]))
    return path


def errors_of(lights, rho, method, **known):
    found = {e.method: e.delta_E for e in evaluate(lights, rho, **known)}
    return found[method], found["rayleigh"]


def test_measured_light_is_restored_exactly(tmp_path):
    span = bases.rayleigh()
    mixes = np.array([[1.0, 0, 0], [1, 1, 0], [1, 1, 1], [3, 1, 2]])
    B = bases.basis(f"measured {write(tmp_path / 'light.csv', mixes @ span)}", observer())
    assert B.shape == (3, 81)
    light = np.array([2.0, 0.3, 0.4]) @ span
    restored = bases.restoration(B, observer()) @ (observer() @ light)
    np.testing.assert_allclose(restored, light, rtol=1e-6)  # squares of small components are lost


def test_measured_light_counts_by_its_shape(tmp_path):
    spectra = np.stack([*bases.rayleigh(), bases.daylight()[0]])
    one = bases.measured(write(tmp_path / "one.csv", spectra))
    other = bases.measured(write(tmp_path / "other.csv", spectra * [[1], [1e3], [1e-3], [7]]))
    np.testing.assert_allclose(np.abs(one @ other.T), np.eye(3), atol=1e-6)


@pytest.mark.parametrize(
    ("spectra", "message"),
    [
        (bases.rayleigh()[:2], "fewer than three"),
        (np.ones((5, 81)), "fewer than three"),
        (np.stack([*bases.rayleigh(), np.zeros(81)]), "'light 3'.*holds no light"),
        (np.stack([*bases.rayleigh(), np.full(81, np.nan)]), "'light 3'.*missing"),
    ],
)
def test_light_that_is_no_basis_is_refused(tmp_path, spectra, message):
    with pytest.raises(InputError, match=message):
        bases.measured(write(tmp_path / "light.csv", spectra))


def test_unknown_basis_names_the_choices():
    with pytest.raises(InputError, match="rayleigh, daylight, atmosphere or 'measured FILE.csv'"):
        bases.basis("fourier", observer())


@pytest.mark.parametrize("known", [{}, {"sun_elevation": 3.0}, {"sky_rgb": (0.2, 0.35, 0.7)}])
@pytest.mark.parametrize("S", [observer(), sensitivities.camera("Nikon 5100")])
def test_atmosphere_keeps_the_three_numbers(S, known):
    R = bases.restoration(bases.atmosphere(S, **known), S)
    np.testing.assert_allclose(S @ R, np.eye(3), atol=ROUNDING)


def test_atmosphere_does_not_depend_on_the_light_s_brightness():
    one = bases.atmosphere(sky_rgb=(0.2, 0.35, 0.7))
    np.testing.assert_allclose(bases.atmosphere(sky_rgb=(20.0, 35.0, 70.0)), one, rtol=ROUNDING)


def test_colours_that_no_sky_has_are_not_listened_to():
    """Far from every member all count alike, whatever the colour; the floor keeps it so to 1e-3."""
    green, magenta = (bases.atmosphere(sky_rgb=rgb) for rgb in ((0.05, 1, 0.05), (1, 0.05, 1)))
    np.testing.assert_allclose(green, magenta, atol=1e-3 * np.abs(green).max())


def test_elevations_and_colours_that_tell_nothing_more():
    """Beyond the ensemble the nearest elevation counts; light without luminance has no colour."""
    np.testing.assert_allclose(
        bases.atmosphere(sun_elevation=-40.0), bases.atmosphere(sun_elevation=-6.0), atol=1e-6
    )  # the lean, soft, is 3e-7 of the paper's basis here
    for known in ({"sun_elevation": 30.0}, {}):
        np.testing.assert_array_equal(
            bases.atmosphere(sky_rgb=(0.0, 0.0, 0.0), **known), bases.atmosphere(**known)
        )
    with pytest.raises(InputError, match="sun elevation: 91"):
        bases.atmosphere(sun_elevation=91.0)


def test_white_balance_is_undone_before_the_colour_is_looked_at(checker):
    white, rgb = np.array([0.8, 1.0, 1.3]), np.array([0.2, 0.35, 0.7])
    plain = transfer("atmosphere", sky_rgb=rgb)
    balanced = transfer("atmosphere", sky_rgb=rgb / white, white=white)
    D = np.diag(1 / white)
    np.testing.assert_allclose(
        balanced.matrices(checker), D @ plain.matrices(checker) @ np.linalg.inv(D), atol=ROUNDING
    )


def test_the_table_is_what_its_module_draws():
    """The first atmosphere of the seed, light by light, as far as the compression keeps it."""
    rng = np.random.default_rng([1964, True])
    atmosphere = daylight_ensemble.draw_atmosphere(rng)
    drawn = list(daylight_ensemble.lights(daylight_ensemble.ELEVATIONS[0], atmosphere, rng))
    kept = shipped()
    assert list(kept.kinds[: len(drawn)]) == [kind for kind, _ in drawn]
    _, shade = drawn[[kind for kind, _ in drawn].index("shade")]
    member = kept.spectra[[kind for kind, _ in drawn].index("shade")]
    # Photons leave their chance, some per cent of a twilight's light: more than a compression to
    # sixteen components does, less than another atmosphere would.
    seen = (WAVELENGTHS >= 420) & (WAVELENGTHS <= 680)
    np.testing.assert_allclose(member[seen], (shade / (cmfs()[1] @ shade))[seen], rtol=0.1)


def test_unseen_simulated_light(checker):
    """Skies of another seed: with the elevation told, under half of the paper's error."""
    rng = np.random.default_rng(7)
    lights, elevations = [], []
    for elevation in (-3.0, 1.0, 4.0, 12.0, 40.0):
        air = replace(daylight_ensemble.draw_atmosphere(rng), ozone=350.0)
        for _, spectrum in daylight_ensemble.lights(elevation, air, rng):
            lights.append(spectrum)
            elevations.append(elevation)
    ours, paper = errors_of(
        lights, checker, "atmosphere, elevation known", sun_elevation=elevations
    )
    assert ours.mean() < 0.5 * paper.mean()


def test_measured_daylight_reaches_the_marks(shared_data, checker):
    """Stanford, 1,076 measured daylights, no elevation: issue 3 asks 1.5 times the best 3x3."""
    light = read_light(shared_data / "sky/stanford_dicarlo/daylightSpectra.csv").values[::12]
    found = {e.method: e.delta_E for e in evaluate(light, checker)}
    for method in ("atmosphere", "atmosphere, colour known"):
        assert found[method].mean() < 1.5 * found["best 3x3"].mean()
        assert np.percentile(found[method], 95) < np.percentile(found["rayleigh"], 95)


def test_a_low_sun_needs_its_elevation(shared_data, checker):
    """Modelled hours (libRadtran, Helsinki) with the sun between 2° and 5°: paper 0.9, ours 0.2."""
    light = read_light(shared_data / "sky/photobiology_sun/sun_hourly_june.spct_MODELLED.csv")
    rows = [k for k in range(len(light.values)) if k % 18 in (0, 17)]  # first and last of each day
    ours, paper = errors_of(
        light.values[rows], checker, "atmosphere, elevation known", sun_elevation=3.85
    )
    assert paper.mean() > 0.7 and ours.mean() < 0.25
    assert np.percentile(ours, 95) < np.percentile(paper, 95)


def test_nowhere_much_worse_than_the_paper(shared_data, checker):
    """Sunlight through a gap in leaves: the least like any sky of all that was measured."""
    light = read_light(shared_data / "sky/photobiology_sun/gap_72_measured_1nm.csv").values[::9]
    ours, paper = errors_of(light, checker, "atmosphere, colour known")
    assert ours.mean() < paper.mean() + 0.02
    assert np.percentile(ours, 95) < np.percentile(paper, 95) + 0.02


@pytest.fixture(scope="module")
def without_ozone():
    """Skies by day as models without ozone make them, of air and haze not in the ensemble."""
    rng = np.random.default_rng(11)
    lights, elevations = [], []
    for elevation in (12.0, 25.0, 45.0):
        air = replace(daylight_ensemble.draw_atmosphere(rng), ozone=0.0)
        drawn = [s for kind, s in daylight_ensemble.lights(elevation, air, rng) if kind == "sky"]
        lights += drawn
        elevations += [elevation] * len(drawn)
    return np.array(lights), np.array(elevations)


@pytest.mark.parametrize(
    ("method", "worse"),
    [
        ("atmosphere", 0.02),
        ("atmosphere, colour known", 0.05),
        ("atmosphere, elevation known", 0.08),
        ("atmosphere, colour and elevation known", 0.08),
    ],
)
def test_what_ozone_costs_skies_without_it(without_ozone, checker, method, worse):
    """The paper's own skies, nearly: three numbers do not tell by day that there is no ozone.

    Where nothing is told 0.02 above the paper's error is held; the rest is what real skies, which
    have ozone, gain several times over.
    """
    lights, elevations = without_ozone
    ours, paper = errors_of(lights, checker, method, sun_elevation=elevations)
    assert ours.mean() < paper.mean() + worse


def test_the_colour_tells_whether_a_low_sun_s_sky_has_ozone(checker):
    """Both known against the elevation alone, on a sky without ozone."""
    rng = np.random.default_rng(12)
    air = replace(daylight_ensemble.draw_atmosphere(rng), ozone=0.0)
    lights = np.array([s for _, s in daylight_ensemble.lights(0.5, air, rng)])
    told, blind = (
        errors_of(lights, checker, f"atmosphere, {what} known", sun_elevation=0.5)[0]
        for what in ("colour and elevation", "elevation")
    )
    assert told.mean() < 0.7 * blind.mean()
