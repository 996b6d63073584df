"""What Dask itself costs: a plan whose pictures take no time, through a real scheduler.

`--benchmark-enable -s` prints pictures a minute. The target is far more than a thousand workers
that take a minute each can do; and the client holds no more for more pictures.
"""

import json
import os
import sys
import time
import tracemalloc

import pytest

pytest.importorskip("distributed")
import dask

from spectral_skylight.addon.batch import dask_farm, run
from spectral_skylight.addon.batch.plan import FORMAT, VERSION
from spectral_skylight.addon.batch.task import Task
from spectral_skylight.tests.batch.dask_cluster import Cluster

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the stand-in for Blender is a script")

INSTANT = f"""#!{sys.executable} -S
import json, sys
for line in sys.stdin:
    answer = {{"index": json.loads(line)["index"], "status": "rendered", "seconds": 0.0}}
    print("skylight-task " + json.dumps(answer), flush=True)
"""


def write_plan(folder, pictures):
    folder.mkdir()
    plan = folder / "plan.jsonl"
    with plan.open("w", encoding="utf-8") as file:
        header = {"format": FORMAT, "version": VERSION, "tasks": pictures, "study": "study.toml"}
        file.write(json.dumps(header) + "\n")
        for index in range(pictures):
            sky, camera = divmod(index, 40)
            names = (f"prepared/{sky}.blend", "Scene", f"camera {camera}")
            where = f"pictures/{sky}/{camera}.exr"
            task = Task(index, *names, 1, "cycles", 1, (32, 32), where, f"{index:024x}")
            file.write(task.line() + "\n")
    return plan


def test_pictures_a_minute(benchmark, tmp_path, capsys):
    blender = tmp_path / "blender"
    blender.write_text(INSTANT)
    blender.chmod(0o755)
    cluster = Cluster(tmp_path)
    cluster.worker(threads=4)

    def rendered(pictures):
        """Seconds, and the most that was held [bytes], for a plan of so many."""
        plan = write_plan(tmp_path / str(pictures), pictures)
        with dask_farm.dask_pool(cluster.address, plan.parent, str(blender)) as pool:
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
            seconds, many = benchmark.pedantic(rendered, (3000,), rounds=1)
    finally:
        cluster.end()
    assert many < few + 1e6
    assert 3000 / seconds > 1000 / 60
    with capsys.disabled():
        print(
            f"\n{60 * 3000 / seconds:.0f} pictures a minute, "
            f"{many / 1e6:.1f} MB held at most, {few / 1e6:.1f} MB for a sixth of them"
        )
