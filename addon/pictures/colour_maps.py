"""Colors for values, from dark to light: in print, and for color-blind people, the order stays.

Viridis (S. van der Walt and N. Smith 2015, CC0): lightness grows evenly with the value.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

_STOPS = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"]

VIRIDIS: NDArray[np.float64] = (
    np.array([[int(code[k : k + 2], 16) for k in (0, 2, 4)] for code in _STOPS]) / 255.0
)
"""sRGB, 0 to 1, at even steps, (9, 3)."""


@dataclass(frozen=True)
class Range:
    """What a scale reaches from and to, and whether it is logarithmic."""

    low: float
    high: float
    logarithmic: bool = False

    @classmethod
    def of(cls, values: ArrayLike) -> Range:
        """Return the scale of values, NaN left out: from 0, or logarithmic over `WIDE` spans."""
        found = np.asarray(values, dtype=float)
        found = found[np.isfinite(found)]
        if not found.size or found.max() <= 0.0:
            return cls(0.0, 1.0)
        low, high = float(found.min()), float(found.max())
        if low > 0.0 and high > WIDE * low:
            return cls(low, high, True)
        return cls(0.0, high)

    def share(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return where values (...) stand between both ends, 0 to 1 within."""
        values = np.asarray(values, dtype=float)
        if not self.logarithmic:
            return (values - self.low) / (self.high - self.low)
        values = np.log(np.maximum(values, 1e-3 * self.low) / self.low)
        return values / np.log(self.high / self.low)

    def colours(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return the colors (..., 3), sRGB, of values (...); those beyond are clipped."""
        place = np.clip(np.nan_to_num(self.share(values)), 0.0, 1.0)
        steps = np.linspace(0.0, 1.0, len(VIRIDIS))
        return np.stack([np.interp(place, steps, column) for column in VIRIDIS.T], axis=-1)

    def steps(self, most: int = 7) -> NDArray[np.float64]:
        """Return round values within, at most so many: 100, 200, 300, or 100, 200, 500, 1000."""
        if self.logarithmic:
            ends = np.floor(np.log10([self.low, self.high]))
            for digits in ((1.0, 2.0, 5.0), (1.0, 3.0), (1.0,)):
                powers = 10.0 ** np.arange(ends[0], ends[1] + 1.0)
                found = np.outer(powers, digits).ravel()
                found = found[(found >= self.low) & (found <= self.high)]
                if len(found) <= most:
                    break
            return found
        span = self.high - self.low
        power = 10.0 ** np.floor(np.log10(span / most))
        step = next(power * k for k in (1.0, 2.0, 5.0, 10.0) if span / (power * k) <= most)
        first, last = np.ceil(self.low / step - 1e-9), np.floor(self.high / step + 1e-9)
        return np.abs(step * np.arange(first, last + 1.0))


WIDE = 10.0
"""A scale from 0 would hide what is so many times less than the most."""
