"""What a picture is off by where light is left out: the bounced light, or the sky's shadows too.

It is told by patches, whose light is known before any point of the picture has cast a ray.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..spectra.cielab import XYZ_to_Lab, delta_E_2000
from . import directions
from .radiosity import Radiosity

ENOUGH = 2000
"""Patches, of which a mean is told."""


@dataclass(frozen=True)
class LeftOut:
    """CIEDE2000 (k,) of patches ``without_bounces`` and under the ``open_sky``, and how much of the
    picture each is."""

    without_bounces: NDArray[np.float64]
    open_sky: NDArray[np.float64]
    weight: NDArray[np.float64]

    @property
    def line(self) -> str:
        """Both as means over the picture, in words; empty where nothing is seen."""
        if not self.weight.sum() > 0.0:
            return ""
        bounces, sky = (
            np.average(error, weights=self.weight)
            for error in (self.without_bounces, self.open_sky)
        )
        return f"without bounces ΔE {bounces:.2g}, under the open sky {sky:.2g}"


def left_out(
    radiosity: Radiosity,
    sky: NDArray[np.float32],
    to_XYZ: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> LeftOut:
    """Return what is off without some of the light that `Radiosity.solve` has found.

    ``sky`` (SKY, 16): as `solve` had it; ``to_XYZ`` (3, 16): of light in bands; ``weight``
    (patches,): how much of the picture the front of each is. White is the perfect diffuser in all
    the light of the place. Of more than `ENOUGH` patches some speak for all.
    """
    seen = np.flatnonzero((weight > 0.0) & (radiosity.E[: len(weight)].mean(axis=1) > 0.0))
    seen = seen[:: -(-len(seen) // ENOUGH) or 1]
    cells = radiosity.space.cells
    normals = cells.normals[cells.first[seen]]
    rho, E = radiosity.rho[seen], radiosity.E[seen]
    white = E @ to_XYZ.T
    true = XYZ_to_Lab((rho * E) @ to_XYZ.T, white)

    def error(light: NDArray) -> NDArray[np.float64]:
        return delta_E_2000(XYZ_to_Lab((rho * light) @ to_XYZ.T, white), true)

    open_sky = directions.open_light(sky, normals) + radiosity.direct[seen]
    return LeftOut(error(radiosity.first[seen]), error(open_sky), weight[seen])
