"""Our skies of weather beside Radiance's `gendaylit` (Perez) and `gensky` (CIE)."""

import numpy as np
import pytest

from spectral_skylight.addon.sky.all_weather import all_weather_sky
from spectral_skylight.addon.sky.cie_skies import cie_luminance
from spectral_skylight.addon.sky.mixed_sky import PHOTOPIC
from spectral_skylight.addon.sky.simulation import Quality, simulate
from spectral_skylight.tests.peers.peer import MISSING, PYTHON, ask

pytestmark = [
    pytest.mark.peers,
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON.exists(), reason=MISSING),
]

ELEVATION, AZIMUTH = (
    each.ravel()
    for each in np.meshgrid(np.radians([15, 30, 50, 70, 85]), np.radians(np.arange(0, 360, 20)))
)
"""[rad] where skies are compared; azimuths from the sun. Radiance blends sky and ground below."""

HOURS = {
    "overcast": (35.0, 0.0, 150.0),
    "dull": (25.0, 50.0, 150.0),
    "cloudy": (35.0, 150.0, 250.0),
    "mixed": (40.0, 300.0, 200.0),
    "bright": (60.0, 400.0, 350.0),
    "hazy": (55.0, 700.0, 120.0),
    "clear": (50.0, 850.0, 80.0),
}
"""The sun's elevation [degrees], direct and diffuse irradiance [W/m²], from bin to bin."""


def theirs(*skies):
    """Luminance [cd/m²] of skies, each a program and its arguments, (skies, m)."""
    # Radiance's azimuths are from the south, and so is its sun here.
    directions = [
        np.cos(ELEVATION) * np.sin(AZIMUTH),
        -np.cos(ELEVATION) * np.cos(AZIMUTH),
        np.sin(ELEVATION),
    ]
    request = {"skies": skies, "directions": np.transpose(directions).tolist()}
    return ask("radiance_weather.py", request)["luminance"]


@pytest.mark.parametrize("hour", HOURS)
def test_perez_is_gendaylits(hour):
    elevation, direct, diffuse = HOURS[hour]
    command = ["gendaylit", "-ang", elevation, 0, "-W", direct, diffuse]
    clear = simulate(elevation, quality=Quality(once=(24, 9), more=(8, 5), ways=64, shells=20))
    sky = all_weather_sky(clear, direct, diffuse)
    ours = sky.radiance(ELEVATION, AZIMUTH) @ PHOTOPIC
    beside = ours / theirs(command)[0]
    # Its solar constant is another day's: 1.5 % in Δ, which moves coefficients and efficacy.
    np.testing.assert_allclose(beside, 1.0, rtol=0.06)
    assert beside.mean() == pytest.approx(1.0, abs=0.03)


def relative(luminance):
    return luminance / luminance.mean()


def test_the_clear_sky_of_the_cie_is_genskys():
    """Kittler's of 1973, which became the twelfth."""
    ours = cie_luminance(12, 40.0, ELEVATION, AZIMUTH)
    found = theirs(["gensky", "-ang", 40, 0, "-s"])[0]
    # At 15° a part in 120 of Radiance's is ground.
    np.testing.assert_allclose(relative(ours), relative(found), rtol=0.01)
