"""Irradiance that a sky gives to a face of any orientation, exact for pixels of even radiance.

Irradiance here is E / pi, so that a white diffuser's radiance equals it. A row of the sky, seen
from a face, is in front of it between two azimuths, and there the cosine is linear in the
direction. So the sum over a row is the normal times the row's vector integral of radiance
between those azimuths, a difference of running sums: no pixel is visited twice, and the horizon
clips inside a pixel as it should.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.chromaticity import uv
from ..spectra.working_spaces import DEFAULT_SPACE, XYZ_to_working
from .lat_long import directions
from .polynomial import HIGHEST_DEGREE, exponents, monomials

_ROWS = 256
"""Rows that a sky is brought to: finer ones are summed up (what they send to a face wholly in
front of them is kept exactly), coarser ones split. Within a row the clip is taken at mid-height,
right to a quarter of the row's height squared, 4e-5 of the irradiance under an even sky."""

_ROWS_AT_ONCE, _NORMALS_AT_ONCE = 16, 8
"""What is worked on stays in the processor's cache."""


def exact_irradiance(sky: ArrayLike, normals: ArrayLike) -> NDArray[np.float64]:
    """Return the cosine-weighted mean of the sky over each normal's hemisphere, (m, 3).

    Parameters
    ----------
    sky
        Lat-long radiance, (h, 2 h, 3), row 0 at the zenith, or its `running_sums`.
    normals
        (m, 3); their length does not count.
    """
    sums = _sums_of(sky)
    rows, columns = sums.shape[0], sums.shape[1] - 1
    flat, whole = sums.reshape(-1, 9), sums[:, -1].reshape(rows, 9)
    elevation = (0.5 - (np.arange(rows) + 0.5) / rows) * np.pi
    first = np.arange(rows) * (columns + 1)
    normals = np.asarray(normals, dtype=float)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    total = np.empty((len(normals), 9))
    for start in range(0, len(normals), _NORMALS_AT_ONCE):
        normal = normals[start : start + _NORMALS_AT_ONCE]
        level = np.hypot(normal[:, 0], normal[:, 1])[:, None]
        # n . d = level cos(elevation) cos(azimuth - that of n) + n_z sin(elevation) is positive
        # up to `half` on either side of the normal's azimuth.
        below = -normal[:, 2:] * np.sin(elevation)
        half = np.arccos(np.clip(below / np.maximum(level * np.cos(elevation), 1e-300), -1.0, 1.0))
        # Rows that the horizon of none of these cuts are wholly in front, or behind.
        cut = np.flatnonzero(((half > 0.0) & (half < np.pi)).any(axis=0))
        band = slice(int(cut[0]), int(cut[-1]) + 1) if cut.size else slice(0)
        in_front = half > 0.0
        in_front[:, band] = False
        half = half[:, band]
        azimuth = np.arctan2(normal[:, 1], normal[:, 0])[:, None]
        edges = np.stack([azimuth - half, azimuth + half], axis=1)
        column = (0.5 - edges / (2.0 * np.pi)) * columns
        turns = np.floor(column / columns)
        column -= turns * columns
        left = np.minimum(column.astype(np.intp), columns - 1)
        share = column - left
        # The sum up to one edge less that up to the other, each between two columns.
        weights = np.stack([1.0 - share, share], axis=-1) * [[[1.0]], [[-1.0]]]
        at = first[band] + left
        at = np.stack([at, at + 1], axis=-1).reshape(len(normal), -1)
        between = weights.reshape(len(normal), 1, -1) @ flat.take(at, axis=0)
        around = (turns[:, 0] - turns[:, 1]) @ whole[band] + in_front @ whole
        total[start : start + len(normal)] = between[:, 0] + around
    return np.einsum("ma,mac->mc", normals, total.reshape(-1, 3, 3)) / np.pi


