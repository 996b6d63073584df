import numpy as np
import pytest

from spectral_skylight.addon.spectra.sorting import distinct, median


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("count", [1, 2, 3, 10, 1001])
def test_medians_are_numpy_s_to_the_last_bit(count, dtype):
    values = np.random.default_rng(count).random((count, 3)).astype(dtype)
    np.testing.assert_array_equal(median(values), np.median(values, axis=0))
    np.testing.assert_array_equal(median(values[:, 0]), np.median(values[:, 0]))
    assert median(values).dtype == dtype


@pytest.mark.parametrize("count", [0, 1, 2, 1000])
def test_distinct_values_are_numpy_s(count):
    values = np.random.default_rng(count).integers(-50, 50, count) / 4
    for ours, theirs in zip(
        distinct(values), np.unique(values, return_index=True, return_inverse=True), strict=True
    ):
        np.testing.assert_array_equal(ours, theirs)
