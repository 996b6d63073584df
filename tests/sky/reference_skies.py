"""How far a simulated sky is from the reference one, in CIEDE2000; the reference lies in a file.

``.venv/bin/python -m spectral_skylight.tests.sky.reference_skies`` writes it, in some minutes.
"""

from pathlib import Path

import numpy as np

from spectral_skylight.addon.sky.clear_sky import picture
from spectral_skylight.addon.sky.irradiance import spread
from spectral_skylight.addon.sky.lat_long import directions, solid_angles
from spectral_skylight.addon.sky.simulation import simulate
from spectral_skylight.addon.spectra.cielab import XYZ_to_Lab, delta_E_2000
from spectral_skylight.addon.spectra.colorchecker import colorchecker
from spectral_skylight.addon.spectra.grid import WEIGHTS
from spectral_skylight.addon.spectra.sensitivities import cmfs

FILE = Path(__file__).with_suffix(".npz")
ELEVATIONS = (-6.0, -3.0, 0.0, 5.0, 20.0, 60.0, 90.0)
ROWS = 24
FACES = spread(40)


def seen(sky):
    """Irradiance / pi on `FACES` without the disc, (40, 81), and the dome's XYZ, (12, 48, 3)."""
    radiance = picture(sky, ROWS)
    towards = directions(ROWS, 2 * ROWS).reshape(-1, 3)
    weight = np.repeat(solid_angles(ROWS, 2 * ROWS), 2 * ROWS)[:, None] / np.pi
    faces = (np.maximum(towards @ FACES.T, 0.0) * weight).T @ radiance.reshape(-1, 81)
    return faces, radiance[: ROWS // 2] @ (cmfs() * WEIGHTS).T


def differences(true, found):
    """CIEDE2000 of the ColorChecker on faces, (40, 24), and of the dome itself, (12, 48).

    White is what reflects all light: on each face, and for the dome on level ground.
    """
    S = cmfs() * WEIGHTS
    white = (true[0] @ S.T)[:, None]
    colors = [
        XYZ_to_Lab(np.einsum("iw,mw,nw->nmi", S, colorchecker()[1], faces, optimize=True), white)
        for faces, _ in (true, found)
    ]
    # The dome's mean by the cosine to the zenith, as it lies on level ground.
    share = np.sin(np.pi * (0.5 - (np.arange(ROWS // 2) + 0.5) / ROWS))
    share *= solid_angles(ROWS, 2 * ROWS)[: ROWS // 2].reshape(-1) / np.pi
    level = np.einsum("r,rci->i", share, true[1])
    dome = [XYZ_to_Lab(XYZ, level) for _, XYZ in (true, found)]
    return delta_E_2000(*colors), delta_E_2000(*dome)


def stored():
    """The reference skies by elevation, as `seen` gives them."""
    with np.load(FILE) as file:
        return {
            elevation: (file["faces"][k].astype(float), file["dome"][k].astype(float))
            for k, elevation in enumerate(ELEVATIONS)
        }


def write(skies):
    """Write the reference skies, of `ELEVATIONS`."""
    faces, dome = zip(*map(seen, skies), strict=True)
    np.savez_compressed(FILE, faces=np.float32(faces), dome=np.float32(dome))


if __name__ == "__main__":
    write([simulate(elevation, quality="reference", progress=True) for elevation in ELEVATIONS])
