"""What `dask_farm.DaskPool` adds to Dask, with an instant stand-in for Blender."""

import os
import subprocess
import sys
import threading
import time

import pytest

from spectral_skylight.addon.batch import dask_farm
from spectral_skylight.addon.batch.plan import read_tasks
from spectral_skylight.tests.batch.dask_cluster import (
    Cluster,
    instant_blender,
    instant_plan,
)

pytest.importorskip("distributed")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="the stand-in for Blender is a script"),
]


def test_answers_that_go_with_the_only_worker_come_from_the_next(tmp_path):
    """Dask computes them again, but not where all that could have are gone."""
    plan, cluster = instant_plan(tmp_path / "plan", 3), Cluster(tmp_path)
    try:
        only = cluster.worker()
        asked = (cluster.address, plan.parent, instant_blender(tmp_path))
        with dask_farm.dask_pool(*asked) as pool:
            pool.submit(list(read_tasks(plan)))
            (future,) = pool._away
            while future.status != "finished":
                time.sleep(0.05)
            only.kill()
            only.wait()
            threading.Timer(1, cluster.worker).start()
            chunk, answers = pool.finished()
        assert [task.index for task in chunk] == [0, 1, 2]
        assert [answer["status"] for answer in answers] == ["rendered"] * 3
    finally:
        cluster.end()


def test_how_many_pictures_a_worker_is_given(tmp_path):
    """One until it is known how long they take, then ten minutes' work, never more than twelve."""
    pool = dask_farm.DaskPool(None, "name")
    assert pool.together() == 1
    for seconds, together in ((0.0, 12), (1.0, 12), (100.0, 6), (599.0, 1), (7200.0, 1)):
        pool._rendered, pool._seconds = 3, 3 * seconds
        assert pool.together() == together


def test_what_workers_run_needs_nothing_of_ours(tmp_path, elsewhere):
    """It is unpickled where the package is not, and knows a task's line."""
    import cloudpickle

    dask_farm.travel_by_value()
    plugin = dask_farm.Blenders(str(tmp_path), None, None)
    (tmp_path / "sent").write_bytes(cloudpickle.dumps((plugin, dask_farm.task_of)))
    line = instant_plan(tmp_path / "plan", 1).read_text(encoding="utf-8").splitlines()[1]
    read = (
        "import pickle, sys; plugin, task_of = pickle.load(open(sys.argv[1], 'rb'))\n"
        "print(plugin.name, task_of(sys.argv[2]).camera)"
    )
    command = [sys.executable, "-c", read, str(tmp_path / "sent"), line]
    done = subprocess.run(command, env=elsewhere, capture_output=True, text=True)
    assert done.stdout == f"spectral-skylight {tmp_path} camera 0\n", done.stderr
