"""Colours of pictures: on dark, as Blender's interface, and on white, for print.

The pairs that must be told apart are blue and orange, which colour-blind people see apart too
(M. Okabe and K. Ito, https://jfly.uni-koeln.de/color).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


def _colour(code: str) -> NDArray[np.float64]:
    return np.array([int(code[k : k + 2], 16) for k in (0, 2, 4)]) / 255.0


@dataclass(frozen=True)
class Theme:
    """sRGB colours, 0 to 1, (3,) each.

    ``ink``: text and the curve that matters; ``faint``: axes and what is beside the point;
    ``paper``; ``cell``: areas on it; ``sky``; ``plus`` and ``minus``: signs; ``ours`` and
    ``today``: the two methods.
    """

    paper: NDArray[np.float64]
    cell: NDArray[np.float64]
    faint: NDArray[np.float64]
    ink: NDArray[np.float64]
    sky: NDArray[np.float64]
    plus: NDArray[np.float64]
    minus: NDArray[np.float64]
    ours: NDArray[np.float64]
    today: NDArray[np.float64]


DARK = Theme(
    *map(
        _colour,
        ("1d1d1d", "2b2b2b", "8c8c8c", "ececec", "7fb2e5", "e69f00", "56b4e9", "56b4e9", "e69f00"),
    )
)
LIGHT = Theme(
    *map(
        _colour,
        ("ffffff", "f2f2f2", "707070", "1a1a1a", "2f6fb0", "c06a00", "0072b2", "0072b2", "d08000"),
    )
)
THEMES = {"dark": DARK, "light": LIGHT}
