"""CIE L*a*b* and how far two colours are apart in it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def XYZ_to_Lab(XYZ: ArrayLike, XYZ_w: ArrayLike) -> NDArray[np.float64]:
    """Return CIE L*a*b* (..., 3) of colours XYZ (..., 3) beside a white XYZ_w (..., 3).

    Both in one unit: of the white itself L* is 100. Colours under 0 are on the straight line near
    black. CIE 015:2018 (DOI 10.25039/TR.015.2018).
    """
    t = np.asarray(XYZ, dtype=float) / np.asarray(XYZ_w, dtype=float)
    f = np.where(t > (24 / 116) ** 3, np.cbrt(t), (841 / 108) * t + 16 / 116)
    Lab = np.empty_like(f)
    Lab[..., 0] = 116 * f[..., 1] - 16
    Lab[..., 1] = 500 * (f[..., 0] - f[..., 1])
    Lab[..., 2] = 200 * (f[..., 1] - f[..., 2])
    return Lab


def delta_E_2000(Lab_1: ArrayLike, Lab_2: ArrayLike) -> NDArray[np.float64]:
    """Return the colour difference CIEDE2000 (...) between CIE L*a*b* colours (..., 3).

    Symmetric; 1 is about what is just noticed. Luo, Cui and Rigg 2001 (DOI 10.1002/col.1049), as
    Sharma, Wu and Dalal 2005 (DOI 10.1002/col.20070) write it.
    """
    L_1, a_1, b_1 = np.moveaxis(np.asarray(Lab_1, dtype=float), -1, 0)
    L_2, a_2, b_2 = np.moveaxis(np.asarray(Lab_2, dtype=float), -1, 0)
    G = 1.5 - 0.5 * _saturated((np.hypot(a_1, b_1) + np.hypot(a_2, b_2)) / 2)
    a_1, a_2 = G * a_1, G * a_2
    C_1, C_2 = np.hypot(a_1, b_1), np.hypot(a_2, b_2)
    h_1, h_2 = np.arctan2(b_1, a_1) % (2 * np.pi), np.arctan2(b_2, a_2) % (2 * np.pi)
    # Hues of a neutral colour are none: the difference is 0, the mean is the other's.
    neutral = C_1 * C_2 == 0
    # The shorter way leads over 0, but not between opposite hues, however they are rounded.
    far = ~neutral & (np.abs(h_2 - h_1) > np.pi + 1e-12)
    half = np.where(neutral, 0.0, h_2 - h_1) / 2 - np.where(far, np.pi * np.sign(h_2 - h_1), 0.0)
    h = np.where(neutral, h_1 + h_2, (h_1 + h_2) / 2)
    h += np.where(far, np.where(h_1 + h_2 < 2 * np.pi, np.pi, -np.pi), 0.0)
    L, C = (L_1 + L_2) / 2, (C_1 + C_2) / 2
    T = 1 - 0.17 * np.cos(h - np.pi / 6) + 0.24 * np.cos(2 * h)
    T += 0.32 * np.cos(3 * h + np.pi / 30) - 0.20 * np.cos(4 * h - 0.35 * np.pi)
    of_L = (L_2 - L_1) / (1 + 0.015 * (L - 50) ** 2 / np.sqrt(20 + (L - 50) ** 2))
    of_C = (C_2 - C_1) / (1 + 0.045 * C)
    of_H = 2 * np.sqrt(C_1 * C_2) * np.sin(half) / (1 + 0.015 * C * T)
    turn = np.radians(60 * np.exp(-(((np.degrees(h) - 275) / 25) ** 2)))
    R_T = -2 * np.sin(turn) * _saturated(C)
    # Rounding can leave equal colours a square that is under 0.
    return np.sqrt(np.maximum(of_L**2 + of_C**2 + of_H**2 + R_T * of_C * of_H, 0.0))


def _saturated(C: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``sqrt(C^7 / (C^7 + 25^7))``: 0 for neutral colours, 1 for vivid ones."""
    return np.sqrt(C**7 / (C**7 + 25.0**7))
