"""How much light is enough: what is chosen for a tolerance, and whether that holds.

    sh examples/run enough --seeds 101-120

Each is a random scene, lit by the command `apply` with some tolerances. What is true are `TRUTH`
rays from `POINTS` places of the picture, between a whole bake's patches; what the matrices leave is
taken as it is predicted. What else there was to choose is made too, so that the cheapest is known
that would have kept the tolerance. `sh examples/run random --seed N` judges a scene by Cycles.
Figures: examples/out/enough/; what was judged stays there, and one may stop and go on.
"""

import argparse
import csv
import math
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, replace
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
from spectral_skylight.addon.progress import Progress, run
from spectral_skylight.addon.scene import use_cases
from spectral_skylight.addon.scene.bake import camera_share, passes, scene_bake, session
from spectral_skylight.addon.scene.bake.least_light import LeastLight
from spectral_skylight.addon.scene.use_cases import light as lighting
from spectral_skylight.addon.scene.world.settings import stored
from spectral_skylight.addon.spectra.cielab import XYZ_to_Lab, delta_E_2000
from spectral_skylight.addon.spectra.working_spaces import XYZ_to_working
from spectral_skylight.addon.transport import directions
from spectral_skylight.addon.transport.lamps import shine

TRUTH, POINTS = 4096, 2000
RAYS = 256
"""From each point; those that a tolerance wants more of are cast when it asks for them."""

TOLERANCES = 0.5, 1.0, 2.0, 5.0
TO_XYZ = np.linalg.inv(XYZ_to_working("Linear Rec.709"))


@dataclass(frozen=True)
class Row:
    """One scene and tolerance.

    ``true``, ``predicted``, ``bound`` and ``models`` are mean CIEDE2000; ``cost`` [processor s] is
    the command's in whole, ``least`` that of the ``cheapest`` light which keeps to the tolerance,
    asked for by name.
    """

    seed: int
    tolerance: float
    light: str
    models: float
    predicted: float
    bound: float
    true: float
    cost: float
    cheapest: str
    least: float

    @property
    def kept(self) -> bool:
        """Whether the picture keeps to the tolerance."""
        return self.true <= self.tolerance

    @property
    def dear(self) -> float:
        """How many times as much it has cost as the cheapest."""
        return self.cost / self.least


@dataclass(frozen=True)
class Level:
    """What a light adds to the command's ``cost`` [processor s], and the mean CIEDE2000 that it is
    ``off`` by."""

    cost: float
    off: float


