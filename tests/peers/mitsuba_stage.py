"""One of the examples' scenes in Mitsuba 3's spectral renderer. Runs in the peers' environment.

    python mitsuba_stage.py request.json answer.npz

Surfaces, sun and lamps have their spectra. The sky is an HDRI: Mitsuba's environment map takes RGB
alone, and upsamples it by Jakob and Hanika 2019 (DOI 10.1111/cgf.13626).
"""

import json
import resource
import sys
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np
from mitsuba_render import Y_INTEGRAL, curve, emitter

UNIT = Y_INTEGRAL * 683.002 / 1e4
"""Of a light's spectrum, so that a picture is in 10,000 cd/m² as the sky's RGB is."""


def ply(polygons):
    """Return convex polygons as the text of a PLY file, each with corners of its own."""
    corners = [corner for polygon in polygons for corner in polygon]
    faces, start = [], 0
    for polygon in polygons:
        faces += [f"3 {start} {start + k} {start + k + 1}" for k in range(1, len(polygon) - 1)]
        start += len(polygon)
    head = ["ply", "format ascii 1.0", f"element vertex {len(corners)}"]
    head += [f"property float {axis}" for axis in "xyz"]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    return "\n".join([*head, *(" ".join(map(str, corner)) for corner in corners), *faces]) + "\n"


def camera(request):
    """Return the pinhole camera; it looks along its +z with +x to its left."""
    seen, view = request["camera"], np.eye(4)
    view[:3, :3] = np.array([seen["right"], seen["up"], seen["back"]]).T * [-1, 1, -1]
    view[:3, 3] = seen["location"]
    return {
        "type": "perspective",
        "fov_axis": "x",
        "fov": 2 * np.degrees(np.arctan(seen["scale"] / 2)),
        "to_world": mi.ScalarTransform4f(view.tolist()),
        "film": {
            "type": "hdrfilm",
            "width": seen["width"],
            "height": seen["height"],
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent", "sample_count": request["samples"]},
    }


def scene(request, folder):
    """Return the scene; its meshes are left in a folder."""
    wavelengths = request["wavelengths"]

    def light(spectrum):
        return curve(wavelengths, UNIT * np.array(spectrum))

    parts = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": request["bounces"] + 1},
        "sky": emitter(request),
        "sensor": camera(request),
    }
    for k, surface in enumerate(request["surfaces"]):
        path = folder / f"{k}.ply"
        path.write_text(ply(surface["polygons"]))
        matt = {"type": "diffuse", "reflectance": curve(wavelengths, surface["reflectance"])}
        parts[f"surface{k}"] = {
            "type": "ply",
            "filename": str(path),
            "face_normals": True,
            "bsdf": {"type": "twosided", "bsdf": matt},
        }
    for k, sun in enumerate(request["suns"]):
        way = (-np.array(sun["direction"])).tolist()
        irradiance = light(sun["spectrum"])
        parts[f"sun{k}"] = {"type": "directional", "direction": way, "irradiance": irradiance}
    for k, lamp in enumerate(request["lamps"]):
        intensity = light(lamp["intensity"])
        parts[f"lamp{k}"] = {"type": "point", "position": lamp["at"], "intensity": intensity}
    return mi.load_dict(parts)


def main(request, answer):
    """Write the picture (h, w, 3) in linear Rec.709, and what it took.

    ``seconds`` and of them ``setup``, wall and processor (2,); ``memory`` and ``size`` [MB].
    """
    request = json.loads(Path(request).read_text())
    times = [(time.perf_counter(), time.process_time())]
    with tempfile.TemporaryDirectory() as folder:
        loaded = scene(request, Path(folder))
        times.append((time.perf_counter(), time.process_time()))
        picture = np.array(mi.render(loaded))[..., :3]
        times.append((time.perf_counter(), time.process_time()))
        files = [*Path(folder).iterdir(), Path(request["file"])]
        size = sum(file.stat().st_size for file in files) / 1e6
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    start, ready, end = np.array(times)
    taken = {"seconds": end - start, "setup": ready - start, "memory": memory, "size": size}
    np.savez(answer, picture=picture, **taken)


if __name__ == "__main__":
    main(*sys.argv[1:])
