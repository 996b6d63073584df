"""Random ways of light against what must come out of them."""

import numpy as np
import pytest

from spectral_skylight.addon.sky import phase_functions
from spectral_skylight.addon.sky.atmosphere import EARTH_RADIUS, Atmosphere, medium
from spectral_skylight.addon.sky.path_lengths import columns_to_space
from spectral_skylight.addon.sky.photons import follow
from spectral_skylight.addon.sky.scattering import direction, scattered_once, transmittance

VIEWS = direction(np.radians([5.0, 30.0, 90.0]), np.radians([20.0, 150.0, 0.0]))
SHELLS = 30


def random(seed=0):
    return np.random.default_rng(seed)


@pytest.mark.parametrize("g", [-0.3, 0.0, 0.76])
def test_phases_are_densities(g):
    cosine, weight = np.polynomial.legendre.leggauss(200)
    for phase in (
        phase_functions.rayleigh_phase(cosine),
        phase_functions.haze_phase(cosine, g),
        phase_functions.haze_density(cosine, g),
    ):
        assert 2 * np.pi * weight @ phase == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("g", [-0.3, 0.0, 0.76])
def test_draws_follow_their_densities(g):
    even = (np.arange(20_000) + 0.5) / 20_000
    cosine, weight = np.polynomial.legendre.leggauss(200)
    for draws, density in (
        (phase_functions.draw_rayleigh(even), phase_functions.rayleigh_phase(cosine)),
        (phase_functions.draw_haze(even, g), phase_functions.haze_density(cosine, g)),
    ):
        for power in (1, 2, 3):  # moments; 20,000 even numbers leave about 1e-6
            expected = 2 * np.pi * weight @ (density * cosine**power)
            assert np.mean(draws**power) == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("elevation", [50.0, 4.0])
def test_scattered_once_is_what_sums_say(elevation):
    """The same shells, once by chance and once added up."""
    matter = medium(Atmosphere(haze=0.1), SHELLS)
    sun = direction(np.radians(elevation), 0.0)
    batches = np.array([follow(matter, sun, VIEWS, 400, random(k), 1)[0][0] for k in range(10)])
    air, haze = scattered_once(matter, sun, VIEWS)
    cosine = (VIEWS @ sun)[:, None]
    exact = (
        phase_functions.rayleigh_phase(cosine) * air
        + phase_functions.haze_phase(cosine, 0.76) * haze
    )
    error = batches.std(axis=0, ddof=1) / np.sqrt(len(batches))
    # Four standard errors, and 0.5 % for shells that the sums take the sunlight of in the middle.
    assert np.all(np.abs(batches.mean(axis=0) - exact) < 4 * error + 0.005 * exact)


@pytest.mark.parametrize("ground", [0.0, 1.0])
def test_white_furnace(ground):
    """Lit evenly from all sides, where nothing absorbs, every direction is as bright as the light.

    By reciprocity this is that all light that enters the atmosphere leaves it again. A black ground
    takes what reaches it: then the directions are darker, all the more so the thicker the air.
    """
    air = Atmosphere(haze=0.1, haze_albedo=1.0, ozone=0, water=0, oxygen=False, ground=ground)
    matter = medium(air, SHELLS)
    chance = random(1)
    batches = []
    ways = 1500
    for _ in range(8):
        # Suns all over the sphere, a different one for every way.
        height = 1 - 2 * (np.arange(ways) + chance.random(ways)) / ways
        suns = direction(np.arcsin(height), 2 * np.pi * chance.random(ways))
        suns = suns[chance.permutation(ways)]
        means = [follow(matter, suns, view[None], ways, chance)[0] for view in VIEWS]
        batches.append(4 * np.pi * np.concatenate(means, axis=1).sum(axis=0))
    batches = np.array(batches) + transmittance(
        matter, columns_to_space(matter, EARTH_RADIUS, VIEWS[:, 2])
    )
    mean, error = batches.mean(axis=0), batches.std(axis=0, ddof=1) / np.sqrt(len(batches))
    if ground == 1.0:
        # 243 figures, few of them independent, from 8 batches: 5 errors pass, 2 % off would not.
        assert error.max() < 0.02
        assert np.all(np.abs(mean - 1.0) < 5 * error)
    else:
        assert np.all(mean[:2, 0] < 1.0 - 5 * error[:2, 0])


def test_orders_are_sorted():
    """Ways that may scatter twice bring the second order of ways that may go on for ever."""
    matter = medium(Atmosphere(), SHELLS)
    sun = direction(np.radians(40.0), 0.0)
    all_orders, square = follow(matter, sun, VIEWS, 3000, random(2))
    two, _ = follow(matter, sun, VIEWS, 3000, random(3), last=2)
    assert not two[2:].any() and (all_orders > 0).all()
    error = np.sqrt(square / 3000)  # more than that of the second order alone
    assert np.all(np.abs(two[1] - all_orders[1]) < 5 * error)


@pytest.mark.parametrize("elevation", [20.0, -4.0])
def test_guidance_changes_the_noise_alone(elevation):
    matter = medium(Atmosphere(), SHELLS)
    sun = direction(np.radians(elevation), 0.0)
    (plain, noise), (guided, less) = (
        follow(matter, sun, VIEWS, 6000, random(6), guided=choice) for choice in (False, True)
    )
    plain, guided = plain[1:].sum(axis=0), guided[1:].sum(axis=0)
    error = np.sqrt((noise - plain**2 + less - guided**2) / 6000)
    # 5 standard errors: they are themselves uncertain where few ways find the light.
    assert np.all(np.abs(plain - guided) < 5 * error)
    if elevation < 0:
        assert less.mean() - (guided**2).mean() < 0.5 * (noise.mean() - (plain**2).mean())


def test_black_ground_reflects_nothing():
    matter = medium(Atmosphere(ground=0.0), SHELLS)
    light, _ = follow(matter, direction(0.7, 0.0), VIEWS, 200, random())
    assert not light[3].any() and light[:3].any()


def test_same_seed_same_ways():
    matter = medium(Atmosphere(), SHELLS)
    sun = direction(0.5, 0.0)
    first, second, other = (follow(matter, sun, VIEWS, 50, random(k))[0] for k in (4, 4, 5))
    np.testing.assert_array_equal(first, second)
    assert (first != other).any()
