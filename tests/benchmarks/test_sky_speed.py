"""What a 4k sky costs. Figures, no limits: the target is under 1 s from pixels to coefficients."""

import numpy as np
import pytest

from spectral_skylight.addon.sky.irradiance import exact_irradiance, fit_coefficients
from spectral_skylight.addon.sky.lat_long import directions
from spectral_skylight.addon.sky.panorama import from_pixels, read_panorama, write_panorama
from spectral_skylight.addon.sky.sun import separate_sun


@pytest.fixture(scope="module")
def sky():
    """4096 x 2048: a gradient, noise, a sun."""
    z = directions(2048, 4096)[..., 2:]
    rng = np.random.default_rng(1)
    pixels = (1.0 + z) * [0.4, 0.5, 0.8] * rng.uniform(0.5, 1.5, z.shape)
    pixels[700:706, 1000:1007] = 5e4
    return pixels.astype(np.float32)


def test_4k_to_coefficients(benchmark, sky):
    """Everything after decoding: checks, the sun set apart, seven fits and their errors."""

    def run():
        apart, sun = separate_sun(from_pixels(sky, "sky").rgb)
        return sun, fit_coefficients(apart)

    sun, fit = benchmark.pedantic(run, rounds=5, warmup_rounds=1)
    assert sun is not None
    assert len(fit.errors) == 7


def test_4k_separate_sun(benchmark, sky):
    assert benchmark.pedantic(separate_sun, (sky,), rounds=5, warmup_rounds=1)[1] is not None


def test_4k_exact_irradiance_of_1000_normals(benchmark, sky):
    normals = np.random.default_rng(2).normal(size=(1000, 3))
    values = benchmark.pedantic(exact_irradiance, (sky, normals), rounds=5, warmup_rounds=1)
    assert values.shape == (1000, 3)


def test_4k_read_exr(benchmark, sky, tmp_path):
    write_panorama(tmp_path / "sky.exr", sky)
    read = benchmark.pedantic(read_panorama, (tmp_path / "sky.exr",), rounds=3)
    assert read.rgb.shape == sky.shape


def test_1k_read_hdr(benchmark, shared_data):
    path = shared_data / "hdri/polyhaven/immenstadter_horn_1k.hdr"
    assert benchmark(read_panorama, path).rgb.shape == (512, 1024, 3)
