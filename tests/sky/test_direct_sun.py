"""Sunlight through the air against others' spectra, and the energy of clipped suns."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from spectral_skylight.addon.errors import InputError
from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.clear_sky import SCALE, picture
from spectral_skylight.addon.sky.direct_sun import direct_sunlight, restored_sun
from spectral_skylight.addon.sky.light import analyse
from spectral_skylight.addon.sky.panorama import Panorama, read_panorama
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.spectra.ensemble import uv
from spectral_skylight.addon.spectra.grid import WAVELENGTHS, WEIGHTS, band_average
from spectral_skylight.addon.spectra.sensitivities import camera, cmfs, observer
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight
from spectral_skylight.addon.spectra.working_spaces import LUMINANCE

S = observer()
QUALITY = Quality(once=(24, 13), more=(12, 9), ways=128, shells=30)


def shape(spectrum):
    """A spectrum over its luminance."""
    return spectrum / (cmfs()[1] * WEIGHTS @ spectrum)


def colour_distance(one, other):
    return np.linalg.norm(uv(cmfs() * WEIGHTS @ one) - uv(cmfs() * WEIGHTS @ other))


def weighted_error(ours, theirs):
    """Relative error of shapes, wavelengths counted as the eye sees them."""
    seen = cmfs().sum(axis=0) * theirs
    return float(np.average(np.abs(shape(ours) / shape(theirs) - 1.0), weights=seen))


def astm_direct():
    from colour.plotting.datasets.astm_g_173 import SD_ASTMG173_DIRECT_CIRCUMSOLAR as table

    return band_average(table.wavelengths, table.values)


def test_the_suns_colour_gives_astms_spectrum():
    """Of ASTM G173-03 direct (41.8°) three numbers of any size are told, and the elevation."""
    theirs = astm_direct()
    for S_in in (S, camera("Nikon 5100")):
        ours = direct_sunlight(90.0 - 48.236, 7.0 * S_in @ theirs, S_in)
        # Its rural haze bends where Ångström's law is straight: 1 to 2 % below 420 nm.
        assert weighted_error(ours, theirs) < 0.008
        assert colour_distance(ours, theirs) < 0.001


def test_without_a_colour_the_suns_energy_is_astms():
    """Of haze, ozone and water the means are taken: the eye sees 0.084, 344 DU of ASTM's."""
    theirs, ours = astm_direct(), direct_sunlight(90.0 - 48.236)
    assert cmfs()[1] @ ours == pytest.approx(cmfs()[1] @ theirs, rel=0.03)
    assert weighted_error(ours, theirs) < 0.02


@pytest.mark.parametrize("mass", [1.0, 2.0, 5.0, 10.0])
@pytest.mark.parametrize("haze", [0.05, 0.3])
def test_direct_is_spectrl2s(mass, haze):
    """Bird and Riordan's direct beam, from its own RGB, at air masses to 10 (5.2°)."""
    pvlib = pytest.importorskip("pvlib")
    zenith = np.linspace(0.0, 89.0, 8901)
    masses = pvlib.atmosphere.get_relative_airmass(zenith, "kastenyoung1989")
    zenith = float(np.interp(mass, masses, zenith))
    found = pvlib.spectrum.spectrl2(
        apparent_zenith=zenith,
        aoi=zenith,
        surface_tilt=0.0,
        ground_albedo=0.2,
        surface_pressure=101325.0,
        relative_airmass=mass,
        precipitable_water=1.4,
        ozone=0.32,
        aerosol_turbidity_500nm=haze,
        alpha=1.14,
        dayofyear=94,  # at one astronomical unit
    )
    beam = np.interp(WAVELENGTHS, found["wavelength"], found["dni"].ravel())
    # Its 122 points are no band averages (Fraunhofer lines alias by several per cent): the ratio to
    # its own sun is smooth.
    table = pvlib.spectrum.spectrl2.__globals__["_SPECTRL2_COEFFS"]
    sun = np.interp(WAVELENGTHS, table["wavelength"], table["spectral_irradiance_et"])
    theirs = beam / sun * extraterrestrial_sunlight()
    ours = direct_sunlight(90.0 - zenith, S @ theirs)
    # Its air is 1.2 % thicker, its ozone of before 1980: that times the air mass.
    assert weighted_error(ours, theirs) < 0.006 + 0.003 * mass
    assert colour_distance(ours, theirs) < 0.003


