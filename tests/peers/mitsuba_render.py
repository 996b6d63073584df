"""The scene in Mitsuba 3's spectral renderer. Runs in the peers' environment.

    python mitsuba_render.py request.json answer.npz

The sky is `sunsky` itself, or, given a file, an environment map in RGB, which Mitsuba upsamples to
spectra by Jakob and Hanika 2019 (DOI 10.1111/cgf.13626).
"""

import json
import sys
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_spectral")
from mitsuba_sky import sunsky  # noqa: E402  (its radiance is per variant)

Y_INTEGRAL = 106.7502593994140625
"""[nm]. Mitsuba divides by the integral of its y function; RGB files it takes as they are."""


def emitter(request):
    """Return the sky, its sun over +y and z up."""
    if "file" not in request:
        return sunsky(request["sun_elevation"], request["turbidity"], request["ground"])
    # Mitsuba's lat-long has its middle along +z and y up; Blender's along +x and z up.
    turn = mi.ScalarTransform4f([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    return {"type": "envmap", "filename": request["file"], "to_world": turn}


def curve(wavelengths, values):
    """Return a spectrum, by straight lines between its wavelengths [nm] and 0 beyond."""
    return {
        "type": "irregular",
        "wavelengths": ",".join(f"{value:g}" for value in wavelengths),
        "values": ",".join(f"{value:.6g}" for value in values),
    }


def square(face, column, row, reflectance, wavelengths):
    """Return one patch; the middle of all patches is the origin."""
    right, up, normal = (np.array(face[name]) for name in ("right", "up", "normal"))
    middle = (column - 2.5) * right + (1.5 - row) * up
    matrix = np.eye(4)
    matrix[:3] = np.stack([0.5 * right, 0.5 * up, normal, middle], axis=1)
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(matrix.tolist()),
        "bsdf": {"type": "diffuse", "reflectance": curve(wavelengths, reflectance)},
    }


def scene(request, face):
    """Return the scene with one face and a camera that sees its 6 x 4 patches and no more."""
    # A camera looks along its +z with +x to its left.
    right, up, normal = (np.array(face[name]) for name in ("right", "up", "normal"))
    view = np.eye(4)
    view[:3] = np.stack([-3.0 * right, 3.0 * up, -normal, 10.0 * normal], axis=1)
    pixels = request["pixels"]
    parts = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sky": emitter(request),
        "sensor": {
            "type": "orthographic",
            "to_world": mi.ScalarTransform4f(view.tolist()),
            "film": {
                "type": "hdrfilm",
                "width": 6 * pixels,
                "height": 4 * pixels,
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent", "sample_count": request["samples"]},
        },
    }
    for k, reflectance in enumerate(request["reflectances"]):
        parts[f"patch{k}"] = square(face, k % 6, k // 6, reflectance, request["wavelengths"])
    return mi.load_dict(parts)


def main(request, answer):
    """Write pictures (faces, rows, columns, 3), linear Rec.709, and seconds.

    ``seconds``: of all pictures once everything is loaded; ``start_seconds``: of loading.
    """
    request = json.loads(Path(request).read_text())
    scale = 1.0 if "file" in request else Y_INTEGRAL
    start = time.perf_counter()
    scenes = [scene(request, face) for face in request["faces"]]
    loaded = time.perf_counter()
    pictures = [np.array(mi.render(one))[..., :3] for one in scenes]
    seconds = time.perf_counter() - loaded
    np.savez(
        answer,
        pictures=scale * np.stack(pictures),
        seconds=seconds,
        start_seconds=loaded - start,
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
