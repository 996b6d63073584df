"""Polynomials of a unit normal: what holds a sky's irradiance in a shader.

E(n) = P(x, y) + z Q(x, y), P of degree d, Q of degree d - 1: with z^2 = 1 - x^2 - y^2 these are all
polynomials of degree d on the sphere, the same space as spherical harmonics up to l = d.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

HIGHEST_DEGREE = 6


def exponents(degree: int) -> list[tuple[int, int, int]]:
    """Return the (degree + 1)^2 exponents (a, b, c) of x^a y^b z^c in the order of coefficients.

    First those without z, then those with it, each sorted by a + b, then by a.
    """
    return [
        (a, total - a, c)
        for c in (0, 1)
        for total in range(degree + 1 - c)
        for a in range(total + 1)
    ]


def monomials(normals: ArrayLike, degree: int) -> NDArray[np.float64]:
    """Return every monomial at every unit normal, (m, (degree + 1)^2), normals (m, 3)."""
    normals = np.asarray(normals, dtype=float)
    powers = normals[:, :, None] ** np.arange(degree + 1)
    a, b, c = np.array(exponents(degree)).T
    return powers[:, 0, a] * powers[:, 1, b] * powers[:, 2, np.minimum(c, degree)]


def raised(coefficients: ArrayLike, degree: int) -> NDArray[np.float64]:
    """Return the same polynomial with room for a degree that is as high or higher, 0 beyond."""
    coefficients = np.asarray(coefficients, dtype=float)
    own = exponents(round(len(coefficients) ** 0.5) - 1)
    result = np.zeros(((degree + 1) ** 2, *coefficients.shape[1:]))
    result[[exponents(degree).index(each) for each in own]] = coefficients
    return result


def evaluate_polynomial(coefficients: ArrayLike, normals: ArrayLike) -> NDArray[np.float64]:
    """Return the polynomial's value at unit normals, (m, 3).

    Parameters
    ----------
    coefficients
        ((d + 1)^2, 3) in the order of `exponents`; their count tells the degree.
    normals
        (m, 3), of length 1.
    """
    coefficients = np.asarray(coefficients, dtype=float)
    degree = round(len(coefficients) ** 0.5) - 1
    if (degree + 1) ** 2 != len(coefficients):
        raise ValueError(f"{len(coefficients)} coefficients fit no degree")
    return monomials(normals, degree) @ coefficients
