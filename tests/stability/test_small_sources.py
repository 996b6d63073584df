"""Light that comes from little of what is seen: what breaks it.

Referees are closed forms: the light on a ball's inside, a hole's area, the form factor of squares.
"""

import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.lamps import Direct
from spectral_skylight.tests.transport.rooms import (
    DARK,
    ball,
    box,
    fronts,
    light,
    matter,
    radiosity,
    solved,
)


def test_one_bright_patch_is_the_only_light(keep):
    """On a ball's inside every place has the same light, (share of the patch) / (1 - rho): how far
    single places are off where rays find it by chance, and where they are sent to it."""
    corners, figures = ball(16)[:, ::-1], {}
    for rays in (64, 1024):
        found = radiosity(corners, matter([0.5]), cells=0, rays=rays)
        areas = fronts(found)[3]
        chosen = np.argsort(-areas)[:4]
        found.emission[chosen] = 1.0
        solved(found)
        share = areas[chosen].sum() / areas.sum()
        off = light(found) / (share / 0.5) - 1.0
        # As many as there are rays that meet it, by Poisson: half of the light comes directly.
        assert abs(np.average(off, weights=areas)) < 3.0 / np.sqrt(share * rays * len(areas))
        figures[rays] = np.abs(off).mean()
    assert figures[1024] < 0.3 * figures[64]  # the root of 16, of a pattern that is even: better
    of = matter([0.5, 0.5])
    of.emission[1] = 1.0
    kinds = np.zeros(len(corners), np.int32)
    kinds[chosen] = 1
    found = radiosity(corners, of, kinds, cells=0, rays=64)
    solved(found)
    # A patch beside the bright one is within its reach, and there rays meet it by chance.
    middle = fronts(found)[1]
    away = np.linalg.norm(middle[:, None] - middle[chosen], axis=2).min(axis=1)
    off = (light(found) / (share / 0.5) - 1.0)[away > 0.5]
    figures["sought"] = np.abs(off).mean()
    assert abs(off.mean()) < 0.02 and figures["sought"] < figures[1024] / 3.0
    keep(
        f"a bright patch of {100 * share:.1g} % of all that is seen as the only light",
        f"a place alone off by {100 * figures['sought']:.1g} % by 32 rays to it; found by chance, "
        f"by {100 * figures[64]:.0f} % with 64 rays and by {100 * figures[1024]:.0f} % with 1,024",
        "sends rays to what shines and is small for its distance; what is near, or large, is met "
        "by an eighth of those all about",
    )


def with_hole(half, z=1.0):
    """A ceiling of a room 2 m wide with a square hole in its middle, looking down."""
    parts = [(-1, -1, -half, 1), (half, -1, 1, 1), (-half, -1, half, -half), (-half, half, half, 1)]
    found = []
    for x0, y0, x1, y1 in parts:
        a, b, c, d = (x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)
        found += [(a, c, b), (a, d, c)]
    return np.array(found, float)


def test_a_sunbeam_through_a_small_hole(keep):
    """What comes in is the hole's area, and is taken up or goes out again: energy is kept, though a
    cell has twelve times the beam's side: rays from the sun, not places in it, tell its light."""
    room = box(inwards=True)
    walls = room[~np.all(room[..., 2] > 0.99, axis=1)]
    sun = Direct(None, np.array([0.0, 0.0, 1.0]), np.ones(COUNT, np.float32))
    comes = {}
    for half in (0.3, 0.03, 0.01):
        corners = np.concatenate([walls, with_hole(half)])
        found = radiosity(corners, matter([0.5]), solid=False, cells=2000)
        lit = run(found.lit_by([sun]))
        found.solve(DARK, lit)
        _, middle, _, areas = fronts(found)
        inside = middle[:, 2] < 0.999
        flux = (lit[: len(areas), 0] * areas)[inside].sum()
        rows = found.hits.rows[: len(areas)]
        out = ((rows >= found.space.sky) & (rows < found.space.lost)).mean(axis=1)
        sent = 0.5 * light(found) * areas
        kept = (sent + sent * out).sum() / flux  # half of it is taken up, half sent on
        assert kept == pytest.approx(1.0, abs=0.02 if half == 0.3 else 0.15)
        comes[half] = flux / (4.0 * half**2)
    assert comes[0.3] == pytest.approx(1.0, abs=0.01)
    # Rays 2 mm apart: a square of 2 cm holds 100 of them, of which 40 lie at its edge; 2 % by luck.
    assert comes[0.03] == pytest.approx(1.0, abs=0.03)
    assert comes[0.01] == pytest.approx(1.0, abs=0.05)
    keep(
        "the sun through a hole of 60, 6 and 2 cm in a room of 2 m, cells of 25 cm",
        f"{comes[0.3]:.2f}, {comes[0.03]:.2f} and {comes[0.01]:.2f} times the light that comes in",
        "casts more rays to the sun where a patch is lit in part, up to 1,024; thin beams are "
        "found by rays from the sun, and counted by many more about those",
    )


def test_an_emitter_in_a_niche(keep):
    """Between black walls as much leaves a niche as its opening is seen from its bottom: the form
    factor of opposite squares (J. Howell, A Catalog of Radiation Heat Transfer Configuration
    Factors, C-11). Places that no ray from the emitter meets by chance are in the room all the
    same: taken for insides of things, they once made the rest 60 times too bright."""
    half, depth = 0.1, 0.4
    walls = box(inwards=True)
    walls = walls[~np.all(walls[..., 2] > 0.99, axis=1)]
    niche = box(1.0, inwards=True) * [2 * half, 2 * half, depth] + [0, 0, 1.0 + depth / 2]
    niche = niche[~np.all(niche[..., 2] < 1.001, axis=1)]
    corners = np.concatenate([walls, with_hole(half), niche])
    found = radiosity(corners, matter([0.0]), cells=3000)
    _, middle, _, areas = fronts(found)
    top = middle[:, 2] > 1.0 + depth - 1e-4
    found.emission[top] = 1.0
    solved(found)
    taken = light(found) * areas / areas[top].sum()
    in_room = taken[middle[:, 2] < 1.0].sum()
    x = 2 * half / depth
    leaves = np.log((1 + x**2) / np.sqrt(1 + 2 * x**2)) - 2 * x * np.arctan(x)
    leaves += 2 * x * np.sqrt(1 + x**2) * np.arctan(x / np.sqrt(1 + x**2))
    leaves *= 2 / (np.pi * x**2)
    # 650,000 rays from the room, of which 500 come to the bottom of the niche: 5 % by chance, and
    # twice that is allowed; 32 places on a patch tell 7 % too little of what is next to it.
    assert in_room == pytest.approx(leaves, rel=0.1)
    assert taken.sum() == pytest.approx(1.0, abs=0.1)
    keep(
        "an emitter at the bottom of a niche twice as deep as wide, black walls",
        f"{100 * in_room:.1f} % of its power comes out, {100 * leaves:.1f} % exactly; "
        f"{100 * taken.sum():.0f} % of it is taken up in all",
        "rays from each patch start at 32 places on it; points in the picture have rays of their "
        "own",
    )
