"""The checker in full spectrum, without Blender and without the add-on's matrices.

Its spheres have no neighbours, so no light bounces. For every pixel: which surface, its normal, the
spectral irradiance of every pixel of the spectral sky on it (a plain sum, no polynomial), times the
reflectance, seen by the standard observer.
"""

from collections.abc import Iterator

import colour
import numpy as np
from geometry import (
    BUILDING_CAMERA,
    CHECKER_CAMERA,
    SPHERE_RADIUS,
    Camera,
    building,
    sphere_centres,
)
from scipy.ndimage import binary_erosion

OVERSAMPLING = 4
"""Rays to a pixel, each way: edges are as smooth as Blender's."""

WAVELENGTHS = np.arange(380.0, 785.0, 5.0)


def observer() -> np.ndarray:
    """Return spectrum to linear Rec.709, (3, 81), in units of 10,000 cd/m² at white."""
    shape = colour.SpectralShape(380, 780, 5)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    weights = np.full(WAVELENGTHS.size, 5.0)
    weights[[0, -1]] = 2.5
    to_RGB = np.linalg.inv(colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_RGB_to_XYZ)
    return to_RGB @ (cmfs.values.T * weights) * 683.002 / 1e4


def sky_directions(height: int) -> tuple[np.ndarray, np.ndarray]:
    """Return directions (h, 2h, 3) and solid angles (h, 2h) of a lat-long sky's pixels."""
    elevation = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    azimuth = 2 * np.pi * (0.5 - (np.arange(2 * height) + 0.5) / (2 * height))
    theta, phi = np.meshgrid(elevation, azimuth, indexing="ij")
    directions = np.stack(
        [np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi), np.sin(theta)], axis=-1
    )
    return directions, np.cos(theta) * (np.pi / height) ** 2


