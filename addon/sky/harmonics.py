"""Spherical harmonics in which occlusion is baked, and the sky fitted to what they can hold.

Precomputed radiance transfer (Sloan, Kautz & Snyder 2002, doi:10.1145/566654.566612): the
irradiance/pi of a point is the integral of sky radiance times `transfer`, visibility times
cosine / pi. Transfer is projected onto harmonics, sixteen numbers; the sky is *fitted* to the same
harmonics over the hemisphere alone, so that their product is right for transfers as buildings
make them. (Projecting the sky too would spend half the harmonics on a black lower half.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .irradiance import RGB_TO_XYZ

DEGREE = 3

KEYS = [(degree, order) for degree in range(DEGREE + 1) for order in range(-degree, degree + 1)]
"""The (degree l, order m) of the 16 coefficients in their order; m > 0 goes with cos(m azimuth),
m < 0 with sin(-m azimuth)."""

_CELLS = (30, 120)
"""Rows and columns that the upper hemisphere is brought to for fitting: 3 degrees each."""

_TRANSFERS = 1200
"""Made-up transfers that a fit is right for; as many others judge it."""

_DARKEST = 0.05
"""Part of the brightest transfer's light under which errors are relative to that part: in darker
corners the light that walls hand on counts for more."""


def harmonics(directions: ArrayLike, degree: int = DEGREE) -> NDArray[np.floating]:
    """Return the real spherical harmonics at unit vectors (…, 3), (…, (degree + 1)^2).

    Orthonormal over the sphere, in the order of `KEYS`; of the directions' float type. `degree`
    is 0 to 3.
    """
    x, y, z = np.moveaxis(np.asarray(directions), -1, 0)
    result = np.empty((*x.shape, (degree + 1) ** 2), dtype=np.result_type(x, np.float32))
    for index, value in enumerate(functions(x, y, z)[: (degree + 1) ** 2]):
        result[..., index] = value
    return result


def functions(x: NDArray, y: NDArray, z: NDArray) -> tuple[NDArray, ...]:
    """Return the 16 functions one by one, each of the shape of x, y, z of unit vectors.

    P.-P. Sloan 2008, Stupid Spherical Harmonics Tricks, appendix A2, without its signs.
    """
    across, squares = x * y, x * x - y * y
    return (
        np.full_like(x, 0.28209479177387814),
        0.4886025119029199 * y,
        0.4886025119029199 * z,
        0.4886025119029199 * x,
        1.0925484305920792 * across,
        1.0925484305920792 * y * z,
        0.31539156525252005 * (3.0 * z * z - 1.0),
        1.0925484305920792 * x * z,
        0.5462742152960396 * squares,
        0.5900435899266435 * y * (3.0 * x * x - y * y),
        2.890611442640554 * across * z,
        0.4570457994644658 * y * (5.0 * z * z - 1.0),
        0.3731763325901154 * z * (5.0 * z * z - 3.0),
        0.4570457994644658 * x * (5.0 * z * z - 1.0),
        1.445305721320277 * squares * z,
        0.5900435899266435 * x * (x * x - 3.0 * y * y),
    )


def rotate(coefficients: ArrayLike, angle: float) -> NDArray[np.float64]:
    """Return the coefficients (…, 4, 9 or 16) of a function turned about z by an angle [rad].

    Counter-clockwise as seen from above: what stood at azimuth 0 then stands at `angle`.
    """
    coefficients = np.asarray(coefficients, dtype=float)
    turned = coefficients.copy()
    for degree in range(round(coefficients.shape[-1] ** 0.5)):
        middle = degree * (degree + 1)
        for order in range(1, degree + 1):
            c, s = np.cos(order * angle), np.sin(order * angle)
            even, odd = coefficients[..., middle + order], coefficients[..., middle - order]
            turned[..., middle + order] = c * even - s * odd
            turned[..., middle - order] = s * even + c * odd
    return turned


@dataclass(frozen=True)
class HarmonicFit:
    """A sky's radiance in harmonics, right on the upper hemisphere under occlusion."""

    coefficients: NDArray[np.float64]
    """(16, 3) RGB in the order of `KEYS`; those beyond `count` are 0."""
    first: NDArray[np.float64]
    """(9, 3): the fit with 9, for transfers that are held in no more."""
    count: int
    """9 or 16: what was chosen."""
    errors: dict[int, tuple[float, float, float]]
    """For 9 and 16: mean and worst relative error of luminance, and mean distance in u'v', over
    made-up transfers that the fit has not seen."""


