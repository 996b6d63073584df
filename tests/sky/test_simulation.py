"""Whole skies, all orders: against themselves, SPECTRL2 and daylight as it is measured."""

from pathlib import Path

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.photons import ORDERS
from spectral_skylight.addon.sky.simulation import PAPER, Quality, simulate
from spectral_skylight.addon.spectra import cache
from spectral_skylight.addon.spectra.bases import rayleigh
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.spectra.sensitivities import cmfs
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight

SMALL = Quality(once=(48, 19), more=(12, 9), ways=64, shells=30)
ELEVATION, AZIMUTH = np.radians([5.0, 40.0, 85.0]), np.radians([10.0, 100.0, 170.0])


@pytest.fixture(scope="module")
def sky():
    return simulate(40.0, quality=SMALL)


def test_orders_add_up(sky):
    parts = [sky.radiance(ELEVATION, AZIMUTH, order) for order in ORDERS]
    # Tables are float32.
    np.testing.assert_allclose(sum(parts), sky.radiance(ELEVATION, AZIMUTH), rtol=1e-5)
    assert all((part > 0).all() for part in parts)
    irradiance = sum(sky.irradiance(order) for order in ORDERS)
    np.testing.assert_allclose(irradiance, sky.irradiance(), rtol=1e-5)


def test_fewer_orders_are_the_same_orders(sky):
    once, twice = (simulate(40.0, orders=n, quality=SMALL) for n in (1, 2))
    np.testing.assert_array_equal(once.once, sky.once)
    assert not once.more.any() and not once.error.any()
    assert not twice.more[1:].any()
    # Other ways of light, so only alike within their errors.
    error = np.hypot(twice.irradiance_error(), sky.irradiance_error())
    assert np.all(np.abs(twice.irradiance("second") - sky.irradiance("second")) < 5 * error)


def test_seeds(sky):
    again, other = (simulate(40.0, quality=SMALL, seed=k, cached=False) for k in (0, 1))
    np.testing.assert_array_equal(again.more, sky.more)
    assert (other.more != sky.more).any()


def test_errors_are_the_scatter_between_seeds():
    quality = Quality(once=(8, 5), more=(6, 5), ways=64, shells=20)
    skies = [simulate(40.0, quality=quality, seed=seed, cached=False) for seed in range(16)]
    scatter = np.std([sky.irradiance() for sky in skies], axis=0, ddof=1)
    stated = np.sqrt(np.mean([sky.irradiance_error() ** 2 for sky in skies], axis=0))
    # 16 seeds know their scatter to 18 %; first turns are spread evenly, which helps a little
    # more than is stated.
    assert np.all(scatter < 1.6 * stated) and np.all(scatter > 0.4 * stated)


@pytest.mark.parametrize("elevation", [-3.0, 2.3])
def test_noise_changes_smoothly_as_the_sun_sinks(elevation):
    """The same ways serve all low suns, and fade gradually into those of higher ones: halfway
    between two suns a sky is the mean of theirs to far less than its own noise."""
    quality = Quality(once=(8, 5), more=(6, 5), ways=64, shells=20)
    before, sky, after = (
        simulate(elevation + step, quality=quality, cached=False) for step in (-0.1, 0.0, 0.1)
    )
    between = 0.5 * (before.more.sum(axis=0) + after.more.sum(axis=0))
    left = np.abs(between - sky.more.sum(axis=0)) / sky.error
    assert np.median(left) < 0.05  # independent noise leaves 0.8


def test_more_ways_converge():
    """Four times the ways, half the error."""
    few, many = (
        simulate(40.0, quality=Quality((8, 5), (8, 7), ways, 20), cached=False).irradiance_error()
        for ways in (128, 512)
    )
    # The error's own error is some 10 % with rare bright ways.
    assert np.median(few / many) == pytest.approx(2.0, rel=0.25)


