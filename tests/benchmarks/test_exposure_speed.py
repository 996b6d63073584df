"""How long it takes to see what hides the sky from a town's materials, beside Blender's ray casts.

`pytest tests/benchmarks/test_exposure_speed.py --benchmark-enable -s` prints the ratio: each of
Blender's is linear in the objects.
"""

import time

import bpy
import numpy as np
import pytest

from spectral_skylight.addon.scene.bake import placed_meshes, sky_exposure
from spectral_skylight.tests import buildings, faces

pytestmark = [pytest.mark.slow, pytest.mark.blender]


def town(count):
    """Boxes of meshes of their own on a square grid, and the material of all."""
    faces.empty_scene()
    paint = bpy.data.materials.new("Paint")
    rng = np.random.default_rng(0)
    side = int(np.ceil(np.sqrt(count)))
    for k in range(count):
        height = rng.uniform(2.0, 12.0)
        buildings.box("Box", (4 * (k % side), 4 * (k // side), height / 2), (2, 2, height), paint)
    bpy.context.view_layer.update()
    return paint


def seconds(work, times=3):
    """Processor time of the fastest run."""
    found = []
    for _ in range(times):
        start = time.process_time()
        work()
        found.append(time.process_time() - start)
    return min(found)


def test_a_town_of_two_thousand_objects(benchmark, capsys):
    paint = town(20 if benchmark.disabled else 2000)
    scene, depsgraph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    rng = np.random.default_rng(1)
    low, high = placed_meshes.gather(depsgraph).boxes
    starts = rng.uniform(low.min(axis=0), high.max(axis=0), (4096, 3)).tolist()
    ways = rng.standard_normal((4096, 3)).tolist()

    def cast():
        for start, way in zip(starts, ways, strict=True):
            scene.ray_cast(depsgraph, start, way)

    hidden = benchmark.pedantic(sky_exposure.hidden_share, (scene, [paint]), rounds=1)
    assert 0.2 < hidden < 0.9
    if not benchmark.disabled:
        ours, theirs = seconds(lambda: sky_exposure.hidden_share(scene, [paint])), seconds(cast)
        benchmark.extra_info.update(ours=ours, blender=theirs)
        with capsys.disabled():
            print(f"\n{ours:.2f} s; by Blender's ray casts {theirs / ours:.1f} times as long")
