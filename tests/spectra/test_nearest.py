import numpy as np
import pytest
from scipy.spatial import cKDTree

from spectral_skylight.addon.spectra.nearest import are_farther, second_nearest


def cloud(count, rng):
    """Points along a curve, as the chromaticities of daylight lie, and some apart."""
    t = rng.random(count)
    points = np.stack([0.15 + 0.1 * t, 0.4 + 0.1 * t**2], axis=1)
    return points + rng.normal(0.0, 0.004, points.shape)


@pytest.mark.parametrize("count", [2, 3, 50, 5000])
def test_the_second_nearest_is_a_tree_s(count):
    rng = np.random.default_rng(count)
    points = cloud(count, rng)
    places = np.concatenate([cloud(1000, rng), rng.uniform(-1, 1, (100, 2)), points[:100]])
    theirs = cKDTree(points).query(places, k=[2])[0][:, 0]
    np.testing.assert_allclose(second_nearest(places, points), theirs, rtol=0, atol=1e-14)


@pytest.mark.parametrize("limit", [1e-4, 0.006, 0.05, 2.0])
def test_farther_is_farther(limit):
    """Squares answer for their places as each place's own distance does, at any limit."""
    rng = np.random.default_rng(1)
    points = cloud(3000, rng)
    places = np.concatenate(
        [
            cloud(20_000, rng),
            points[:500] + limit * rng.normal(0.0, 1.0, (500, 2)),
            [[1e9, 1e30], [-1e300, 1.0], [0.0, 0.0], [-0.2, 0.5]],  # u'v' of no colour at all
        ]
    )
    theirs = cKDTree(points).query(places, k=[2])[0][:, 0] > limit
    assert 0 < theirs.sum() < len(theirs)
    np.testing.assert_array_equal(are_farther(places, points, limit), theirs)


def test_one_point_or_no_place():
    one, none = np.zeros((1, 2)), np.empty((0, 2))
    assert np.isinf(second_nearest(np.ones((3, 2)), one)).all()
    assert are_farther(np.ones((3, 2)), one, 1.0).all()
    assert second_nearest(none, one).shape == are_farther(none, one, 1.0).shape == (0,)
