"""The light meter beside the referee: lux, melanopic lux and kelvin at points of an example.

    sh examples/run meter NAME ... [--samples N]

What a matt face sends, over its reflectance, is the light on it: so the referee's pictures, in
full spectrum and with every bounce, are meters at the places that its pixels show. Nothing of the
add-on is in them. Figures: examples/out/meter/NAME.json
"""

import argparse
import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import bands
import bpy
import judging
import lit
import numpy as np
import referee
import stage as stages
from lit_scenes import SCENES
from main_job import silenced
from mathutils import Vector
from scipy.ndimage import maximum_filter, minimum_filter
from stage import Stage

from spectral_skylight.addon.progress import run as work
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.files import blend_file
from spectral_skylight.addon.scene.meter.places import Places
from spectral_skylight.addon.scene.world.settings import Settings, stored
from spectral_skylight.addon.transfer.readings import Readings

SIZE = 36, 24
"""Pixels. Each is a meter, so few do."""

WINDOW = 3
"""Pixels of one face that are taken together, of both."""

SHARPER = 10
"""Times the example's samples, of which its noise is that of pictures."""


def main() -> int:
    """Compare examples; exit code as the command line's."""
    parser = argparse.ArgumentParser(prog="examples/meter", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="+", choices=SCENES, metavar="NAME", help=", ".join(SCENES))
    parser.add_argument("--samples", type=int, help="of the referee, a pixel and seed")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "meter")
    options = parser.parse_args()
    for name in options.names:
        out = (options.out / name).resolve()
        out.mkdir(parents=True, exist_ok=True)
        found = compare(name, out, options.samples or SHARPER * SCENES[name].samples)
        out.with_suffix(".json").write_text(json.dumps(found, indent=1), encoding="utf-8")
        print(f"{name}: {told(found)}", flush=True)
    return 0


def compare(name: str, out: Path, samples: int) -> dict:
    """Return the figures of one example."""
    example = SCENES[name]
    with silenced(out / "blender.log"):
        stage = example.build(lit.light(example, out, SIZE))
        stages.build(stage, referee.Today(), str(out / "sky.exr"))
        rays = judging.cast(stage)
        points, normals, known = places(stage)
        where = chosen(rays, known)
        stages.save(out / "scene.blend", 1)
        truth = reference(stage, samples, out)
        open_sky = replace(example, options=("--occlusion", "open"))
        lit.make_spectral(stage, open_sky, out, out / "skylight.blend")
        scene = blend_file.open_scene(out / "skylight.blend")
        meters = Places(points[where].reshape(-1, 3), normals[where].reshape(-1, 3))
        began = time.perf_counter()
        settings = stored(scene.world) or Settings()
        measured = work(use_cases.measuring(scene, settings, meters))
        seconds = time.perf_counter() - began
    face = np.where(where, by_pixel(rays.face[..., None])[:, :, 0, 0], -1)
    ours = around(measured.readings.irradiance.reshape(-1, 16, 81).mean(axis=1), face)
    true = [around(each[where], face) for each in (truth.mean(axis=0), *truth)]
    return {
        "scene": name,
        "points": int(where.sum()),
        "samples": samples,
        "seconds": seconds,
        "lux": [float(value) for value in np.percentile(true[0]["illuminance"], [0, 50, 100])],
        "errors": errors(ours, true[0]),
        "noise": errors(true[1], true[2], 0.5),
    }


def around(irradiance: np.ndarray, face: np.ndarray) -> Readings:
    """Return meters of the chosen pixels (n, 81), each a mean over `WINDOW` x `WINDOW` of its face.

    ``face`` (h, w): -1 where none is chosen. What is left of the referee's noise is a third.
    """
    at = np.argwhere(face >= 0)
    reach = WINDOW // 2
    near = (np.abs(at[:, None] - at[None]) <= reach).all(axis=2)
    near &= face[tuple(at.T)][:, None] == face[tuple(at.T)][None]
    mean = near @ irradiance / near.sum(axis=1, keepdims=True)
    return Readings(mean, mean)


def errors(ours: Readings, true: Readings, share: float = 1.0) -> dict:
    """Return mean and 95th percentile of errors: parts of lux and melanopic lux, and kelvin, as
    they are where white is of 6500 K (mired)."""
    found = {name: np.abs(ours[name] / true[name] - 1.0) for name in ("illuminance", "melanopic")}
    mired = 1e6 / ours.temperature[0] - 1e6 / true.temperature[0]
    found["kelvin_at_6500"] = np.abs(mired) * 6500.0**2 / 1e6
    return {
        name: {"mean": share * float(np.nanmean(e)), "p95": share * float(np.nanpercentile(e, 95))}
        for name, e in found.items()
    }


