"""Radiance's `gendaylit` and `gensky`, skies of weather. Runs in the peers' environment.

    python radiance_weather.py request.json answer.npz

How bright they are as `rtrace` sees them: Perez' of an hour's irradiances, and the CIE's clear sky.
"""

import json
import sys
from pathlib import Path

import numpy as np
from radiance_files import run

GLOW = "\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 180\n"
EFFICACY = 179.0
"""[lm/W] of Radiance's white."""


def look(description, directions, folder):
    """Return the luminance [cd/m²] of a sky without its sun in directions (m, 3), (m,)."""
    # What is before the sky's own brightness is the sun.
    text = description[description.index("void brightfunc") :]
    (folder / "weather.rad").write_text(text + GLOW)
    octree = run("oconv", "weather.rad", cwd=folder)
    (folder / "weather.oct").write_bytes(octree)
    rays = "\n".join("0 0 0 " + " ".join(map(repr, map(float, each))) for each in directions)
    found = run("rtrace", "-h", "-ab", 0, "weather.oct", cwd=folder, input=rays.encode())
    rgb = np.array([line.split() for line in found.decode().splitlines()], float)
    return EFFICACY * rgb @ [0.265, 0.670, 0.065]


def main(request, answer):
    """Write the luminance of each sky of the request in its directions, (skies, m)."""
    folder = Path(request).parent
    request = json.loads(Path(request).read_text())
    directions = np.array(request["directions"])
    skies = [
        look(run(program, *arguments).decode(), directions, folder)
        for program, *arguments in request["skies"]
    ]
    np.savez(answer, luminance=skies)


if __name__ == "__main__":
    main(*sys.argv[1:])