@pytest.mark.parametrize("elevation", [1.0, 8.0, 30.0, 80.0])
def test_direct_is_our_skies_from_its_rgb(elevation):
    for air in (Atmosphere(), Atmosphere(haze=0.2, ozone=250.0, angstrom=0.9, water=30.0)):
        theirs = simulate(elevation, air, orders=1, quality=QUALITY, cached=False).direct
        ours = direct_sunlight(elevation, S @ theirs)
        # Water, 14 mm here, is not told by a colour; nor is which of two airs it was.
        assert weighted_error(ours, theirs) < (0.015 if elevation > 1.0 else 0.035)
        assert colour_distance(ours, theirs) < 0.001


def test_elevations():
    np.testing.assert_array_equal(direct_sunlight(-0.5), direct_sunlight(0.0))
    with pytest.raises(InputError, match="give -90 to 90"):
        direct_sunlight(91.0)


@lru_cache
def simulated(elevation, haze):
    return simulate(elevation, Atmosphere(haze=haze), quality=QUALITY, seed=5, cached=False)


def lit(elevation, level=None, haze=0.1):
    """A simulated sky with its sun, clipped at a multiple of its median luminance, and the truth.

    The truth is RGB irradiance / pi of a face that looks at the sun.
    """
    sky = simulated(elevation, haze)
    rgb = picture(sky, 256, 180.0, True, S * SCALE)
    if level is not None:
        rgb = np.minimum(rgb, level * np.median(rgb[:128] @ LUMINANCE))
    return analyse(Panorama(rgb.astype(np.float32), "sky"), 0), S @ sky.direct * SCALE / np.pi


def test_a_whole_sun_stays_as_it_is():
    light, true = lit(25.0, haze=0.1)
    found = restored_sun(light.sun, light)
    assert not found.clipped and found.line == "the sun at 25° is as strong as the HDRI shows it"
    np.testing.assert_allclose(found.rgb, light.sun.irradiance, rtol=1e-8)
    np.testing.assert_allclose(S @ found.spectrum, light.sun.irradiance, rtol=1e-8)
    # Pixels of 0.7° spread the disc; what is taken for sky around it is not.
    np.testing.assert_allclose(found.rgb, true, rtol=0.01)


def test_a_balanced_sun_is_unbalanced_and_balanced_again():
    light, _ = lit(25.0, haze=0.1)
    white = np.array([1.2, 1.0, 0.8])
    balanced = replace(light.sun, irradiance=light.sun.irradiance / white)
    found = restored_sun(balanced, light, S, white)
    np.testing.assert_allclose(found.rgb, balanced.irradiance, rtol=1e-8)
    np.testing.assert_allclose(S @ found.spectrum, light.sun.irradiance, rtol=1e-8)
    told = restored_sun(replace(light.sun, irradiance=light.sun.irradiance * [0.5, 1, 2]), light)
    assert "its color is not one of sunlight" in told.line


