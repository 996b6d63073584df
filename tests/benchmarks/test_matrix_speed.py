"""Figures, not verdicts: ``pytest tests/benchmarks --benchmark-enable``.

Asked for once the tables are loaded: 24 matrices in 1 ms, 10,000 in 100 ms.
"""

import numpy as np
import pytest

from spectral_skylight.addon.transfer.known_light import KnownLight
from spectral_skylight.addon.transfer.matrices import transfer
from spectral_skylight.addon.transfer.prediction import predict

RNG = np.random.default_rng(0)


@pytest.mark.parametrize("count", [24, 10_000])
def test_matrices(benchmark, count):
    reflectances = RNG.uniform(0, 1, (count, 81))
    mapping = transfer()
    mapping.matrices(reflectances[:1])  # loads the tables
    assert benchmark(mapping.matrices, reflectances).shape == (count, 3, 3)


def test_transfer(benchmark):
    transfer()
    benchmark(transfer)


def test_prediction(benchmark):
    mapping, lights = transfer(), RNG.uniform(0.1, 1, (9, 3))
    benchmark(predict, mapping, RNG.uniform(0, 1, (24, 81)), KnownLight(lights))
