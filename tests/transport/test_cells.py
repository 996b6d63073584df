"""How triangles are cut: as finely as asked for, and never without end."""

import numpy as np
import pytest

from spectral_skylight.addon.transport.cells import Cells, Surfaces, levels_for, pieces


def triangles(sides):
    """Right-angled triangles, each with legs so long."""
    sides = np.asarray(sides, float)
    corners = np.zeros((len(sides), 3, 3))
    corners[:, 1, 0] = corners[:, 2, 1] = sides
    none = np.zeros(len(sides), np.int32)
    return Surfaces(corners, none, none.astype(bool), none)


@pytest.mark.parametrize("small", [10, 1_000, 30_000])
def test_large_triangles_are_cut_beside_however_many_small_ones(small):
    """More small triangles than cells were asked for leave the large ones their own scale."""
    found = levels_for(triangles([5.0, 5.0, *[0.01] * small]), 0.02, 20_000, 0.1)
    assert (found[:2] >= 3).all() and (found[2:] == 0).all()
    assert (4**found).sum() <= max(20_000, small + 2 * 64)


def test_cells_are_as_long_as_asked_for():
    found = levels_for(triangles([1.0, 2.0, 4.0]), 0.5, 1_000_000)
    assert found.tolist() == [1, 2, 3]  # sqrt(2 * area) is the leg


def test_nothing_is_cut_of_nothing():
    assert len(levels_for(triangles([]), 0.1, 100)) == 0


def test_pieces_are_the_same_surfaces_cut_as_often_in_all():
    surfaces = triangles([1.0, 2.0, 40.0])
    levels = np.array([0, 2, 5])
    parts, further, triangle = pieces(surfaces, levels)
    np.testing.assert_array_equal(np.bincount(triangle), [1, 1, 4**3])
    assert further.max() == 2
    np.testing.assert_array_equal(further, np.minimum(levels, 2)[triangle])
    whole, cut = Cells.of(surfaces, levels), Cells.of(parts, further)
    assert len(cut) == len(whole)
    np.testing.assert_allclose(np.sort(cut.areas), np.sort(whole.areas), rtol=1e-4)
    np.testing.assert_array_equal(parts.kind, surfaces.kind[triangle])
