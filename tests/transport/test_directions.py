"""Rays as dense as the cosine, and cells that hold a panorama."""

import numpy as np

from spectral_skylight.addon.sky.irradiance import exact_irradiance
from spectral_skylight.addon.transport import directions

NORMALS = np.random.default_rng(0).standard_normal((20, 3))
NORMALS /= np.linalg.norm(NORMALS, axis=1, keepdims=True)


def test_a_pattern_has_the_cosines_moments():
    """Mean of the normal's component 2/3, of its square 1/2, of the sides' 1/4."""
    whole = directions.pattern(1024)
    for ways in (whole, directions.pattern(256)):
        np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1.0, rtol=1e-5)
        np.testing.assert_allclose((ways**2).mean(axis=0), [0.25, 0.25, 0.5], atol=0.01)
        np.testing.assert_allclose(ways.mean(axis=0), [0.0, 0.0, 2.0 / 3.0], atol=0.01)
    ways = directions.about(NORMALS, whole)
    np.testing.assert_allclose(
        np.einsum("nrk,nk->nr", ways, NORMALS), np.broadcast_to(whole[:, 2], (20, 1024)), atol=1e-4
    )


def test_cells_cover_the_sphere_and_keep_its_halves():
    ways, solid = directions.centres()
    np.testing.assert_array_equal(directions.cells(ways.astype(np.float32)), np.arange(len(ways)))
    assert np.isclose(solid.sum(), 4.0 * np.pi)
    np.testing.assert_allclose(solid @ ways, 0.0, atol=1e-6)
    assert (directions.cells(np.array([[0.6, 0.8, -1e-6]], np.float32)) >= len(ways) // 2).all()


def test_a_panorama_lights_open_faces_through_cells_as_by_its_pixels():
    """Within 0.5 % of the exact irradiance, also turned; of pixels finer and coarser than cells."""
    rng = np.random.default_rng(1)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.linalg.det(turn)
    for height in (32, 256):
        rows = np.linspace(2.0, 0.5, height)[:, None, None]
        columns = 1.0 + 0.5 * np.sin(np.linspace(0.0, 2.0 * np.pi, 2 * height))[None, :, None]
        panorama = (rows * columns * [0.4, 0.7, 1.0]).astype(np.float32)
        cells = directions.sphere(panorama, turn)
        seen = directions.open_light(cells, NORMALS)
        exact = exact_irradiance(panorama, NORMALS @ turn.T)
        np.testing.assert_allclose(seen, exact, rtol=5e-3)