def places(stage: Stage) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return places and normals (h, w, 16, 3) of 4 x 4 rays a pixel, and which are of matt matter
    with one known reflectance (h, w)."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    origins, directions = stage.camera.rays(4)
    at, normal = np.zeros((2, *origins.shape))
    known = np.zeros(origins.shape[:2], bool)
    for k in np.ndindex(known.shape):
        hit, place, across, _, thing, _ = bpy.context.scene.ray_cast(
            depsgraph, Vector(origins[k]), Vector(directions[k])
        )
        if hit:
            at[k], normal[k] = place, across
            if across.dot(Vector(directions[k])) > 0.0:
                normal[k] *= -1.0
            matter = stage.matter[stage.things[thing.name].matter]
            known[k] = reflectance(matter) is not None
    return by_pixel(at), by_pixel(normal), by_pixel(known[..., None])[..., 0].all(axis=2)


def by_pixel(image: np.ndarray) -> np.ndarray:
    """Return an image (4h, 4w, k) by its pixels, (h, w, 16, k)."""
    h, w, k = image.shape[0] // 4, image.shape[1] // 4, image.shape[2]
    return image.reshape(h, 4, w, 4, k).swapaxes(1, 2).reshape(h, w, 16, k)


def reflectance(matter) -> np.ndarray | None:
    """Return the reflectance (81,) of what is matt and even, None of all else."""
    plain = matter.roughness is None and matter.metal is None and matter.emission is None
    rho = matter.reflectance
    return rho if plain and rho is not None and rho.ndim == 1 else None


def chosen(rays: judging.Rays, known: np.ndarray) -> np.ndarray:
    """Return the pixels (h, w) that show one face, and no shadow's edge of a lamp or the sun."""
    face = by_pixel(rays.face[..., None])[..., 0]
    # The filter of a pixel reaches a little into its neighbours.
    whole = (face == face[..., :1]).all(axis=2)
    same = minimum_filter(face[..., 0], 3) == maximum_filter(face[..., 0], 3)
    result = whole & same & known
    for lit_by in rays.lit:
        share = by_pixel(lit_by[..., None].astype(float))[..., 0].mean(axis=2)
        result &= (minimum_filter(share, 3) == 1.0) | (maximum_filter(share, 3) == 0.0)
    return result


def reference(stage: Stage, samples: int, out: Path) -> np.ndarray:
    """Return the spectral irradiance (2 seeds, h, w, 81) on what the pixels show."""
    path = out / f"irradiance_{samples}.npy"
    if path.is_file():
        return np.load(path)
    lights = stage.lights()
    size = 2, stage.camera.height, stage.camera.width
    quotients = {name: np.empty((*size, bands.KNOTS.size)) for name in lights}
    for triple in bands.TRIPLES:
        stages.build(stage, referee.Wavelengths(triple, lights["sky"]))
        for seed in range(2):
            rendered = referee._render(stage, samples, seed, referee.BOUNCES)
            for name in lights:
                quotients[name][seed][..., triple] = rendered[name]
    stages.build(stage, referee.Today(), str(out / "sky.exr"))
    rho = np.ones((*size[1:], bands.KNOTS.size))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    origins, directions = stage.camera.rays()
    for k in np.ndindex(rho.shape[:2]):
        hit, *_, thing, _ = bpy.context.scene.ray_cast(
            depsgraph, Vector(origins[k]), Vector(directions[k])
        )
        found = reflectance(stage.matter[stage.things[thing.name].matter]) if hit else None
        if found is not None:
            rho[k] = np.maximum(bands.at_knots(found), 1e-3)
    truth = sum((quotients[name] / rho) @ bands.SPLINE.T * light for name, light in lights.items())
    np.save(path, np.pi * truth)
    return np.pi * truth


def told(found: dict) -> str:
    """Return what a comparison says, in a line."""
    e, noise = found["errors"], found["noise"]
    parts = [
        f"{name} {100 * e[key]['mean']:.2f} % mean, {100 * e[key]['p95']:.2f} % at 95 % "
        f"(noise {100 * noise[key]['mean']:.2f} %)"
        for name, key in (("lux", "illuminance"), ("melanopic", "melanopic"))
    ]
    kelvin = e["kelvin_at_6500"]
    parts.append(f"{kelvin['mean']:.0f} K mean, {kelvin['p95']:.0f} K at 95 %, of 6500 K")
    return f"{found['points']} points, " + "; ".join(parts) + f"; {found['seconds']:.1f} s"


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
