"""Light that is no clear sky by day."""

import numpy as np
import pytest

from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.light import FACES, analyse
from spectral_skylight.addon.sky.panorama import from_pixels
from spectral_skylight.addon.sky.sky_classification import FOREIGN, outside
from spectral_skylight.addon.spectra.daylight_locus import LIMIT, locus_distance
from spectral_skylight.addon.spectra.grid import WAVELENGTHS
from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.measures import delta_E
from spectral_skylight.addon.transfer.prediction import predict
from spectral_skylight.tests.stability.lights import (
    CHECKER,
    LEAVES,
    S,
    bright,
    daylight,
    errors,
    sky,
    skylight,
    source,
    true,
)

UP, NORTH = 0, 5  # of FACES


def atmosphere(light, elevation):
    return transfer("atmosphere", sun_elevation=elevation, sky_rgb=S @ light)


def panorama(upper, band, lower):
    """Spectra of an HDRI in three even parts, the middle one up to 15°, as pixels and irradiances.

    Returns the picture (64, 128, 3) and the spectra (9, 81) that fall on FACES.
    """
    z = directions(64, 128)[..., 2]
    parts = np.stack([z > np.sin(np.radians(15)), (z > 0) & (z <= np.sin(np.radians(15))), z <= 0])
    spectra = np.stack([upper, band, lower])
    seen = exact_irradiance(np.moveaxis(parts.astype(float), 0, -1), FACES)  # (9, 3 parts)
    return np.einsum("phw,pc->hwc", parts, spectra @ S.T), seen @ spectra


def test_the_sun_under_the_horizon(keep):
    """Ozone takes the orange out of twilight; no power of the wavelength does."""
    for elevation, paper_over, ours_under in ((-5.0, 1.2, 0.35), (0.0, 0.6, 0.25)):
        light = skylight(elevation)
        paper, ours = errors(light).mean(), errors(light, atmosphere(light, elevation)).mean()
        assert paper > paper_over and ours < ours_under
        keep(
            f"sun at {elevation:g}°",
            f"ΔE {paper:.1f} with `rayleigh`, {ours:.1f} with `atmosphere` and its elevation, "
            f"{errors(light, 'rgb').mean():.1f} with RGB × RGB",
            "`--sun-elevation` where the HDRI shows no sun; under -6° the basis of -6°",
        )
    light = skylight(-5.0)
    deep, end = atmosphere(light, -12.0), atmosphere(light, -6.0)
    # But for the lean towards the paper's basis, which fades out as the sun sinks.
    np.testing.assert_allclose(deep.restoration, end.restoration, rtol=1e-4, atol=1e-5)


def test_a_twilight_whose_sun_nobody_tells(keep):
    """By day thin ozone makes a sky as blue: no colour tells that the sun is under the horizon."""
    light = skylight(-5.0)
    mapping = transfer("atmosphere", sky_rgb=S @ light)
    off, paper = errors(light, mapping).mean(), errors(light).mean()
    assert 1.0 < off < paper
    assert locus_distance(S @ light, sun_elevation=40.0) < LIMIT
    panorama = from_pixels(np.broadcast_to(S @ light, (16, 32, 3)).astype("f4"), "sky")
    assert any(
        "If the sun is low, set its elevation" in note for note in analyse(panorama, 1).notes
    )
    keep(
        "sun at -5°, not in the HDRI and not set",
        f"ΔE {off:.1f}; set {errors(light, atmosphere(light, -5.0)).mean():.2f}",
        "says that daytime is assumed, and to set the elevation of a low sun",
    )


def test_overcast(keep):
    """A grey cloud between sky and ground changes little of the spectrum's shape."""
    light = bright(daylight(40.0) / (1.0 - 0.6 * 0.2))
    assert errors(light).mean() < 0.25 and locus_distance(S @ light) < LIMIT
    keep("overcast", f"ΔE {errors(light).mean():.2f}", "nothing to do")


