"""Mitsuba 3's `sunsky` in given directions. Runs in the peers' environment, without our package.

    python mitsuba_sky.py request.json answer.npz

Hosek and Wilkie 2012 (DOI 10.1145/2185520.2185591), the spectral data; the sun's disc is off.
"""

import json
import sys
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_spectral")

END = 720.0
"""[nm]. The data reach from 320 to here; beyond, radiance is 0."""


def sunsky(sun_elevation, turbidity, ground):
    """Return the emitter, its sun over +y [degrees]."""
    height = np.radians(sun_elevation)
    return {
        "type": "sunsky",
        "sun_direction": [0.0, float(np.cos(height)), float(np.sin(height))],
        "sun_scale": 0.0,
        "turbidity": float(turbidity),
        "albedo": float(ground),
    }


def radiance(emitter, directions, wavelengths):
    """Return what comes from unit directions (m, 3), (m, n) [W m^-2 sr^-1 nm^-1]."""
    # At the very end of the data 3.9.1 answers NaN.
    asked = np.where(wavelengths == END, END - 0.01, wavelengths)
    fours = np.resize(asked, (-(-asked.size // 4), 4)).tolist()  # so many at once
    result = np.empty((len(directions), len(fours), 4))
    for row, direction in zip(result, directions.tolist(), strict=True):
        at = mi.SurfaceInteraction3f()
        at.wi = mi.Vector3f([-x for x in direction])
        for values, four in zip(row, fours, strict=True):
            at.wavelengths = four
            values[:] = emitter.eval(at)
    return result.reshape(len(directions), -1)[:, : asked.size]


def main(request, answer):
    """Write the radiance of a sky for each sun elevation, (suns, m, n)."""
    request = json.loads(Path(request).read_text())
    elevation, azimuth = np.array(request["directions"])  # from the sun, which stands over +y
    level = np.cos(elevation)
    directions = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)], 1)
    wavelengths = np.array(request["wavelengths"])
    skies = [
        radiance(
            mi.load_dict(sunsky(sun, request["turbidity"], request["ground"])),
            directions,
            wavelengths,
        )
        for sun in request["sun_elevations"]
    ]
    np.savez(answer, radiance=skies, wavelengths=wavelengths)


if __name__ == "__main__":
    main(*sys.argv[1:])
