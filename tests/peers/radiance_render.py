"""The scene in Radiance with 20 bands. Runs in the peers' environment.

    python radiance_render.py request.json answer.npz

The sky is a spectral picture as `genssky` writes one, and only ambient rays find it.
"""

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from radiance_files import run, write_picture

SKY = """void specpict bands
5 noop sky.hsr . 'Atan2(Dy,Dx)/PI+1' '1-Acos(Dz)/PI'
0
0
bands glow light
0
0
4 1 1 1 0
light source dome
0
0
4 0 0 1 360
"""


def patches(face, reflectances):
    """Return the patches of one face as Radiance's text; reflectances in 20 bands."""
    right, up = np.array(face["right"]), np.array(face["up"])
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    lines = []
    for k, bands in enumerate(reflectances):
        middle = (k % 6 - 2.5) * right + (1.5 - k // 6) * up
        points = middle + corners[:, :1] * right + corners[:, 1:] * up
        numbers = " ".join(f"{x:.6f}" for x in bands)
        lines += [
            # The wavelengths are those of the first and the last value, the bands' middles.
            f"void spectrum rho{k}\n0\n0\n22 390 770 {numbers}",
            f"rho{k} plastic patch{k}\n0\n0\n5 1 1 1 0 0",
            f"patch{k} polygon square{k}\n0\n0\n12 " + " ".join(f"{x:.6f}" for x in points.flat),
        ]
    return "\n".join(lines)


def rays(face, pixels):
    """Return a ray for the middle of each pixel, from above, (24 pixels^2, 6), top row first."""
    right, up, normal = (np.array(face[name]) for name in ("right", "up", "normal"))
    across = (np.arange(6 * pixels) + 0.5) / pixels - 3.0
    along = 2.0 - (np.arange(4 * pixels) + 0.5) / pixels
    points = along[:, None, None] * up + across[:, None] * right + 10.0 * normal
    return np.concatenate([points, np.broadcast_to(-normal, points.shape)], axis=2).reshape(-1, 6)


def trace(folder, asked, samples):
    """Return what rays see, (m, 20) as float32, long waves first, and the seconds it took."""
    options = f"-h -faf -cs 20 -co+ -n 2 -ab 1 -ad {samples} -as 0 -aa 0 -lr 4 -lw 0"
    start = time.perf_counter()
    out = run("rtrace", *options.split(), "scene.oct", cwd=folder, input=asked)
    return np.frombuffer(out, np.float32).reshape(-1, 20), time.perf_counter() - start


def main(request, answer):
    """Write pictures (faces, rows, columns, 20), short waves first, and seconds.

    ``seconds``: of all pictures once everything is loaded; ``start_seconds``: of loading, which
    is what one sample a pixel takes.
    """
    request = json.loads(Path(request).read_text())
    pixels, pictures, seconds = request["pixels"], [], np.zeros(2)
    with tempfile.TemporaryDirectory() as folder, np.load(request["file"]) as file:
        # Radiance's columns go the other way round than Blender's.
        write_picture(Path(folder) / "sky.hsr", file["sky"][:, ::-1])
        for face in request["faces"]:
            text = SKY + patches(face, request["reflectances"])
            (Path(folder) / "scene.rad").write_text(text)
            (Path(folder) / "scene.oct").write_bytes(run("oconv", "scene.rad", cwd=folder))
            asked = "\n".join(" ".join(f"{x:.6f}" for x in ray) for ray in rays(face, pixels))
            _, start = trace(folder, asked.encode(), 1)
            values, took = trace(folder, asked.encode(), request["samples"])
            seconds += took - start, start
            pictures.append(values.reshape(4 * pixels, 6 * pixels, 20)[..., ::-1])
    np.savez(answer, pictures=pictures, seconds=seconds[0], start_seconds=seconds[1])


if __name__ == "__main__":
    main(*sys.argv[1:])