def test_sky_is_its_own_mirror_image(sky):
    pixels = picture(sky, 16)
    np.testing.assert_allclose(pixels, pixels[:, (np.arange(32, 0, -1) + 15) % 32], rtol=1e-4)


def test_picture_holds_the_irradiance(sky):
    pixels = picture(sky, 128)[:64].astype(float)
    edges = np.sin(np.linspace(np.pi / 2, 0, 65)) ** 2
    received = np.einsum("hwn,h->n", pixels, edges[:-1] - edges[1:]) * np.pi / 256
    # Pixels of 1.4°, bilinear tables.
    np.testing.assert_allclose(received, sky.irradiance(), rtol=5e-3)


def test_ground_shows_its_colour():
    ground = np.linspace(0.1, 0.8, 81)
    sky = simulate(40.0, Atmosphere(ground=ground), quality=SMALL)
    below = picture(sky, 16)[-1, 0]
    lit = sky.irradiance() + sky.direct * np.sin(np.radians(40.0))
    np.testing.assert_allclose(below, ground * lit / np.pi, rtol=1e-5)
    # And reddens the sky, for the air reflects it back.
    grey = simulate(40.0, Atmosphere(ground=0.45), quality=SMALL).irradiance("ground")
    tilt = sky.irradiance("ground") / grey
    assert tilt[-1] > 1.5 * tilt[40] > 2 * tilt[0]


def test_the_papers_sky_is_near_its_basis():
    """By its own assumptions a sky is sunlight times a polynomial of λ^-4 but for its end."""
    B = rayleigh()
    for elevation, limit in ((60.0, 0.01), (30.0, 0.03)):
        sky = simulate(elevation, PAPER, orders=2, quality=SMALL).irradiance()
        mixture = np.linalg.lstsq(B.T, sky, rcond=None)[0] @ B
        # The third power of the optical depth of the way, 0.4 / sin(elevation), over six, mostly
        # taken up by the first three: a few tenths of it stay.
        assert np.sqrt(np.mean((mixture / sky - 1) ** 2)) < limit


def test_ozone_makes_twilight_blue():
    """E. O. Hulburt 1953 (DOI 10.1364/JOSA.43.000113): without it the zenith would be yellowish."""
    with_it, without = (
        simulate(-2.0, Atmosphere(ozone=du), quality=SMALL, orders=1).radiance(np.pi / 2, 0.0)
        for du in (300.0, 0.0)
    )
    blue, orange = np.searchsorted(WAVELENGTHS, [450, 600])
    assert with_it[orange] / with_it[blue] < 0.6 * without[orange] / without[blue]


@pytest.mark.parametrize("elevation", [60.0, 30.0, 10.0])
def test_daylight_lies_on_cies_locus(elevation):
    """Sun and sky together, and the whole sky alone, near the CIE daylight locus."""
    colour = pytest.importorskip("colour")
    sky = simulate(elevation, quality=SMALL)
    whole = sky.irradiance()
    x, y = colour.temperature.CCT_to_xy_CIE_D(np.linspace(4000, 25000, 4001)).T
    locus = np.stack([4 * x, 6 * y], axis=1) / (-2 * x + 12 * y + 3)[:, None]
    for light in (whole, whole + sky.direct * np.sin(np.radians(elevation))):
        X, Y, Z = light @ cmfs().T
        uv = np.array([4 * X, 6 * Y]) / (X + 15 * Y + 3 * Z)
        # Judd's 622 measured spectra scatter about 0.003 around the locus.
        assert np.min(np.linalg.norm(locus - uv, axis=1)) < 0.004


