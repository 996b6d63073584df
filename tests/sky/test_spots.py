import numpy as np
import pytest
from scipy.ndimage import label

from spectral_skylight.addon.sky.spots import spots

ALL_AROUND = np.ones((3, 3), int)


def same_parts(one, other):
    """Whether two numberings of the same pixels tell the same ones apart."""
    pairs = len(set(zip(one.tolist(), other.tolist(), strict=True)))
    return pairs == len(set(one.tolist())) == len(set(other.tolist()))


@pytest.mark.parametrize("share", [0.02, 0.2, 0.4, 0.6, 0.95])
def test_the_same_spots_as_scipy_s(share):
    rng = np.random.default_rng(int(100 * share))
    for _ in range(100):
        height, width = rng.integers(3, 40, 2)
        mask = rng.random((height, width)) < share
        mask[:, -1] = False  # nothing meets over the seam, which scipy does not know
        theirs = label(mask, ALL_AROUND)[0][mask]
        found = spots(mask)
        assert same_parts(found, theirs)
        assert found.max(initial=-1) == theirs.max(initial=0) - 1


def test_the_seam_joins():
    """Turned about the zenith a panorama has the same spots."""
    rng = np.random.default_rng(7)
    for turn in range(1, 30):
        mask = rng.random((20, 30)) < 0.3
        number = np.full(mask.shape, -1)
        number[mask] = spots(mask)
        assert same_parts(np.roll(number, turn, axis=1)[np.roll(mask, turn, axis=1)],
                          spots(np.roll(mask, turn, axis=1)))  # fmt: skip
    corner = np.zeros((4, 8), bool)
    corner[1, 0] = corner[2, 7] = True
    assert spots(corner).tolist() == [0, 0]


def test_long_ways_are_one_spot():
    snake = np.zeros((121, 122), bool)
    snake[::4, :-1] = True
    for k, row in enumerate(range(0, 118, 4)):
        snake[row : row + 5, 120 if k % 2 == 0 else 0] = True
    snake[:, -1] = False
    assert not spots(snake).any()


def test_no_pixel_no_spot():
    assert spots(np.zeros((4, 8), bool)).shape == (0,)