def irradiance(sky: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the irradiance/π (m, 81) of a spectral sky (h, 2h, 81) on faces (m, 3)."""
    directions, solid = sky_directions(sky.shape[0])
    light = (sky * solid[..., None]).reshape(-1, sky.shape[-1]).astype(np.float32) / np.pi
    directions = directions.reshape(-1, 3).astype(np.float32)
    result = np.empty((len(normals), sky.shape[-1]))
    for start in range(0, len(normals), 128):
        cosine = normals[start : start + 128].astype(np.float32) @ directions.T
        result[start : start + 128] = np.maximum(cosine, 0.0) @ light
    return result


def checker_normals(camera: Camera = CHECKER_CAMERA) -> tuple[np.ndarray, np.ndarray]:
    """Return for every ray the sphere it meets, -1 for none, and the normal there."""
    origins, directions = camera.rays(OVERSAMPLING)
    surface = np.full(origins.shape[:2], -1)
    normals = np.zeros(origins.shape)
    for k, centre in enumerate(sphere_centres()):
        offset = origins - centre
        along = -np.einsum("hwc,hwc->hw", offset, directions)
        square = np.einsum("hwc,hwc->hw", offset, offset) - along**2
        hit = square < SPHERE_RADIUS**2
        distance = along[hit] - np.sqrt(SPHERE_RADIUS**2 - square[hit])
        surface[hit] = k
        normals[hit] = (offset[hit] + distance[:, None] * directions[hit]) / SPHERE_RADIUS
    return surface, normals


def building_faces(camera: Camera = BUILDING_CAMERA) -> np.ndarray:
    """Return for every ray the face of `building` that it meets, counted on, -1 for none."""
    origins, directions = camera.rays(OVERSAMPLING)
    nearest = np.full(origins.shape[:2], np.inf)
    face = np.full(origins.shape[:2], -1)
    for k, (a, b, c) in _triangles():
        normal = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (a @ normal - origins @ normal) / (directions @ normal)
            hit = (distance > 0) & (distance < nearest)
            for p, q in ((a, b), (b, c), (c, a)):
                inwards = np.cross(normal, q - p)
                along = origins @ inwards + distance * (directions @ inwards)
                hit &= along - p @ inwards >= -1e-9
        nearest[hit] = distance[hit]
        face[hit] = k
    return face


def _triangles() -> Iterator[tuple[int, np.ndarray]]:
    polygons = [polygon for part in building().values() for polygon in part]
    for k, polygon in enumerate(polygons):
        corners = np.array(polygon, dtype=float)
        for i in range(1, len(corners) - 1):
            yield k, corners[[0, i, i + 1]]


def picture(
    sky: np.ndarray,
    surface: np.ndarray,
    normals: np.ndarray,
    reflectances: np.ndarray,
    camera: Camera = CHECKER_CAMERA,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the picture (h, w, 3) in linear Rec.709, and that of white surfaces instead.

    ``surface``, ``normals``: of every ray; ``reflectances`` (m, 81) of the surfaces.
    """
    S = observer()
    open_sky = _background(sky @ S.T, camera)
    coverage = pixel_means(surface < 0)[..., None]
    image, white = coverage * open_sky, coverage * open_sky
    for k, reflectance in enumerate(reflectances):
        mine = surface == k
        coverage = pixel_means(mine)
        shown = coverage > 0
        mean_normals = (_by_pixels(normals)[shown] * _by_pixels(mine)[shown][..., None]).mean(
            axis=(1, 2)
        )
        mean_normals /= np.linalg.norm(mean_normals, axis=-1, keepdims=True)
        E = _irradiance_once(sky, mean_normals)
        image[shown] += coverage[shown][:, None] * ((E * reflectance) @ S.T)
        white[shown] += coverage[shown][:, None] * (E @ S.T)
    return image, white


def well_inside(surface: np.ndarray) -> np.ndarray:
    """Return the pixels (h, w) a pixel inside a surface, for Blender's filter reaches as far."""
    shown = np.unique(surface[surface >= 0])
    return np.any([binary_erosion(pixel_means(surface == k) == 1) for k in shown], axis=0)


def pixel_means(values: np.ndarray) -> np.ndarray:
    """Return the means over the rays of each pixel."""
    return _by_pixels(values).mean(axis=(2, 3))


def _by_pixels(values: np.ndarray) -> np.ndarray:
    """Return a view (h, w, n, n, …) of the values (n h, n w, …) of all rays."""
    n = OVERSAMPLING
    height, width = values.shape[0] // n, values.shape[1] // n
    return values.reshape(height, n, width, n, *values.shape[2:]).swapaxes(1, 2)


_known: dict[bytes, np.ndarray] = {}


def _irradiance_once(sky: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return `irradiance`; equal normals, as all spheres have them, are summed up once."""
    normals = np.round(normals, 4)  # 0.006 degrees
    unique, index = np.unique(normals, axis=0, return_inverse=True)
    new = np.array([normal for normal in unique if normal.tobytes() not in _known])
    if new.size:
        for normal, E in zip(new, irradiance(sky, new), strict=True):
            _known[normal.tobytes()] = E
    return np.array([_known[normal.tobytes()] for normal in unique])[index.reshape(-1)]


def _background(sky_rgb: np.ndarray, camera: Camera) -> np.ndarray:
    """Return the sky behind each pixel, between its own pixels by straight lines."""
    _, directions = camera.rays()
    height, width = sky_rgb.shape[:2]
    x = (0.5 - np.arctan2(directions[..., 1], directions[..., 0]) / (2 * np.pi)) * width - 0.5
    y = (0.5 - np.arcsin(np.clip(directions[..., 2], -1, 1)) / np.pi) * height - 0.5
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    colour = np.zeros(directions.shape)
    for i in (0, 1):
        for j in (0, 1):
            weight = np.abs(1 - i - (y - row)) * np.abs(1 - j - (x - column))
            pixel = sky_rgb[np.clip(row + i, 0, height - 1), (column + j) % width]
            colour += weight[..., None] * pixel
    return colour
