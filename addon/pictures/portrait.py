"""All that pictures of one material depend on, as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .curve import curve
from .matrix import matrix


@dataclass(frozen=True)
class Portrait:
    """A material under a sky; equal where all its numbers are, so that pictures can be kept by it.

    ``name`` of the reflectance (81) in 0 to 1; ``matrix`` (3 x 3); ``spectrum`` (81) of the light
    on level ground, None where it is not known; ``measured`` [nm]: from where to where, None where
    that is not known; ``estimated``: whether nobody measured it; ``today`` (3 x 3): the matrix that
    RGB times RGB amounts to.
    """

    name: str
    reflectance: tuple[float, ...]
    matrix: tuple[tuple[float, ...], ...]
    spectrum: tuple[float, ...] | None = None
    measured: tuple[float, float] | None = None
    estimated: bool = False
    today: tuple[tuple[float, ...], ...] | None = None

    def draw_curve(self, **style: Any) -> NDArray[np.uint8]:
        """Draw its reflectance in its light; ``style``: theme and scale of `curve`."""
        return curve(
            self.reflectance,
            sky=self.spectrum,
            measured=self.measured,
            estimated=self.estimated,
            **style,
        )

    def draw_matrix(self, **style: Any) -> NDArray[np.uint8]:
        """Draw its matrix beside what RGB times RGB has; ``style``: theme and scale of `matrix`."""
        return matrix(self.matrix, today=self.today, **style)


def plain(values: ArrayLike | None) -> Any:
    """Return an array as tuples of floats, None as None."""
    if values is None:
        return None
    values = np.asarray(values, dtype=float).tolist()
    return tuple(tuple(row) if isinstance(row, list) else row for row in values)
