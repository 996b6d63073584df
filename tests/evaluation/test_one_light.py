"""Light of one spectrum: who knows it is right, who takes it for a sky's is not."""

import numpy as np
import pytest

from spectral_skylight.addon.evaluation.evaluation import errors_of
from spectral_skylight.addon.evaluation.methods import Sky
from spectral_skylight.addon.evaluation.one_light import GLASSES, GROUNDS, LAMPS, cases, ways
from spectral_skylight.addon.sky.atmosphere import Atmosphere
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.sensitivities import observer

QUALITY = Quality(once=(24, 13), more=(12, 9), ways=128, shells=30)
RHO = colorchecker()[1]
TODAY = "RGB × RGB in Rec.709"


@pytest.fixture(scope="module")
def skies():
    """Skies and their suns on level ground: clear and hazy, high and low, and one without a sun."""
    result = []
    for elevation, haze in ((40.0, 0.05), (5.0, 0.05), (5.0, 0.3), (-3.0, 0.05)):
        sky = simulate(elevation, Atmosphere(haze=haze), quality=QUALITY, cached=False)
        sun = sky.direct * max(np.sin(np.radians(elevation)), 0.0)
        result.append((Sky(sky.irradiance()[None], elevation), sun))
    return result


@pytest.fixture(scope="module")
def left(skies):
    """Mean CIEDE2000 (lights,) by kind and way."""
    return {
        kind: {
            name: each.delta_E.mean(axis=1)
            for name, each in zip(
                ways(kind), errors_of(ways(kind).values(), some, RHO), strict=True
            )
        }
        for kind, some in cases(skies).items()
    }


def test_cases(skies):
    found = cases(skies)
    count = {"sun": 3, "ground": 4 * len(GROUNDS), "glass": 4 * len(GLASSES), "lamp": 4}
    assert {kind: len(some) for kind, some in found.items()} == count
    for some in found.values():
        for one in some:
            Y = observer() @ one.lights[0] @ [0.2126, 0.7152, 0.0722]
            assert one.lights.shape == (1, 81) and Y == pytest.approx(1.0)
    assert list(cases(skies[-1:])) == ["ground", "glass", "lamp"]


def test_the_sun_known_by_colour_and_place_is_known(left):
    sun = left["sun"]
    # A red sun is at the edge of Rec.709, where products of RGB mean little.
    assert sun[TODAY].min() > 0.6 and sun[TODAY].max() > 5.0
    ours = sun["prefiltered, colour + place known"]
    assert ours.max() < 0.3
    assert (ours < 0.5 * sun["as skylight"]).all()


def test_a_known_ground_is_known_and_a_colour_tells_little(left):
    ground = left["ground"]
    known, colour = (ground[f"prefiltered, {s} known"] for s in ("ground", "its colour"))
    # What is left is what the sky's and the sun's RGB leave of their spectra, most at dusk.
    assert known.mean() < 0.15 < 0.4 < colour.mean()
    assert colour.mean() < 0.7 * ground["as skylight"].mean() < 0.4 * ground[TODAY].mean()


def test_glass_known_is_known(left):
    """Pale as it is, its matrix is worth knowing."""
    glass = left["glass"]
    known = glass["prefiltered, glass known"]
    assert known.mean() < 0.15 and known.mean() < 0.5 * glass["as skylight"].mean()
    assert glass["as skylight"].mean() < 0.5 * glass[TODAY].mean()


def test_a_lamp_known_by_its_spectrum_is_exact(left):
    lamp = left["lamp"]
    np.testing.assert_allclose(lamp["prefiltered, spectrum known"], 0.0, atol=1e-5)
    by_colour = dict(zip(LAMPS, lamp["prefiltered, its colour known"], strict=True))
    # A bulb is a black body; lines and bands no colour tells.
    assert by_colour["A"] < 0.05 and by_colour["FL11"] > 1.0
    assert by_colour["HP1"] < 0.5 * lamp[TODAY][LAMPS.index("HP1")]
