"""By how much a measurement would change a material whose reflectance is estimated.

Three numbers of a base color leave a spectrum open: measured materials of one color part under
another light. What that comes to under a sky is seen on the building materials that ship. Each has
an estimate of its own color too, and the two are so far apart; those near a color stand for it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..spectra.formats import building_materials
from ..spectra.library import built_in
from .matrices import Transfer
from .measures import delta_E
from .prediction import rgb_albedo
from .textures import basis

NEAR = 10.0
"""[CIEDE2000] from a color at which a measured material counts half as much again, about as far as
bricks are from one another."""


def expected_change(
    transfer: Transfer, reflectances: ArrayLike, lights: ArrayLike
) -> NDArray[np.float64]:
    """Return the CIEDE2000 by which measuring is expected to change estimates (m, 81), (m,).

    Parameters
    ----------
    transfer
        Of the sky.
    reflectances
        The estimates; only their colors under D65 count.
    lights
        RGB irradiances (k, 3) of the sky, as the HDRI's numbers are.

    Returns
    -------
    The change of the measured building materials, mean over the lights and over the materials,
    these weighted by a Gaussian of their distance in color (`NEAR`) beyond the nearest one's.
    NaN without a light that has luminance.
    """
    rho, measured = np.atleast_2d(np.asarray(reflectances, dtype=float)), _measured()
    changes = change(transfer, measured, lights)
    colors, known = (rgb_albedo(each, transfer.space) for each in (rho, measured))
    away = delta_E(colors[:, None], known[None], np.ones(3), transfer.space)
    weights = np.exp((away.min(axis=1, keepdims=True) ** 2 - away**2) / (2.0 * NEAR**2))
    return (weights @ changes) / weights.sum(axis=1)


def change(transfer: Transfer, measured: ArrayLike, lights: ArrayLike) -> NDArray[np.float64]:
    """Return the CIEDE2000 between measured reflectances (m, 81) and their estimates, (m,).

    Mean over ``lights`` (k, 3) that have luminance, NaN without any; the estimate is that of
    Mallett and Yuksel (2019, DOI 10.2312/sr.20191216) from the color under D65.
    """
    rho, space = np.atleast_2d(np.asarray(measured, dtype=float)), transfer.space
    # Not clipped where a color is out of gamut: the two must differ by nothing that D65 shows.
    estimates = rgb_albedo(rho, space) @ basis(space)
    lights = np.atleast_2d(np.asarray(lights, dtype=float))
    white = lights @ transfer.to_working.T
    lights, white = lights[white.min(axis=1) > 0], white[white.min(axis=1) > 0]
    if not len(lights):
        return np.full(len(rho), np.nan)
    seen, guessed = (
        np.einsum("mij,kj->kmi", transfer.matrices(each), lights) for each in (rho, estimates)
    )
    errors: NDArray[np.float64] = delta_E(guessed, seen, white[:, None], space).mean(axis=0)
    return errors


@cache
def _measured() -> NDArray[np.float64]:
    """The building materials that ship, (m, 81)."""
    found = built_in()
    ours = [path.startswith(building_materials.PREFIX) for path in found.paths]
    return found.values[np.array(ours)]