def test_smoke_and_dust(keep):
    """Haze that absorbs blue. Thick, it has a low sun's colour: only a higher sun gives it away."""
    dust = np.interp(WAVELENGTHS, [380, 500, 600, 780], [0.55, 0.75, 0.88, 0.94])  # iron oxide
    dusty = bright(skylight(30.0, haze=1.5, angstrom=0.1) * dust)
    assert errors(dusty).mean() < 0.3
    keep("desert dust, optical depth 1.5", f"ΔE {errors(dusty).mean():.1f}", "nothing to do")
    light = skylight(30.0, haze=4.0, angstrom=2.0, haze_albedo=0.75)
    paper, today = errors(light).mean(), errors(light, "rgb").mean()
    assert 0.4 < paper < 0.4 * today
    assert locus_distance(S @ light) < LIMIT < locus_distance(S @ light, sun_elevation=30.0)
    assert not predict(transfer(), CHECKER, KnownLight(S @ light)).unknown
    assert (
        "not a color of skylight"
        in predict(transfer(), CHECKER, KnownLight(S @ light, 30.0)).unknown
    )
    keep(
        "wildfire smoke, optical depth 4, sun at 30°",
        f"ΔE {paper:.1f}, {today:.1f} with RGB × RGB",
        "outside the colours of skies once the sun's elevation is known: the error is `unknown`",
    )


@pytest.mark.parametrize(
    ("lamp", "name", "part", "over"),
    [("HPS", "sodium", 0.2, 0.4), ("LED-B1", "warm LED", 0.4, 0.4)],
)
def test_a_city_in_the_twilight(keep, lamp, name, part, over):
    """Lamps' glow up to 15° over the horizon; it lights upright faces most.

    The glow itself is foreign wherever it outshines the sky; on a face its colour drowns.
    """
    twilight = skylight(-4.0)
    glow = bright((1.0 - part) * twilight + part * source(lamp)) * 2.0
    rgb, light = panorama(twilight, glow, 0.1 * twilight)
    mapping = atmosphere(twilight, -4.0)
    clean = errors(twilight, mapping).mean()
    off = errors(bright(light[NORTH]), mapping).mean()
    assert off > clean + over
    found = outside(rgb, None, FACES)
    strong = outside(panorama(twilight, 2.0 * source(lamp), 0.1 * twilight)[0], None, FACES)
    assert strong.shares[NORTH, FOREIGN] > 0.4 and "outside the model" in strong.verdict
    keep(
        f"a city's {name} light, {100 * part:.0f} % of the glow to 15° over the horizon",
        f"ΔE {off:.1f} on upright faces where the sky alone has {clean:.1f}",
        "the map counts lamps as foreign where their colour shows: here "
        f"{100 * found.shares[NORTH, FOREIGN]:.0f} % of the face's light",
    )


def test_white_lamps_cannot_be_seen(keep):
    """A lamp made to look like daylight does: no colour gives it away, and it is off."""
    light = bright(0.5 * skylight(-4.0) + 0.5 * source("LED-B5"))
    mapping = atmosphere(light, -4.0)
    off = errors(light, mapping).mean()
    promised = predict(mapping, CHECKER, KnownLight(S @ light, -4.0)).matrix.mean()
    assert off > 0.8 and locus_distance(S @ light) < LIMIT
    assert promised < 0.5 * off  # so it is: keep it until someone finds a sign
    keep(
        "half twilight, half LED of 6500 K",
        f"ΔE {off:.1f}, predicted {promised:.1f}",
        "nothing: its colour is a sky's (silent)",
    )


def test_leaves_and_walls(keep):
    """Three numbers of light off a leaf are no three numbers of a sky: today's way does better."""
    day = daylight(40.0)
    off_leaves = bright(day * LEAVES)
    paper, today = errors(off_leaves).mean(), errors(off_leaves, "rgb").mean()
    assert paper > today > 1.0
    mostly = outside(panorama(skylight(40.0), off_leaves, 5 * off_leaves)[0], None, FACES[5:])
    assert mostly.mostly
    assert predict(transfer(), CHECKER, KnownLight(S @ off_leaves)).unknown
    keep(
        "nothing but light off leaves",
        f"ΔE {paper:.1f}, {today:.1f} with RGB × RGB",
        "says: mostly outside the model of skylight; the error is `unknown`",
    )
    rgb, light = panorama(skylight(40.0), skylight(40.0), 0.5 * off_leaves)
    found = outside(rgb, None, FACES)
    upright = bright(light[NORTH])
    assert errors(light[UP]).mean() < 0.3 < 0.6 < errors(upright).mean()
    promised = predict(transfer(), CHECKER, KnownLight(S @ upright, 40.0)).matrix.mean()
    assert found.shares[NORTH, FOREIGN] > 0.25 and found.shares[UP, FOREIGN] < 0.01
    keep(
        "a meadow in the lower half",
        f"ΔE {errors(upright).mean():.1f} on upright faces ({errors(upright, 'rgb').mean():.1f} "
        f"with RGB × RGB), predicted {promised:.1f}; {errors(light[UP]).mean():.1f} on level ones",
        f"says: partly outside, {100 * found.shares[NORTH, FOREIGN]:.0f} % of upright faces' light",
    )


