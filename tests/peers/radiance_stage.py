"""One of the examples' scenes in Radiance with 20 bands. Runs in the peers' environment.

    python radiance_stage.py request.json answer.npz

Sky, sun, lamps and surfaces have their spectra in 20 bands.
"""

import json
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from radiance_files import run, write_picture
from radiance_render import SKY

SUN = 0.533
"""Degrees across."""


def numbers(values):
    """Return numbers as Radiance's text."""
    return " ".join(f"{value:.6g}" for value in np.ravel(values))


def spectrum(name, bands):
    """Return 20 bands as a pattern; the wavelengths are the first and the last band's middles."""
    return f"void spectrum {name}\n0\n0\n22 390 770 {numbers(bands)}"


def shining(name, kind, bands):
    """Return a material that sends out 20 bands of radiance."""
    most = max(bands)
    scaled = spectrum(f"{name}_bands", np.array(bands) / most)
    return f"{scaled}\n{name}_bands {kind} {name}\n0\n0\n3 {numbers([most] * 3)}"


def text(request):
    """Return the scene as Radiance's text."""
    lines = [SKY]
    for k, surface in enumerate(request["surfaces"]):
        lines += [
            spectrum(f"rho{k}", surface["reflectance"]),
            f"rho{k} plastic matt{k}\n0\n0\n5 1 1 1 0 0",
        ]
        for i, polygon in enumerate(surface["polygons"]):
            corners = f"{3 * len(polygon)} {numbers(polygon)}"
            lines.append(f"matt{k} polygon p{k}_{i}\n0\n0\n{corners}")
    for k, sun in enumerate(request["suns"]):
        radiance = np.array(sun["spectrum"]) / (np.pi * np.sin(np.radians(SUN / 2)) ** 2)
        lines += [
            shining(f"sun{k}", "light", radiance),
            f"sun{k} source disc{k}\n0\n0\n4 {numbers(sun['direction'])} {SUN}",
        ]
    for k, lamp in enumerate(request["lamps"]):
        radiance = np.array(lamp["intensity"]) / (np.pi * lamp["radius"] ** 2)
        lines += [  # one does not see it: Blender's lamps are invisible too
            shining(f"lamp{k}", "illum", radiance),
            f"lamp{k} sphere ball{k}\n0\n0\n4 {numbers(lamp['at'])} {lamp['radius']}",
        ]
    return "\n".join(lines) + "\n"


def taken():
    """Return wall and processor seconds, those of finished programs included."""
    mine, theirs = (
        resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return time.perf_counter(), sum(one.ru_utime + one.ru_stime for one in (mine, theirs))


def main(request, answer):
    """Write the picture (h, w, 20), short waves first, and what it took.

    ``seconds`` and of them ``setup``, wall and processor (2,); ``memory`` and ``size`` [MB].
    """
    request = json.loads(Path(request).read_text())
    with tempfile.TemporaryDirectory() as name, np.load(request["file"]) as file:
        folder, times = Path(name), [taken()]
        # Radiance's columns go the other way round than Blender's.
        write_picture(folder / "sky.hsr", file["sky"][:, ::-1])
        (folder / "scene.rad").write_text(text(request))
        (folder / "scene.oct").write_bytes(run("oconv", "scene.rad", cwd=folder))
        times.append(taken())
        options = f"-h -faf -cs 20 -co+ {request['options']}"
        out = run(
            *("rtrace", *options.split(), "scene.oct"),
            cwd=folder,
            input="\n".join(map(numbers, file["rays"])).encode(),
        )
        times.append(taken())
        size = sum(path.stat().st_size for path in folder.iterdir()) / 1e6
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    seen = request["camera"]
    picture = np.frombuffer(out, np.float32).reshape(seen["height"], seen["width"], 20)[..., ::-1]
    start, ready, end = np.array(times)
    np.savez(
        answer,
        picture=picture,
        seconds=end - start,
        setup=ready - start,
        memory=memory,
        size=size,
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