def main() -> int:
    """Judge scenes and print the table; exit code 0."""
    parser = argparse.ArgumentParser(prog="examples/run enough", description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", default="101-120", metavar="FIRST-LAST")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "enough")
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    seeds = range(int(first), int(last or first) + 1)
    options.out.mkdir(parents=True, exist_ok=True)
    table = options.out / "enough.csv"
    rows = read(table)
    for seed in seeds:
        if any(row.seed == seed for row in rows):
            continue
        found = judged(seed, options.out.resolve())
        rows += found
        write(table, rows)
        print("\n".join(map(said, found)), flush=True)
    for tolerance in TOLERANCES:
        own = [row for row in rows if row.tolerance == tolerance and row.seed in seeds]
        dear = [row.dear for row in own]
        print(
            f"tolerance {tolerance:g}: kept in {sum(r.kept for r in own)} of {len(own)}; cost over "
            f"the cheapest: at most twice in {sum(d <= 2.0 for d in dear)}, median "
            f"{np.median(dear):.2f}, most {max(dear):.2f}"
        )
    return 0


def read(table: Path) -> list[Row]:
    """Return the rows that a table holds, none without one."""
    if not table.exists():
        return []
    with table.open(newline="") as file:
        return [
            Row(**{each.name: each.type(line[each.name]) for each in fields(Row)})
            for line in csv.DictReader(file)
        ]


def write(table: Path, rows: list[Row]) -> None:
    """Write rows as a table."""
    with table.open("w", newline="") as file:
        lines = csv.DictWriter(file, [*(each.name for each in fields(Row)), "kept", "dear"])
        lines.writeheader()
        lines.writerows({**asdict(row), "kept": row.kept, "dear": row.dear} for row in rows)


def said(row: Row) -> str:
    """Return a row in words."""
    return (
        f"{row.seed} at {row.tolerance:g}: {row.light}, predicted {row.predicted:.2f} to "
        f"{row.bound:.2f}, true {row.true:.2f}{'' if row.kept else ' (NOT KEPT)'}; "
        f"{row.cost:.1f} s, {row.cheapest} {row.least:.1f} s"
    )


def judged(seed: int, out: Path) -> list[Row]:
    """Return a row for each tolerance of one scene; none where its picture tells nothing."""
    example = random_scene.example(seed)

    def apply(*options: object) -> float:
        began = time.process_time()
        with silenced(out / "blender.log"):
            to = out / "skylight.blend"
            lit.make_spectral(stage, replace(example, options=options), out, to)
        return time.process_time() - began

    with silenced(out / "blender.log"):
        stage = example.build(lit.light(example, out, (WIDTH, HEIGHT)))
        stages.build(stage, referee.Today(), str(out / "sky.exr"))
        stages.save(out / "scene.blend", 8)
    apply("--occlusion", OPEN)
    settings = stored(bpy.context.scene.world)
    sky = run(lighting.shining_on(bpy.context.scene, settings)).sky
    run(use_cases.updating(bpy.context.scene, replace(settings, occlusion=BAKED)))
    light = run(lighting.shining_on(bpy.context.scene, replace(settings, occlusion=BAKED)))
    few, whole = (baked(light, coarse) for coarse in (True, False))
    places = session._last[0].collected.receivers.places
    off = errors(light, sky)
    if off is None:
        return []
    levels = {OPEN: Level(0.0, off(None))}
    # The whole bake's first light is the other's.
    for coarse, passed in ((True, few), (False, whole[1:])):
        for rays, cost, colours in passed:
            levels[_name(coarse, rays)] = Level(cost, off(colours))
    rows = []
    for tolerance in TOLERANCES:
        plain = apply("--occlusion", OPEN, "--tolerance", tolerance)
        with replaced(scene_bake, "bake", _nothing):
            cost = apply("--tolerance", tolerance)
        least = LeastLight(**lighting.chosen_light())
        name = _name(least.coarse, least.rays) if least.light == BAKED else OPEN
        known = dict(levels)
        if name not in known:
            with recording() as passed:
                apply("--tolerance", tolerance)
            if not np.array_equal(session._last[0].collected.receivers.places, places):
                raise RuntimeError(f"scene {seed} is divided otherwise than it was")
            rays, seconds, colours = passed[-1]
            name = _name(least.coarse, rays)
            known[name] = Level(seconds - cost, off(colours))
        total = {each: math.hypot(least.models, level.off) for each, level in known.items()}
        keeping = [each for each in known if total[each] <= tolerance]
        cheapest = min(keeping or [name], key=lambda each: known[each].cost)
        rows.append(
            Row(
                seed,
                tolerance,
                name,
                least.models,
                least.expected,
                least.bound,
                total[name],
                cost + known[name].cost,
                cheapest,
                plain + known[cheapest].cost,
            )
        )
    return rows


def _nothing(*_given, **_options):
    """Bake nothing: what that would be is known."""
    yield from ()
    return []


def _name(coarse: bool, rays: int) -> str:
    return f"{rays} rays, {'few' if coarse else 'all'} patches"


@contextmanager
def replaced(module, name: str, by) -> Iterator[None]:
    """Let something of a module be another thing for as long."""
    before = getattr(module, name)
    setattr(module, name, by)
    try:
        yield
    finally:
        setattr(module, name, before)


@contextmanager
def recording() -> Iterator[list[tuple[int, float, np.ndarray]]]:
    """Note after each pass of a bake its rays, the processor seconds until it was there, and the
    colors (n, 3) of points."""
    found: list[tuple[int, float, np.ndarray]] = []
    collect, began = passes.collect, time.process_time()

    def noting(collected, *given, **options):
        for done, colours in collect(collected, *given, **options):
            if colours is not None:
                seconds = time.process_time() - began
                found.append((len(collected.patterns[-1]), seconds, colours.copy()))
            yield done, colours

    with replaced(passes, "collect", noting):
        yield found


def baked(light, coarse: bool) -> list[tuple[int, float, np.ndarray]]:
    """Bake `RAYS` from each point; return what `recording` does."""
    least = LeastLight(BAKED, RAYS, coarse, *[0.0] * 5)
    with recording() as found:
        run(scene_bake.bake(light=light, changed_only=False, least=least))
    return found


def errors(light, sky) -> Callable[[np.ndarray | None], float] | None:
    """Return what tells the mean CIEDE2000 of colors (n, 3) of the last bake's points, None for the
    open sky's, in the camera's picture; None where that shows nothing."""
    kept = session._last[0]
    receivers, space = kept.collected.receivers, kept.radiosity.space
    eye = camera_share.Eye.of(bpy.context.scene, kept.origin)
    total = np.cumsum(seen(kept, eye, space))
    if not total[-1] > 0.0:
        return None
    every = np.searchsorted(total, (np.arange(POINTS) + 0.5) / POINTS * total[-1])
    sample, counted = np.unique(every, return_counts=True)
    shading = run(session.going_round(kept, light, Progress(0.0, "")))
    for _ in kept.collected.cast(directions.pattern(TRUTH), sample.astype(np.int32), shading):
        pass
    true = kept.collected.colours(shading)[sample]
    matrices = np.array([light.matrix(name) for name in kept.materials])[receivers.kind[sample]]
    rng = np.random.default_rng(0)
    places, normals = receivers.places[sample], receivers.normals[sample]
    direct = np.zeros((len(sample), matrices.shape[2]), np.float32)
    for lamp in light.lamps:
        direct += shine(space, lamp.seen_from(kept.origin), places, normals, rng)
    lamps = np.einsum("ncb,nb->nc", matrices, direct)
    open_light = directions.open_light(sky, normals)
    opened = np.einsum("ncb,nb->nc", matrices, open_light)
    right = (true + lamps) @ TO_XYZ.T
    # White in that light: the paint reflects in X, Y and Z what it does under the open sky.
    white = right * (open_light @ light.to_XYZ.T) / np.maximum(opened @ TO_XYZ.T, 1e-9)
    counts = right.min(axis=1) > 0.0

    def error(colours) -> float:
        other = ((opened if colours is None else colours[sample]) + lamps) @ TO_XYZ.T
        pair = (XYZ_to_Lab(np.maximum(xyz, 1e-9)[counts], white[counts]) for xyz in (other, right))
        return float(np.average(delta_E_2000(*pair), weights=counted[counts]))

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
