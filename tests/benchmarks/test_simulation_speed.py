"""What a simulated sky costs. Figures, no limits: the targets are under 2 s and under 2 minutes."""

import os

import numpy as np
import pytest

from spectral_skylight.addon.sky.atmosphere import Atmosphere, medium
from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.phase_functions import haze_phase, rayleigh_phase
from spectral_skylight.addon.sky.scattering import direction, scattered_once
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.sunlight import extraterrestrial_sunlight


def single_scattering(sun_elevation, directions, atmosphere=None, sun_azimuth=180.0):
    """Return the radiance that sunlight scattered once brings from directions of the sky, (m, 81).

    [W m^-2 sr^-1 nm^-1]. ``directions`` (m, 3): unit vectors above the horizon, z up and y north;
    elevations and azimuth [degrees], the azimuth clockwise from north.
    """
    matter = medium(atmosphere or Atmosphere())
    sun = direction(np.radians(sun_elevation), np.radians(90.0 - sun_azimuth))
    air, haze = scattered_once(matter, sun, directions)
    cosine = directions @ sun
    scattered = rayleigh_phase(cosine)[:, None] * air
    scattered += haze_phase(cosine, matter.asymmetry)[:, None] * haze
    return scattered * extraterrestrial_sunlight()


def test_400_directions_scattered_once(benchmark):
    views = direction(*np.radians(np.meshgrid(np.linspace(1, 89, 20), np.linspace(0, 180, 20))))
    assert benchmark(single_scattering, 20.0, views.reshape(-1, 3)).shape == (400, 81)


def test_preview(benchmark):
    settings = {"quality": "preview", "cached": False}
    benchmark.pedantic(simulate, (20.0,), settings, rounds=3, warmup_rounds=1)


def test_reference(benchmark):
    if not benchmark.enabled:
        pytest.skip("a minute that only counts when it is measured")
    settings = {"quality": "reference", "cached": False}
    sky = benchmark.pedantic(simulate, (20.0,), settings, rounds=1)
    error = float((sky.irradiance_error() / sky.irradiance()).max())
    benchmark.extra_info.update(standard_error=error, processors=os.cpu_count())
    assert error < 0.005


def test_picture_of_1k(benchmark):
    sky = simulate(20.0)
    assert benchmark.pedantic(picture, (sky, 256), rounds=3).shape == (256, 512, 81)
