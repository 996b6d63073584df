"""How much light is enough: what is chosen for a tolerance, and whether that holds.

    sh examples/run enough --seeds 101-120

Each is a random scene, baked once with `TRUTH` rays from every point, which is taken for true; each
pass of that bake, and the open sky, is a light that might have been enough. So bulk is judged in
minutes; `sh examples/run random --seed N` judges a scene by Cycles. Figures: examples/out/enough/
"""

import argparse
import csv
import math
import os
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import bpy
import lit
import numpy as np
import random_scene
import referee
import stage as stages
from example import HEIGHT, WIDTH
from main_job import silenced

from spectral_skylight.addon.choices import BAKED, OPEN
from spectral_skylight.addon.progress import run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import camera_share, passes, scene_bake, session
from spectral_skylight.addon.scene.bake.least_light import least_light
from spectral_skylight.addon.scene.bake.sounding import sounding
from spectral_skylight.addon.scene.use_cases import light as lighting
from spectral_skylight.addon.scene.world.settings import stored
from spectral_skylight.addon.spectra.cielab import XYZ_to_Lab, delta_E_2000
from spectral_skylight.addon.spectra.working_spaces import XYZ_to_working
from spectral_skylight.addon.transport import directions
from spectral_skylight.addon.transport.lamps import shine

TRUTH = 1024
TOLERANCES = 0.5, 1.0, 2.0, 5.0
TO_XYZ = np.linalg.inv(XYZ_to_working("Linear Rec.709"))


@dataclass(frozen=True)
class Row:
    """One scene and tolerance.

    ``cost`` [processor s] of making materials spectral, choosing and baking, ``least`` of the
    cheapest light that keeps to it, without a choice; ``true`` and ``predicted`` mean CIEDE2000.
    """

    seed: int
    tolerance: float
    light: str
    rays: int
    predicted: float
    bound: float
    true: float
    cost: float
    least: float

    @property
    def kept(self) -> bool:
        """Whether the picture keeps to the tolerance."""
        return self.true <= self.tolerance