# Ratio of the estimate to the truth: what 10 to 90 % of likely hazes allow for. By day clear air
# is told by the sky's blue to a fifth; haze of 0.25 is believed to be less, for it mostly is. A
# sun of 6° at a tenth of its light is any sun.
@pytest.mark.parametrize(
    ("elevation", "haze", "low", "high"),
    [
        (45.0, 0.05, 0.8, 1.0),
        (45.0, 0.1, 0.9, 1.1),
        (45.0, 0.25, 1.0, 1.6),
        (12.0, 0.05, 0.8, 1.0),
        (12.0, 0.1, 0.9, 1.1),
        (12.0, 0.25, 1.0, 2.0),
        (5.0, 0.1, 0.7, 1.4),
    ],
)
def test_a_clipped_suns_energy_is_restored(elevation, haze, low, high):
    for level in (300.0, 10000.0):
        light, true = lit(elevation, level, haze=haze)
        seen = light.sun.irradiance @ LUMINANCE / (true @ LUMINANCE)
        found = restored_sun(light.sun, light)
        assert found.clipped and seen < 0.5
        assert low < found.rgb @ LUMINANCE / (true @ LUMINANCE) < high
        np.testing.assert_allclose(S @ found.spectrum, found.rgb, rtol=1e-9)
        # So is the colour, of which the picture kept nothing, as far as the haze is right.
        off = np.abs(found.rgb / found.rgb.sum() - true / true.sum()).max()
        assert off < 0.04
        ratio = found.rgb @ LUMINANCE / (light.sun.irradiance @ LUMINANCE)
        assert f"estimated at {ratio:.3g} times its value" in found.line


def test_who_knows_better_says_so():
    light, _ = lit(45.0, 1000.0, haze=0.1)
    kept = restored_sun(light.sun, light, clipped=False)
    np.testing.assert_allclose(kept.rgb, light.sun.irradiance, rtol=1e-8)
    whole, _ = lit(45.0, haze=0.1)
    guessed = restored_sun(whole.sun, whole, clipped=True)
    # What is seen has come through: the estimate is never less.
    assert guessed.clipped and guessed.rgb @ LUMINANCE > 0.999 * whole.sun.irradiance @ LUMINANCE


@pytest.mark.parametrize("elevation", [-0.9, 0.0, 2.0, 90.0])
@pytest.mark.parametrize("S_in", [S, camera("Nikon 5100")], ids=["observer", "camera"])
@pytest.mark.filterwarnings("error")
def test_suns_that_no_sky_has(elevation, S_in):
    """Deep red, blue, faint and blinding ones, in a blue, a black and a red sky."""
    whole = lit(45.0)[0]
    for rgb in (
        (3.0, 1.0, 0.1),
        (1.0, 0.0, 0.0),
        (0.0, 0.0, 1.0),
        (1e-9, 1e-9, 1e-9),
        (1e6, 9e5, 8e5),
    ):
        for sky in ((0.3, 0.4, 0.7), (0.0, 0.0, 0.0), (1.0, 0.2, 0.0)):
            light = replace(whole, faces=np.tile(sky, (9, 1)))
            for clipped in (False, True):
                sun = replace(whole.sun, elevation=elevation, irradiance=np.array(rgb))
                found = restored_sun(sun, light, S_in, clipped=clipped)
                assert np.isfinite(found.rgb).all() and found.spectrum.min() >= 0.0
                np.testing.assert_allclose(S_in @ found.spectrum, found.rgb, rtol=1e-9)


def test_photographed_suns(shared_data):
    """One sunrise in two HDRIs, the one clipped; veiled suns are weak, not clipped."""
    folder = shared_data / "hdri"
    clipped, whole = (
        analyse(read_panorama(folder / name), 0)
        for name in ("blender_studiolights/sunrise.exr", "polyhaven/sunrise_unclipped_1k.hdr")
    )
    found = restored_sun(clipped.sun, clipped)
    missing, estimate = (
        each @ LUMINANCE / (clipped.sun.irradiance @ LUMINANCE)
        for each in (whole.sun.irradiance, found.rgb)
    )
    # 2.7 times as strong in truth; 1.7 is what is restored: its air is clearer than most.
    assert found.clipped and missing == pytest.approx(2.7, abs=0.1)
    assert 1.4 < estimate < missing
    for name in ("venice_sunset", "wasteland_clouds_puresky", "immenstadter_horn", "rooitou_park"):
        light = analyse(read_panorama(folder / "polyhaven" / f"{name}_1k.hdr"), 0)
        assert not restored_sun(light.sun, light).clipped