def fit_sky(
    rgb: ArrayLike,
    count: int | None = None,
    tolerance: float = 0.02,
    to_xyz: ArrayLike = RGB_TO_XYZ,
) -> HarmonicFit:
    """Fit harmonics to a sky's upper half, by least squares of occluded irradiance.

    Relative errors count, over made-up faces among walls and soffits (always the same ones).

    Parameters
    ----------
    rgb
        Lat-long radiance, (h, 2 h, 3), row 0 at the zenith, the sun's disc taken out.
    count
        9 or 16 coefficients; without one, 9 where they leave at most `tolerance` on average.
    to_xyz
        From the sky's colour space to CIE XYZ, (3, 3), for luminance and u'v'.
    """
    if count not in (None, 9, 16):
        raise ValueError(f"{count} coefficients: 9 or 16 can be had")
    to_xyz = np.asarray(to_xyz, dtype=float)
    sky = _cells(np.asarray(rgb))
    directions, shares = _directions()
    basis = harmonics(directions)
    fitted, checked = _transfers(0), _transfers(1)
    truth = checked @ sky
    luminance = fitted @ sky @ to_xyz[1]
    weight = 1.0 / np.maximum(luminance, max(_DARKEST * luminance.max(), 1e-300))
    found, errors = {}, {}
    for each in (9, 16):
        terms = fitted @ basis[:, :each] * weight[:, None]
        # A trace of radiance itself, for shapes of sky that no transfer here looks through.
        trace = 1e-2 * np.sqrt(len(weight) * shares / shares.sum()) * np.median(weight)
        solution = np.linalg.lstsq(
            np.concatenate([terms, basis[:, :each] * trace[:, None]]),
            np.concatenate([fitted @ sky * weight[:, None], sky * trace[:, None]]),
            rcond=None,
        )[0]
        estimate = checked @ basis[:, :each] @ solution
        found[each], errors[each] = solution, _errors(estimate @ to_xyz.T, truth @ to_xyz.T)
    if count is None:
        count = 9 if errors[9][0] <= tolerance else 16
    coefficients = np.zeros((16, 3))
    coefficients[:count] = found[count]
    return HarmonicFit(coefficients, found[9], count, errors)


def _errors(estimate, truth):
    darkest = max(_DARKEST * truth[:, 1].max(), 1e-300)
    relative = np.abs(estimate - truth)[:, 1] / np.maximum(truth[:, 1], darkest)
    uv = [
        xyz[:, :2] * [4.0, 9.0] / np.maximum(xyz @ [1.0, 15.0, 3.0], darkest)[:, None]
        for xyz in (estimate, truth)
    ]
    colour = np.linalg.norm(uv[0] - uv[1], axis=1)
    return float(relative.mean()), float(relative.max()), float(colour.mean())


def _cells(rgb):
    """Mean radiance of the cells of the upper hemisphere, (rows * columns, 3), by solid angle."""
    rows, columns = _CELLS
    split = -(-2 * rows // rgb.shape[0])
    if split > 1:
        rgb = rgb.repeat(split, axis=0).repeat(split, axis=1)
    height, width = rgb.shape[:2]
    upper = rgb[: (height + 1) // 2].astype(float)
    row = np.minimum((np.arange(len(upper)) + 0.5) * 2 * rows / height, rows - 1).astype(int)
    column = ((np.arange(width) + 0.5) * columns / width).astype(int)
    angle = np.cos((0.5 - (np.arange(len(upper)) + 0.5) / height) * np.pi)
    total, weight = np.zeros((rows, columns, 3)), np.zeros((rows, columns))
    np.add.at(total, (row[:, None], column), upper * angle[:, None, None])
    np.add.at(weight, (row[:, None], column), np.broadcast_to(angle[:, None], upper.shape[:2]))
    return (total / weight[..., None]).reshape(-1, 3)


def _directions():
    """The cells' middles, (rows * columns, 3), and their solid angles."""
    rows, columns = _CELLS
    edges = np.sin((0.5 - np.arange(rows + 1) / (2 * rows)) * np.pi)
    z = np.repeat((edges[:-1] + edges[1:]) / 2, columns)
    azimuth = np.tile((0.5 - (np.arange(columns) + 0.5) / columns) * 2.0 * np.pi, rows)
    level = np.sqrt(1.0 - z * z)
    directions = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), z], axis=1)
    return directions, np.repeat(-np.diff(edges), columns) * 2.0 * np.pi / columns


@lru_cache
def _transfers(seed):
    """Visibility times cosine / pi times solid angle of made-up faces, (`_TRANSFERS`, cells).

    Level, upright and tilted faces between up to four walls of any height, a third of them under
    a soffit: half spaces through the point, as long walls and eaves are.
    """
    rng = np.random.default_rng(seed)
    directions, shares = _directions()
    found = []
    while len(found) < _TRANSFERS:
        z = rng.choice([1.0, 0.0, rng.uniform(-0.7, 1.0)], p=[0.4, 0.4, 0.2])
        azimuth, level = rng.uniform(0.0, 2.0 * np.pi), np.sqrt(1.0 - z * z)
        normal = np.array([level * np.cos(azimuth), level * np.sin(azimuth), z])
        cosine = np.maximum(directions @ normal, 0.0) / np.pi
        grid = rng.uniform(0.0, 2.0 * np.pi)
        for wall in rng.permutation(4)[: rng.integers(0, 5)]:
            toward = grid + wall * np.pi / 2.0
            away = directions[:, :2] @ [np.cos(toward), np.sin(toward)]
            cosine *= directions[:, 2] > away * np.exp(rng.uniform(-2.0, 1.2))
        if rng.random() < 1.0 / 3.0:
            away = directions[:, :2] @ [np.cos(grid), np.sin(grid)]
            cosine *= directions[:, 2] < away * np.exp(rng.uniform(-1.0, 2.0))
        if cosine @ shares > 0.01:
            found.append(cosine * shares)
    return np.array(found)