def main() -> int:
    """Judge scenes and print the table; exit code 0."""
    parser = argparse.ArgumentParser(prog="examples/run enough", description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", default="101-120", metavar="FIRST-LAST")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "enough")
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    options.out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for seed in range(int(first), int(last or first) + 1):
        rows += judged(seed, options.out.resolve())
        with (options.out / "enough.csv").open("w", newline="") as file:
            table = csv.DictWriter(file, [*asdict(rows[0]), "kept"])
            table.writeheader()
            table.writerows({**asdict(row), "kept": row.kept} for row in rows)
        print("\n".join(map(said, rows[-len(TOLERANCES) :])), flush=True)
    for tolerance in TOLERANCES:
        own = [row for row in rows if row.tolerance == tolerance]
        dear = [row.cost / row.least for row in own]
        print(
            f"tolerance {tolerance:g}: kept in {sum(r.kept for r in own)} of {len(own)}, "
            f"cost over the cheapest: median {np.median(dear):.2f}, most {max(dear):.2f}"
        )
    return 0


def said(row: Row) -> str:
    """Return a row in words."""
    return (
        f"{row.seed} at {row.tolerance:g}: {row.light} {row.rays} rays, predicted "
        f"{row.predicted:.2f} to {row.bound:.2f}, true {row.true:.2f}; {row.cost:.1f} s, "
        f"the cheapest {row.least:.1f} s"
    )


def judged(seed: int, out: Path) -> list[Row]:
    """Return a row for each tolerance of one scene."""
    example = random_scene.example(seed)
    with silenced(out / "blender.log"):
        stage = example.build(lit.light(example, out, (WIDTH, HEIGHT)))
        stages.build(stage, referee.Today(), str(out / "sky.exr"))
        stages.save(out / "scene.blend", 8)
        under_open_sky = replace(example, options=("--occlusion", OPEN))
        lit.make_spectral(stage, under_open_sky, out, out / "skylight.blend")
    scene = bpy.context.scene
    settings = stored(scene.world)
    sky = run(lighting.shining_on(scene, settings)).sky
    settings = replace(settings, occlusion=BAKED)
    began = time.process_time()
    run(use_cases.updating(scene, settings))
    making = time.process_time() - began
    light = run(lighting.shining_on(scene, settings))
    began = time.process_time()
    found = run(sounding(light, sky, lighting.errors_of_models(scene)))
    choosing = time.process_time() - began
    if found is None:
        return []
    # What each light costs and is off by: none but the sky's, then those of a bake, pass by pass.
    levels = [(0, 0.0, None), *recorded(light)]
    error = errors(scene, light, sky, levels[-1][2])
    true = [
        (rays, cost, math.hypot(found.models, error(colours))) for rays, cost, colours in levels
    ]
    rows = []
    for tolerance in TOLERANCES:
        least = least_light(found, tolerance)
        enough = [
            k
            for k, (rays, _, _) in enumerate(true)
            if rays >= least.rays and (least.coarse or k > 1)
        ]
        rays, cost, off = true[enough[0] if enough else -1]
        keeping = [c for _, c, e in true if e <= tolerance] or [true[-1][1]]
        least_cost = making + min(keeping)
        rows.append(
            Row(
                seed,
                tolerance,
                least.light,
                rays,
                least.expected,
                least.bound,
                off,
                making + choosing + cost,
                least_cost,
            )
        )
    return rows


def recorded(light) -> list[tuple[int, float, np.ndarray]]:
    """Bake with all rays from all points; return after each pass its rays, the processor seconds
    until it was there, and the colors (n, 3) of points."""
    found = []
    collect, most, began = passes.collect, passes.MOST, time.process_time()

    def recording(collected, *given, **options):
        for done, colours in collect(collected, *given, **options):
            if colours is not None:
                seconds = time.process_time() - began
                found.append((len(collected.patterns[-1]), seconds, colours.copy()))
            yield done, colours

    passes.collect, passes.MOST = recording, (TRUTH, TRUTH)
    try:
        run(scene_bake.bake(light=light, error=1e-9))
    finally:
        passes.collect, passes.MOST = collect, most
    return found


def errors(scene, light, sky, true):
    """Return what tells the mean CIEDE2000 of colors (n, 3) of the last bake's points, None for the
    open sky's, as far as the camera sees them; ``true`` (n, 3): those without error."""
    kept = session._last[0]
    receivers, space = kept.collected.receivers, kept.radiosity.space
    matrices = np.array([light.matrix(name) for name in kept.materials])[receivers.kind]
    rng = np.random.default_rng(0)
    direct = np.zeros((len(receivers), matrices.shape[2]), np.float32)
    for lamp in light.lamps:
        lamp = lamp.seen_from(kept.origin)
        direct += shine(space, lamp, receivers.places, receivers.normals, rng)
    lamps = np.einsum("ncb,nb->nc", matrices, direct)
    open_light = directions.open_light(sky, receivers.normals)
    opened = np.einsum("ncb,nb->nc", matrices, open_light)
    right = (true + lamps) @ TO_XYZ.T
    # White in that light: the paint reflects in X, Y and Z what it does under the open sky.
    white = right * (open_light @ light.to_XYZ.T) / np.maximum(opened @ TO_XYZ.T, 1e-9)
    weight = seen(kept, camera_share.Eye.of(scene, kept.origin), space)
    counts = (right.min(axis=1) > 0.0) & (weight > 0.0)

    def error(colours) -> float:
        other = ((opened if colours is None else colours) + lamps) @ TO_XYZ.T
        pair = (XYZ_to_Lab(np.maximum(xyz, 1e-9)[counts], white[counts]) for xyz in (other, right))
        return float(np.average(delta_E_2000(*pair), weights=weight[counts]))

    return error


def seen(kept, eye, space) -> np.ndarray:
    """Return the solid angle of what each point stands for as the eye sees it, (n,)."""
    receivers = kept.collected.receivers
    area = np.zeros(len(receivers))
    for target in receivers.targets:
        fine, world = target.fine, np.array(bpy.data.objects[target.name].matrix_world)
        at = (fine.places @ world[:3, :3].T)[fine.point]
        twice = np.add.reduceat(np.cross(at, at[fine.following]), fine.starts[:-1])
        share = 0.5 * np.linalg.norm(twice, axis=1) * fine.managed / np.diff(fine.starts)
        points, numbers = target.numbers[1.0]
        area[numbers] = np.bincount(fine.point, share[fine.face], len(fine.places))[points]
    to = eye.place - receivers.places
    far = np.linalg.norm(to, axis=1)
    facing = np.einsum("nk,nk->n", to, receivers.normals) / far
    at = np.concatenate([receivers.places, np.ones((len(far), 1))], axis=1) @ eye.onto.T
    inside = (at[:, 3] > 0.0) & (np.abs(at[:, :2]) <= at[:, 3:]).all(axis=1) & (facing > 0.0)
    inside &= ~receivers.hidden
    found = np.flatnonzero(inside)
    ends = np.broadcast_to(eye.place, (len(found), 3))
    found = found[run(space.open_between(receivers.places[found], ends))]
    result = np.zeros(len(far))
    result[found] = area[found] * facing[found] / far[found] ** 2
    return result


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # bpy before 5.0 can crash while the interpreter takes itself apart
