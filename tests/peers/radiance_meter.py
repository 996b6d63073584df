"""Daylight factors of a room in Radiance. Runs in the peers' environment.

    python radiance_meter.py request.json answer.npz

The sky is `gensky`'s, the CIE's overcast one, over ground of the reflectance that is asked for.
"""

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from radiance_files import run

DOME = """skyfunc glow light
0
0
4 1 1 1 0
light source dome
0
0
4 0 0 1 360
"""


def polygons(triangles, reflectance):
    """Return triangles (n, 3, 3) of one gray as Radiance's text."""
    lines = [f"void plastic gray\n0\n0\n5 {reflectance} {reflectance} {reflectance} 0 0"]
    for k, corners in enumerate(triangles):
        numbers = " ".join(f"{x:.6f}" for x in np.ravel(corners))
        lines.append(f"gray polygon face{k}\n0\n0\n9 {numbers}")
    return "\n".join(lines)


def irradiance(folder, name, text, points, options):
    """Return what falls on meters (m, 6) in a scene, (m,), and the seconds it took."""
    (Path(folder) / f"{name}.rad").write_text(text)
    (Path(folder) / f"{name}.oct").write_bytes(run("oconv", f"{name}.rad", cwd=folder))
    asked = "\n".join(" ".join(f"{x:.6f}" for x in point) for point in points)
    start = time.perf_counter()
    command = f"-I -h -faf -n 2 {options} {name}.oct"
    out = run("rtrace", *command.split(), cwd=folder, input=asked.encode())
    return np.frombuffer(out, np.float32).reshape(-1, 3)[:, 1], time.perf_counter() - start


def main(request, answer):
    """Write daylight factors (m,), 0 to 1, and the seconds of the room."""
    request = json.loads(Path(request).read_text())
    points = np.array(request["points"])
    with tempfile.TemporaryDirectory() as folder:
        sky = run("gensky", "-ang", "45", "180", "-c", "-g", request["ground"], cwd=folder).decode()
        room = polygons(request["triangles"], request["reflectance"])
        open_air, _ = irradiance(folder, "open", sky + DOME, points[:1], "-ab 1 -ad 65536 -aa 0")
        inside, seconds = irradiance(folder, "room", sky + DOME + room, points, request["options"])
    np.savez(answer, factors=inside / open_air, seconds=seconds)


if __name__ == "__main__":
    main(*sys.argv[1:])
