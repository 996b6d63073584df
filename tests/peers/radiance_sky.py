"""Radiance's `genssky` in given directions. Runs in the peers' environment, without our package.

    python radiance_sky.py request.json answer.npz

Bruneton and Neyret 2008 (DOI 10.1111/j.1467-8659.2008.01245.x) in 20 bands. For each haze genssky
first works out tables, for about a minute and a half, which are kept in the request's folder.
"""

import json
import re
import sys
from pathlib import Path

import numpy as np
from radiance_files import BANDS, read_picture, run

LATITUDE = 36.0
WIDTH = 256


def time_of(sun_elevation):
    """Return the hour of the morning of June 21 when the sun stands so high [degrees]."""
    latitude, declination, height = np.radians([LATITUDE, 23.44, sun_elevation])
    angle = (np.sin(height) - np.sin(latitude) * np.sin(declination)) / (
        np.cos(latitude) * np.cos(declination)
    )
    return 12.0 - np.degrees(np.arccos(angle)) / 15.0


def picture(sun_elevation, depth, ground, folder):
    """Return the picture of a sky, (h, w, 20) [W m^-2 sr^-1 nm^-1], and where its sun is, (3,)."""
    options = {"-a": LATITUDE, "-d": depth, "-g": ground, "-r": WIDTH, "-f": "sky"}
    flat = [word for option in options.items() for word in option]
    text = run("genssky", 6, 21, f"+{time_of(sun_elevation):.6f}", *flat, cwd=folder).decode()
    sun = re.search(r"source sun\s+0\s+0\s+4 (\S+) (\S+) (\S+)", text).groups()
    # Its values are watts over all of 380 to 780 nm.
    return read_picture(Path(folder) / "sky_sky.hsr") / 400.0, np.array(sun, float)


def look(values, elevation, azimuth):
    """Return a picture's values at [rad], (m, 20), between its pixels.

    Its first and last rows are at the zenith and the nadir themselves, its columns go from -180
    to 180 degrees, both included. Between four pixels their 8 bits even out, too.
    """
    height, width = values.shape[:2]
    row = (0.5 - elevation / np.pi) * (height - 1)
    column = ((azimuth / (2 * np.pi) + 0.5) % 1.0) * (width - 1)
    # Nothing of the ground, which begins under the horizon.
    i = np.minimum(row.astype(int), height // 2 - 2)
    j = np.minimum(column.astype(int), width - 2)
    v, u = (row - i).clip(0, 1)[:, None], (column - j)[:, None]
    upper = (1 - u) * values[i, j] + u * values[i, j + 1]
    lower = (1 - u) * values[i + 1, j] + u * values[i + 1, j + 1]
    return (1 - v) * upper + v * lower


def main(request, answer):
    """Write the radiance of a sky for each sun elevation, (suns, m, 20)."""
    folder = Path(request).parent
    request = json.loads(Path(request).read_text())
    elevation, from_sun = np.array(request["directions"])
    skies = []
    for height in request["sun_elevations"]:
        values, sun = picture(height, request["depth"], request["ground"], folder)
        found = np.degrees(np.arcsin(sun[2]))
        assert abs(found - height) < 0.05, f"sun at {found:.2f} instead of {height} degrees"
        skies.append(look(values, elevation, from_sun + np.arctan2(sun[1], sun[0])))
    np.savez(answer, radiance=skies, wavelengths=BANDS)


if __name__ == "__main__":
    main(*sys.argv[1:])
