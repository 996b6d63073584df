"""What a simulated sky costs. Figures, no limits: the targets are under 2 s and under 2 minutes."""

import os

import numpy as np
import pytest

from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.scattering import direction, single_scattering
from spectral_skylight.addon.sky.simulation import simulate


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
