"""Our simulated sky beside Mitsuba's and Radiance's: as near as peers are to one another.

No peer is the truth. Hosek's sky was fitted to simulations at nine wavelengths 40 nm apart and
holds air and haze alone; Bruneton's, as Radiance has it, holds ozone, but samples the sun's height
16 times and the angle from the sun 4 times, and loses most of what is scattered more than once
(see `test_two_streams…`). Figures in brackets' comments are those of the pinned versions.
"""

import numpy as np
import pytest

from spectral_skylight.addon.sky.atmosphere import Atmosphere, rayleigh_optical_depth
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight
from spectral_skylight.tests.peers import conditions, skies
from spectral_skylight.tests.peers.peer import MISSING, PYTHON

pytestmark = [
    pytest.mark.peers,
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON.exists(), reason=MISSING),
]


@pytest.fixture(scope="module")
def compared():
    return skies.compare()


@pytest.fixture(scope="module")
def rows(compared):
    """Rows of one comparison, by its two names."""

    def of(peer, beside):
        found = [row for row in compared[0] if (row.peer, row.beside) == (peer, beside)]
        assert len(found) == len(conditions.SUN_ELEVATIONS)
        return found

    return of


@pytest.mark.parametrize("peer", ["mitsuba T=2", "mitsuba T=4"])
def test_hoseks_sky_is_near_ours(rows, peer):
    for row in rows(peer, "ours alike"):
        # 0.009 to 0.018. Turbidity is no exact amount of haze: half as much of it moves the mean
        # by 0.006, which is added to the 0.012 that the peers differ by at most suns.
        assert row.duv_mean < 0.020
        # 0.7 to 1.3; as 0.018 in u'v' is for the eye that is at home in each light.
        assert row.delta_E_mean < 1.6
        # 1.05 to 1.54. By its spectra's absolute height, which has the sun of another source.
        assert 0.95 < row.luminance_ratio < 1.7
        # 0.25 to 0.40: its brightness around the sun is flatter, a quarter of ours at 10 degrees.
        assert row.luminance_scatter < 0.45


@pytest.mark.parametrize("peer", ["radiance d=0.05", "radiance d=0.115"])
def test_brunetons_sky_is_near_ours(rows, peer):
    for row in rows(peer, "ours alike"):
        # 0.008 to 0.012. What is lost of its second scattering is blue: it takes 0.01.
        assert row.duv_mean < 0.015
        assert row.delta_E_mean < 1.3
        # 0.68 to 0.75.
        assert 0.6 < row.luminance_ratio < 0.85
        # 0.06 to 0.10: of the same phase functions, so near ours all over the dome.
        assert row.luminance_scatter < 0.13


@pytest.mark.parametrize("measure", ["duv_mean", "shape_mean", "delta_E_mean"])
def test_ours_is_nearer_to_each_than_they_are_to_one_another(rows, measure):
    """With the same haze, 0.10, over all suns."""
    one, other = skies.BESIDE

    def mean(pair):
        return np.mean([getattr(row, measure) for row in rows(*pair)])

    apart = mean((one, other))
    assert mean((one, "ours alike")) < apart
    assert mean((other, "ours alike")) < apart


def test_our_luminance_lies_between_theirs(rows):
    bright, dark = (rows(peer, "ours alike") for peer in skies.BESIDE)
    for above, below in zip(bright, dark, strict=True):
        assert below.luminance_ratio < 1.0 < above.luminance_ratio


def test_every_sky_tells_the_same_of_the_methods(compared):
    """Whoever's sky it is, the paper's basis leaves less than half of what RGB × RGB leaves."""
    errors = {(e.peer, e.sky, e.sun_elevation, e.method): e.delta_E_mean for e in compared[1]}
    skies_seen = {key[:3] for key in errors}
    assert len(skies_seen) == 3 * len(conditions.CONDITIONS) * len(conditions.SUN_ELEVATIONS)
    for sky in skies_seen:
        # The worst is a low sun with ozone, 0.40. Under Hosek's sky it is 0.16, for its spectra are
        # straight between nodes 40 nm apart, which no mixture of smooth ones is; in ours 0.05.
        assert errors[(*sky, "rayleigh")] < 0.5 * errors[(*sky, "RGB × RGB in Rec.709")]


def test_ozone_shows_in_both_who_hold_it(compared):
    """At 5° the paper's basis errs more under Radiance's sky than under Mitsuba's; ours does so."""
    errors = {
        (e.peer, e.sky): e.delta_E_mean
        for e in compared[1]
        if e.sun_elevation == 5.0 and e.method == "rayleigh"
    }
    without, with_it = skies.BESIDE
    for sky in ("theirs", "ours alike"):
        # 2.5 times and more: ozone's band is there, or it is not.
        assert errors[with_it, sky] > 1.5 * errors[without, sky]


def test_two_streams_side_with_us_where_radiance_is_dark():
    """What air alone scatters downwards, by Eddington's approximation at 390, 470 and 550 nm.

    Light leaving upwards is ((1 - g) τ + (2/3 - μ)(1 - exp(-τ/μ))) / (4/3 + (1 - g) τ) of what
    comes in (Meador and Weaver 1980, DOI 10.1175/1520-0469(1980)037<0630:TSATRT>2.0.CO;2); with
    nothing absorbed the rest goes down, directly or scattered. Radiance's sky of little haze holds
    hardly more blue light than air scatters once, where by this theory, and ours, it is half more.
    """
    air = Atmosphere(haze=0.0, ozone=0.0, water=0.0, oxygen=False, ground=0.0)
    sky = simulate(60.0, air, quality=skies.QUALITY)
    some, sun = np.searchsorted(WAVELENGTHS, [390, 470, 550]), np.sin(np.radians(60.0))
    depth = rayleigh_optical_depth()[some]
    away = (depth + (2 / 3 - sun) * (1 - np.exp(-depth / sun))) / (4 / 3 + depth)
    down = (1 - away - np.exp(-depth / sun)) * sun * extraterrestrial_sunlight()[some]
    # Eddington's own error at such depths is 1 to 3 %; ours by chance is 0.5 %.
    np.testing.assert_allclose(sky.irradiance()[some], down, rtol=0.04)
    assert sky.irradiance()[some[0]] > 1.4 * sky.irradiance("first")[some[0]]

    condition = conditions.CONDITIONS[2]
    once = simulate(60.0, condition.air, quality=skies.QUALITY, orders=1)
    seen = conditions.away_from_sun(60.0)
    theirs = skies.theirs(condition)[conditions.SUN_ELEVATIONS.index(60.0)][seen, some[0]]
    # 1.0 to 1.1, a mean over the dome, ground of 0.2 included.
    ratio = theirs.mean() / once.radiance(*conditions.directions())[seen, some[0]].mean()
    assert 0.9 < ratio < 1.25
