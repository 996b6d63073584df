"""What Dask itself costs: a plan whose pictures take no time, through a real scheduler.

`--benchmark-enable -s` prints pictures a minute. The target is far more than a thousand workers
that take a minute each can do; and the client holds no more for more pictures.
"""

import os
import time
import tracemalloc

import dask
import pytest

from spectral_skylight.addon.batch import dask_farm, run
from spectral_skylight.tests.batch.dask_cluster import (
    Cluster,
    instant_blender,
    instant_plan,
)

pytest.importorskip("distributed")

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the stand-in for Blender is a script")


def test_pictures_a_minute(benchmark, tmp_path, capsys):
    blender = instant_blender(tmp_path)
    cluster = Cluster(tmp_path)
    cluster.worker(threads=4)

    def rendered(pictures):
        """Seconds, and the most that was held [bytes], for a plan of so many."""
        plan = instant_plan(tmp_path / str(pictures), pictures)
        with dask_farm.dask_pool(cluster.address, plan.parent, blender) as pool:
            tracemalloc.start()
            start = time.perf_counter()
            outcome = run.run(plan, pool, lambda *_: None, pool.together, pool.workers)
            seconds, held = time.perf_counter() - start, tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
        assert outcome.rendered == pictures
        return seconds, held

    # Dask keeps its last 1,000 messages, of some 5 kB each: here fewer, for they would hide ours.
    kept = dask.config.set({"distributed.admin.low-level-log-length": 10})
    try:
        with kept:
            few = rendered(500)[1]
            seconds, many = benchmark.pedantic(rendered, (2000,), rounds=1)
    finally:
        cluster.end()
    assert many < few + 1e6
    assert 2000 / seconds > 1000 / 60
    with capsys.disabled():
        print(
            f"\n{60 * 2000 / seconds:.0f} pictures a minute, "
            f"{many / 1e6:.1f} MB held at most, {few / 1e6:.1f} MB for a quarter of them"
        )
