"""What `dask_farm.DaskPool` adds to Dask, with an instant stand-in for Blender."""

import os
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