@pytest.mark.slow
@pytest.mark.parametrize("haze", [0.0, 0.1, 0.27])
@pytest.mark.parametrize("elevation", [30.0, 45.0, 60.0])
def test_sky_is_shaped_like_spectrl2s(elevation, haze):
    """Diffuse irradiance against Bird and Riordan 1984, 420-680 nm, relative to each one's sun."""
    pvlib = pytest.importorskip("pvlib")
    # Their asymmetry of 0.65 is the mean cosine, which Cornette and Shanks' g = 0.584 has; their
    # albedo of haze falls from 0.94 to 0.92. They know no bands under 680 nm but at 593 nm.
    air = Atmosphere(
        haze=haze * (500 / 550) ** 1.14,
        angstrom=1.14,
        asymmetry=0.584,
        haze_albedo=0.93,
        water=0.0,
        oxygen=False,
        pressure=1013.0,
    )
    sky = simulate(elevation, air, quality=Quality((48, 19), (12, 13), 256, 30))
    zenith = 90.0 - elevation
    mass = float(pvlib.atmosphere.get_relative_airmass(zenith, "kastenyoung1989"))
    theirs = pvlib.spectrum.spectrl2(
        *(zenith, zenith, 0, 0.2, 101300, mass, 0.0, 0.3, haze), dayofyear=93, alpha=1.14
    )
    nodes = theirs["wavelength"]
    inside = (nodes >= 420) & (nodes <= 680)
    expected = np.ravel(theirs["dhi"] / theirs["dni_extra"])[inside]
    ours = np.interp(nodes[inside], WAVELENGTHS, sky.irradiance() / extraterrestrial_sunlight())
    ratio = ours / expected
    assert ratio.max() / ratio.min() < 1.05 / 0.95
    # Their level is good to some 5 % (their own comparison with measurements).
    assert np.all(np.abs(ratio - 1) < 0.12)


@pytest.mark.slow
def test_reference_sky():
    """What the reference promises: 2,048 directions, 0.5 % on the horizontal irradiance."""
    sky = simulate(30.0, quality="reference", cached=False)
    assert sky.error.shape == (32, 64, 81)
    assert np.all(sky.irradiance_error() < 0.005 * sky.irradiance())
    preview = simulate(30.0, quality="preview", cached=False)
    error = np.hypot(sky.irradiance_error(), preview.irradiance_error())
    # And 0.5 % for the preview's coarser tables and shells.
    difference = np.abs(sky.irradiance() - preview.irradiance())
    assert np.all(difference < 4 * error + 0.005 * sky.irradiance())


def test_cache_answers_and_survives_damage(tmp_path, monkeypatch):
    monkeypatch.setenv("SPECTRAL_SKYLIGHT_CACHE", str(tmp_path))
    tiny = Quality(once=(4, 3), more=(4, 3), ways=4, shells=10)
    first = simulate(20.0, quality=tiny)
    (file,) = tmp_path.iterdir()
    np.testing.assert_array_equal(simulate(20.0, quality=tiny).more, first.more)
    simulate(20.0, Atmosphere(ozone=301.0), quality=tiny)
    assert len(list(tmp_path.iterdir())) == 2
    file.write_bytes(file.read_bytes()[:500])
    np.testing.assert_array_equal(simulate(20.0, quality=tiny).more, first.more)
    assert len(cache.load(file)) == 4


def test_no_cache_when_there_is_to_be_none(monkeypatch):
    monkeypatch.setenv("SPECTRAL_SKYLIGHT_CACHE", "")
    assert cache.place("sky", {}, Path()) is None


def test_unwritable_cache_is_no_matter(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SPECTRAL_SKYLIGHT_CACHE", str(tmp_path / "file"))
    simulate(20.0, quality=Quality((4, 3), (4, 3), 4, 10))


@pytest.mark.parametrize(
    ("settings", "part"),
    [
        ({"sun_elevation": -7.0}, "^sun elevation: "),
        ({"sun_elevation": float("nan")}, "^sun elevation: "),
        ({"orders": 0}, "^orders: "),
        ({"quality": "best"}, "^quality: "),
        ({"seed": -1}, "^seed: "),
    ],
)
def test_out_of_range_is_said(settings, part):
    with pytest.raises(InputError, match=part):
        simulate(**{"sun_elevation": 30.0, **settings})