def test_two_illuminants_across_one_facade(keep):
    """Sun on one end, sky on the other, any mixture between: no matrix changes over the wall.

    Colours are linear in light, and so is a matrix, so its error of a mixture is the mixture of its
    errors: by the triangle inequality it never passes the larger one. RGB × RGB keeps that too; it
    is off at both ends, each end its own way, so that one paint looks like two.
    """
    found = sky(20.0)
    ends = np.stack([found.irradiance(), found.direct * 0.5])
    mixture = np.linspace(0.0, 1.0, 11)[:, None]
    lights = (1.0 - mixture) * ends[0] + mixture * ends[1]
    mapping = atmosphere(bright(lights[5]), 20.0)
    estimate = np.einsum("mij,kj->kmi", mapping.matrices(CHECKER), lights @ S.T)
    off = np.linalg.norm(estimate - true(lights), axis=-1)
    allowed = (1.0 - mixture) * off[0] + mixture * off[-1]
    assert (off <= allowed * (1 + 1e-9) + 1e-12 * lights.max()).all()  # float64 rounding
    ours, today = errors(bright(lights), mapping), errors(bright(lights), "rgb")
    assert ours.mean(axis=1).max() < 0.5 < today.mean(axis=1).max()
    keep(
        "sun on one end of a wall, blue sky on the other",
        f"ΔE at most {ours.mean(axis=1).max():.2f} along it, "
        f"{today.mean(axis=1).max():.1f} with RGB × RGB",
        "nothing to do: an error of a mixture is the mixture of errors",
    )


@pytest.mark.parametrize(("elevation", "dips"), [(40.0, False), (0.0, False), (-5.0, True)])
def test_restored_spectra_that_go_negative(keep, elevation, dips):
    """Where on the dome a pixel's spectrum dips under zero, and what its colour makes of that.

    The three numbers are kept, so what is too little at one wavelength is too much at another:
    to cut the dips off is to change the numbers, and is no cure.
    """
    dome = picture(sky(elevation), 32)[:16].reshape(-1, WAVELENGTHS.size)
    dome = bright(dome.astype(float))
    seen = (WAVELENGTHS >= 400) & (WAVELENGTHS <= 700)

    def restored(mapping):
        spectra = dome @ S.T @ mapping.restoration.T
        return spectra, np.maximum(-spectra[:, seen].min(axis=1) / spectra.max(axis=1), 0.0)

    spectra, depth = restored(transfer())
    under = depth > 0.0
    assert under.any() == dips
    if not dips:
        return
    height = 90.0 - (np.flatnonzero(under.reshape(16, 64).any(axis=1)) + 0.5) * 90.0 / 16
    off = errors(dome).mean(axis=1)
    cut = delta_E(true(np.maximum(spectra, 0.0)), true(dome), (dome @ S.T)[:, None]).mean(axis=1)
    assert cut[under].mean() > 0.9 * off[under].mean()
    ours = restored(atmosphere(dome.mean(axis=0), elevation))[1]
    assert ours.max() < depth.max()
    keep(
        f"restored spectra under zero, `rayleigh`, sun at {elevation:g}°",
        f"{100 * under.mean():.0f} % of the dome, {height[-1]:.0f}° to {height[0]:.0f}° high, down "
        f"to {100 * depth.max():.0f} % of the peak; ΔE there {off[under].mean():.1f}",
        f"nothing: cut off at zero it would be {cut[under].mean():.1f}; `atmosphere` dips on "
        f"{100 * np.mean(ours > 0):.0f} % of the dome, to {100 * ours.max():.0f} %",
    )