def irradiance_map(sky: ArrayLike, width: int = 64) -> NDArray[np.float32]:
    """Return the irradiance of faces that look where the pixels of a panorama do.

    ``sky`` as in `exact_irradiance`. Shape (width / 2, width, 3), lat-long as the sky itself;
    `width` is even and at least 2.
    """
    if width < 2 or width % 2:
        raise ValueError(f"width {width} is not an even number of at least 2")
    normals = directions(width // 2, width)
    values = exact_irradiance(sky, normals.reshape(-1, 3))
    return values.reshape(normals.shape).astype(np.float32)


def running_sums(rgb: ArrayLike) -> NDArray[np.float64]:
    """Sum radiance times direction along each row, (rows, columns + 1, 3 directions, 3 RGB).

    Integrals over a pixel are in closed form; sums are in float64.
    """
    rgb = np.asarray(rgb)
    split = -(-_ROWS // rgb.shape[0])
    if split > 1:
        rgb = rgb.repeat(split, axis=0).repeat(split, axis=1)
    height, width = rgb.shape[:2]
    merge = next(k for k in range(max(1, height // _ROWS), 0, -1) if height % k == 0)
    elevation = (0.5 - np.arange(height + 1) / height) * np.pi
    azimuth = (0.5 - np.arange(width + 1) / width) * 2.0 * np.pi
    # Integrals of cos^2 and of sin cos over a row's elevations, of cos, sin and 1 over a column's
    # azimuths (which run downwards).
    across = -np.diff(elevation / 2.0 + np.sin(2.0 * elevation) / 4.0)
    upward = -np.diff(np.sin(elevation) ** 2 / 2.0)
    by_row = np.stack([across, upward], axis=1).reshape(-1, merge, 2).swapaxes(1, 2)
    by_column = np.stack([-np.diff(np.sin(azimuth)), np.diff(np.cos(azimuth)), -np.diff(azimuth)])
    by_column = by_column.reshape(3, -1, merge).swapaxes(0, 1)
    rows, columns = height // merge, width // merge
    sums = np.zeros((rows, columns + 1, 3, 3))
    for start in range(0, rows, _ROWS_AT_ONCE):
        some = slice(start, start + _ROWS_AT_ONCE)
        band = rgb[start * merge : some.stop * merge].reshape(-1, merge, 3 * width).astype(float)
        level, up = np.moveaxis((by_row[some] @ band).reshape(-1, 2, columns, merge, 3), 1, 0)
        vectors = sums[some, 1:]
        np.matmul(by_column[:, :2], level, out=vectors[:, :, :2])
        np.matmul(by_column[:, 2:], up, out=vectors[:, :, 2:])
        np.cumsum(vectors, axis=1, out=vectors)
    return sums


def _sums_of(sky: ArrayLike) -> NDArray[np.float64]:
    sky = np.asarray(sky)
    return sky if sky.ndim == 4 else running_sums(sky)


RGB_TO_XYZ = np.linalg.inv(XYZ_to_working(DEFAULT_SPACE))
"""Linear Rec.709 to CIE XYZ."""


@dataclass(frozen=True)
class DegreeError:
    """What a polynomial leaves of the exact irradiance, over normals with z >= 0."""

    degree: int
    mean: float
    """Mean relative error of luminance."""
    worst: float
    """Worst relative error of luminance."""
    chromaticity: float
    """Worst distance in u'v'."""


@dataclass(frozen=True)
class Fit:
    """A sky's irradiance / pi as a polynomial of the normal."""

    degree: int
    coefficients: NDArray[np.float64]
    """((degree + 1)^2, 3), RGB, in the order of `polynomial.exponents`."""
    errors: tuple[DegreeError, ...]
    """What each degree from 0 to 6 would leave, whichever was chosen."""
    of_degrees: tuple[NDArray[np.float64], ...]
    """The coefficients of each degree."""


def fit_coefficients(
    sky: ArrayLike,
    degree: int | None = None,
    tolerance: float = 0.01,
    to_xyz: ArrayLike = RGB_TO_XYZ,
) -> Fit:
    """Fit a polynomial of the normal to a sky's exact irradiance, by least squares.

    Relative errors of luminance count, those of faces that look downwards (soffits) a quarter:
    that leaves less over the upper hemisphere than an even fit, and about as much under it. Errors
    are measured in directions that the fit does not use; where less than a thousandth of the
    brightest light falls they are relative to that thousandth.

    Parameters
    ----------
    sky
        Lat-long radiance, (h, 2 h, 3), the sun's disc taken out, or its `running_sums`.
    degree
        0 to 6. Without one, the lowest that leaves at most `tolerance` at worst, else 6.
    to_xyz
        From the sky's colour space to CIE XYZ, (3, 3), for luminance and u'v'.
    """
    if degree is not None and not 0 <= degree <= HIGHEST_DEGREE:
        raise ValueError(f"degree {degree} is not in 0 to {HIGHEST_DEGREE}")
    to_xyz = np.asarray(to_xyz, dtype=float)
    sums = _sums_of(sky)
    fitted, checked = spread(1000), spread(1501, 1.0)
    checked = checked[checked[:, 2] >= 0.0]
    target = exact_irradiance(sums, fitted)
    truth = exact_irradiance(sums, checked) @ to_xyz.T
    luminance = target @ to_xyz[1]
    darkest = max(1e-3 * luminance.max(), 1e-300)
    # A little below the horizon still counts in full, for there the polynomial must not run away.
    weight = np.where(fitted[:, 2] >= -0.1, 1.0, 0.25) / np.maximum(luminance, darkest)
    # The terms of each degree are those of the one before and some more: one QR serves them all.
    known = exponents(HIGHEST_DEGREE)
    order = sorted(range(len(known)), key=lambda k: sum(known[k]))
    terms = (monomials(fitted, HIGHEST_DEGREE) * weight[:, None])[:, order]
    Q, R = np.linalg.qr(terms)
    along = Q.T @ (target * weight[:, None])
    coefficients, errors = [], []
    for each in range(HIGHEST_DEGREE + 1):
        count = (each + 1) ** 2
        solution = np.linalg.solve(R[:count, :count], along[:count])
        solution = solution[np.argsort(order[:count])]  # as `exponents` has them
        estimate = monomials(checked, each) @ solution @ to_xyz.T
        relative = np.abs(estimate - truth)[:, 1] / np.maximum(truth[:, 1], darkest)
        colour = np.linalg.norm(uv(estimate, darkest) - uv(truth, darkest), axis=1)
        coefficients.append(solution)
        left = (float(relative.mean()), float(relative.max()), float(colour.max()))
        errors.append(DegreeError(each, *left))
    if degree is None:
        fine = (error.degree for error in errors if error.worst <= tolerance)
        degree = next(fine, HIGHEST_DEGREE)
    return Fit(degree, coefficients[degree], tuple(errors), tuple(coefficients))


def spread(count: int, turn: float = 0.0) -> NDArray[np.float64]:
    """Return evenly spread unit vectors, (count, 3): a Fibonacci spiral, turned by ``turn`` [rad].

    R. Swinbank and R. J. Purser 2006, DOI 10.1256/qj.05.227.
    """
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    azimuth = index * np.pi * (3.0 - 5.0**0.5) + turn
    level = np.sqrt(1.0 - z * z)
    return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), z], axis=1)
