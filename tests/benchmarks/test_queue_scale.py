"""A thousand workers, one in a hundred of them dying: what `dispatch` makes of a night.

By simulation: the policy is the add-on's, the farm is virtual. Figures, and the bounds that any
night must keep. `--benchmark-enable -s` prints the table.
"""

from itertools import islice

import numpy as np
import pytest

from spectral_skylight.addon.batch.dispatch import chunks, dispatch
from spectral_skylight.tests.benchmarks.virtual_farm import LOAD, Picture, VirtualFarm

WORKERS, CAMERAS = 1000, 40


def night(pictures=100_000, workers=WORKERS, dying=0.01, taper=True, seed=1, size=12, **farm):
    """One simulated run: the farm afterwards, the outcomes, and the time of equal shares."""
    rng = np.random.default_rng(seed)
    seconds = rng.lognormal(np.log(60), 0.5, pictures)  # a minute each, some three
    ideal = (seconds.sum() + LOAD * pictures / CAMERAS) / workers
    dead = rng.choice(workers, round(dying * workers), replace=False)
    deaths = dict(zip(dead, rng.uniform(0, ideal, dead.size), strict=True))
    farm = VirtualFarm(seconds, workers, deaths, seed=seed, **farm)
    plan = (Picture(n, f"sky {n // CAMERAS}.blend") for n in range(pictures))
    work = chunks(plan, size, pictures if taper else None, workers)
    outcomes = list(dispatch(work, farm))
    return farm, outcomes, ideal


FARMS = {
    "Dask, Blender goes on": {"notice": 1},
    "Dask, the machine is gone": {"notice": 300, "orphan": "no"},  # distributed's worker-ttl
    # A worker that is silent for a minute is noticed a minute later at worst. Each task starts a
    # Blender: 3 s, and 5 s between two tasks, in which the worker waits and asks.
    "Flamenco, Blender goes on": {"notice": 120, "start": 8, "orphan": "chunk"},
    "Flamenco, the machine is gone": {"notice": 120, "start": 8, "orphan": "no"},
}


@pytest.mark.parametrize("kind", FARMS)
def test_a_night_in_which_one_in_a_hundred_dies(benchmark, capsys, kind):
    broken = frozenset(range(7, 100_000, 20_000))
    night_of = {"broken": broken, "flaky": 1e-3, **FARMS[kind]}
    farm, outcomes, ideal = benchmark.pedantic(night, kwargs=night_of, rounds=1)

    # Each picture has one outcome; only what never renders is missing, after three tries.
    assert sorted(picture.index for picture, _ in outcomes) == list(range(100_000))
    assert {p.index for p, answer in outcomes if answer["status"] == "failed"} == broken
    assert farm.whole == set(range(100_000)) - broken
    tries = np.bincount(farm.renders, minlength=100_000)
    assert all(tries[number] == 3 for number in broken)

    # A death costs what was under way: what was in place is skipped.
    twice = int(np.sum(tries[list(farm.whole)] > 1))
    assert farm.lost < 1e-3 * farm.seconds.sum()
    # The night is over with its last pictures, not a chunk later.
    assert farm.now < 1.08 * ideal
    # And what waits is bounded by the workers, not by the plan.
    assert farm.most_away <= 2 * WORKERS

    with capsys.disabled():
        print(
            f"\n{kind}: {farm.now / ideal:.3f} of the ideal night, {farm.lost:.0f} s lost of "
            f"{farm.seconds.sum():.0f}, {twice} pictures rendered again, {len(broken)} given up"
        )


def test_chunks_that_shrink_end_together():
    """Twenty pictures a worker, in twelves: one worker ends its second chunk long after another."""
    shrinking, _, ideal = night(20_000, dying=0)
    equal, _, _ = night(20_000, dying=0, taper=False)
    assert shrinking.now < 1.2 * ideal < 1.4 * ideal < equal.now


def test_everybody_dies_but_one():
    farm, outcomes, _ = night(200, workers=8, dying=7 / 8)
    assert sorted(picture.index for picture, _ in outcomes) == list(range(200))
    assert farm.whole == set(range(200))


def test_chunks_keep_a_files_pictures_together():
    plan = [Picture(n, blend) for n, blend in enumerate("a" * 5 + "b" * 30 + "a" * 2)]
    cut = list(chunks(plan, 12))
    assert [picture for chunk in cut for picture in chunk] == plan
    assert [len(chunk) for chunk in cut] == [5, 12, 12, 6, 2]
    assert all(len({picture.blend for picture in chunk}) == 1 for chunk in cut)


def test_chunks_follow_what_is_learnt_meanwhile():
    """How long a picture takes, and how many have come to render."""
    plan = [Picture(number, "one file") for number in range(30)]
    sizes = iter((1, 1, 4, 12, 12))
    assert [len(chunk) for chunk in chunks(plan, lambda: next(sizes))] == [1, 1, 4, 12, 12]
    workers, cut = [1], []
    for chunk in chunks(plan, 12, len(plan), lambda: workers[0]):
        cut.append(len(chunk))
        workers[0] = 3
    assert cut == [12, 3, 3, 2, 2, 2, 1, 1, 1, 1, 1, 1]


def test_a_plan_without_end_is_read_as_far_as_there_is_room():
    """What the policy holds does not grow with the plan."""

    class Pool:
        away = []

        def room(self):
            return 3 - len(self.away)

        def submit(self, chunk):
            self.away.append(chunk)

        def finished(self):
            chunk = self.away.pop(0)
            return chunk, [{"status": "rendered"}] * len(chunk)

    read = []

    def endless():
        while True:
            read.append(Picture(len(read), str(len(read) // 4)))
            yield read[-1]

    done = list(islice(dispatch(chunks(endless()), Pool()), 1000))
    assert [picture for picture, _ in done] == read[:1000]
    assert len(read) < 1000 + 6 * 4
