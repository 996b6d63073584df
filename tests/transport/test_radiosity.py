"""Light between surfaces against closed forms, and what holds for light whatever the scene."""

import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.transfer import glass
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.cells import ANGLES
from spectral_skylight.addon.transport.hits import gather
from spectral_skylight.addon.transport.lamps import Direct
from spectral_skylight.tests.transport.rooms import (
    SKY,
    WHITE,
    ball,
    box,
    matter,
    radiosity,
    solved,
)


@pytest.mark.parametrize("slow", [False, True], ids=["embreex", "mathutils"])
@pytest.mark.parametrize("small", [0.0, 10.0], ids=["cells", "patches"])
def test_a_closed_white_room_that_shines(slow, small):
    """B = e / (1 - rho): 5 where walls shine by 1 and reflect 0.8."""
    pytest.importorskip("bpy" if slow else "embreex")  # which brings mathutils
    cells = 12 if small else 2000
    room = radiosity(box(inwards=True), matter([0.8], 1.0), cells=cells, slow=slow, small=small)
    light = solved(room)[: room.space.cells.patches]
    np.testing.assert_allclose(light, 5.0, rtol=5e-3)


def test_a_closed_room_with_a_lamp():
    """All that a lamp sends is taken up in the end: sum of (1 - rho) E pi A is its power."""
    room = radiosity(box(inwards=True), matter([0.8]))
    power = 10.0
    spectrum = np.full(COUNT, power / (4.0 * np.pi**2), np.float32)
    lamp = Direct(np.array([0.3, -0.2, 0.1]), np.array([0.0, 0.0, -1.0]), spectrum)
    solved(room, lamps=[lamp])
    areas = room.space.cells.areas[room.space.cells.first]
    taken = (0.2 * np.pi * room.E[:, 0] * areas).sum()
    assert taken == pytest.approx(power, rel=5e-3)


def test_a_ball_under_a_white_sky():
    """(1 + n_z) / 2 of a white upper half, all of a white sphere, and no light from itself."""
    found = radiosity(ball(), matter([0.8]), cells=0)
    cells = found.space.cells
    solved(found, WHITE)
    np.testing.assert_allclose(found.E, 1.0, rtol=5e-3)
    solved(found, SKY)
    expected = (1.0 + cells.normals[:, 2]) / 2.0
    # 256 rays are turned at random about each normal: 0.5 % in the mean, 3 % of the sky at worst.
    np.testing.assert_allclose(found.E[:, 0], expected, atol=0.03)
    areas = cells.areas
    assert (found.E[:, 0] * areas).sum() == pytest.approx((expected * areas).sum(), rel=5e-3)


def test_light_goes_either_way_alike():
    """A_i F_ij = A_j F_ji between a large wall and a small one across a corner."""
    floor = [[(0, 0, 0), (4, 0, 0), (4, 4, 0)], [(0, 0, 0), (4, 4, 0), (0, 4, 0)]]
    wall = [[(0, 1, 0.2), (0, 2, 0.2), (0, 2, 1.2)], [(0, 1, 0.2), (0, 2, 1.2), (0, 1, 1.2)]]
    corners = np.array(floor + wall, float)
    found = radiosity(corners, matter([0.0, 0.0]), [0, 0, 1, 1], cells=4000, rays=1024)
    cells = found.space.cells
    areas, kind = cells.areas[cells.first], cells.kind[cells.first]
    sent = []
    for shining in (0, 1):
        table = np.zeros((found.space.rows, 4), np.float32)
        table[: cells.patches] = (kind == shining)[:, None]
        arrives = gather(found.hits, table)[: cells.patches, 0]
        sent.append((arrives * areas)[kind != shining].sum())
    assert sent[0] == pytest.approx(sent[1], rel=0.02)
    assert sent[0] > 0.1


def test_nothing_is_brighter_than_what_lights_it():
    """A street of boxes under a sky of 1 with walls that reflect 0.95: below 1 everywhere."""
    boxes = [np.add(box(), [x, y, 1.0]) for x in (-2.0, 2.0) for y in (-3.0, 0.0, 3.0)]
    ground = np.array([[(-9, -9, 0), (9, -9, 0), (9, 9, 0)], [(-9, -9, 0), (9, 9, 0), (-9, 9, 0)]])
    found = radiosity(np.concatenate([*boxes, ground]), matter([0.95]), cells=3000, rays=128)
    table = solved(found, SKY)
    assert table.max() <= 1.0 + 1e-4
    assert found.E.min() >= 0.0


def test_a_pane_lets_its_share_through_once_each():
    """Two panes of 0.7 before a floor: 0.49 of the sky; a hole of half a plane: half."""
    floor = np.array([[(-0.1, -0.1, 0), (0.1, -0.1, 0), (0.1, 0.1, 0)]])
    sheet = np.array([[(-99, -99, 1), (99, -99, 1), (0, 99, 1)]], float)
    corners = np.concatenate([floor, sheet, np.add(sheet, [0, 0, 1])])
    of = matter([0.0, 0.0])
    of.clear[1], of.transmittance[1] = True, 0.7
    found = radiosity(corners, of, [0, 1, 1], solid=False, cells=0)
    solved(found, WHITE)
    assert found.E[0, 0] == pytest.approx(0.49, rel=0.01)
    leaves = matter([0.0, 0.0])
    leaves.opacity[1] = 0.5
    found = radiosity(corners[:2], leaves, [0, 1], solid=False, cells=0, rays=1024)
    solved(found, WHITE)
    assert found.E[0, 0] == pytest.approx(0.5, abs=0.05)


def test_a_pane_keeps_what_it_mirrors():
    """A white room of 0.8 cut in two by a clear pane shines as without it, by Fresnel's equations:
    what does not pass is sent back, at whatever angle."""
    pane = np.array(
        [[(-1, -1, 0.1), (1, -1, 0.1), (1, 1, 0.1)], [(-1, -1, 0.1), (1, 1, 0.1), (-1, 1, 0.1)]]
    )
    of = matter([0.8, 0.0], 1.0)
    of.emission[1] = 0.0
    of.clear[1] = True
    clear = glass.uncoated(np.ones(81), (np.arange(ANGLES) + 0.5) / ANGLES)
    of.transmittance[1] = clear.transmittance[:, :1]
    of.mirrored[1] = clear.front[:, 0]
    np.testing.assert_allclose(of.transmittance[1, :, 0] + of.mirrored[1], 1.0, rtol=1e-6)
    corners = np.concatenate([box(inwards=True), pane])
    found = radiosity(corners, of, [0] * 12 + [1] * 2, solid=[True] * 12 + [False] * 2)
    light = solved(found)[: found.space.cells.patches]
    walls = found.space.cells.kind[found.space.cells.first] == 0
    np.testing.assert_allclose(light[walls], 5.0, rtol=5e-3)


def test_light_through_a_pane_is_that_of_fresnels_equations():
    """A floor behind a pane of absorbing glass under a white half sky: the cosine's mean of what
    passes at each angle, each polarisation going to and fro by itself."""
    floor = np.array([[(-0.1, -0.1, 0), (0.1, -0.1, 0), (0.1, 0.1, 0)]])
    sheet = np.array([[(-9e3, -9e3, 1), (9e3, -9e3, 1), (0, 9e3, 1)]], float)
    tau = np.full(81, 0.5)
    of = matter([0.0, 0.0])
    of.clear[1] = True
    pane = glass.uncoated(tau, (np.arange(ANGLES) + 0.5) / ANGLES)
    of.transmittance[1] = pane.transmittance[:, :1]
    of.mirrored[1] = pane.front[:, 0]
    found = radiosity(np.concatenate([floor, sheet]), of, [0, 1], solid=False, cells=0, rays=4096)
    solved(found, SKY)
    cosine = (np.arange(4000) + 0.5) / 4000
    n = glass.INDEX
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / n**2)
    r0 = ((n - 1.0) / (n + 1.0)) ** 2
    # tau = (1 - r)² a / (1 - r² a²), solved step by step.
    a = 0.5
    for _ in range(50):
        a = 0.5 * (1.0 - r0**2 * a**2) / (1.0 - r0) ** 2
    a = a ** (1.0 / inside)
    s = ((cosine - n * inside) / (cosine + n * inside)) ** 2
    p = ((n * cosine - inside) / (n * cosine + inside)) ** 2
    through = sum((1.0 - r) ** 2 * a / (1.0 - r**2 * a**2) for r in (s, p)) / 2.0
    exact = (2.0 * cosine * through).mean()
    # What lies below is dark, and so is what the pane mirrors. Eight angles, and 4096 rays.
    assert found.E[0, 0] == pytest.approx(exact, rel=0.01)


def test_a_wall_that_is_buried_darkens_nothing():
    """The floor under a box is inside of it; the patch half under it has the light of its rest."""
    ground = np.array([[(-2, -1, 0), (2, -1, 0), (2, 1, 0)], [(-2, -1, 0), (2, 1, 0), (-2, 1, 0)]])
    corners = np.concatenate([ground.astype(float), np.add(box(), [40.0, 0, 0]), box(1.0)])
    found = radiosity(corners, matter([0.0]), cells=0, rays=256)
    solved(found, WHITE)
    # The box stands half in the ground: of what lies outside, some sees the box, which is black.
    assert 0.5 < found.E[0, 0] < 1.0


def test_what_lies_under_something_says_nothing_of_what_lies_beside_it():
    """A floor of two large cells under a sun of 1 with a board and a block on it: where nothing
    covers it the light is 1, and so is the light of the whole cell, as others see it."""
    floor = [[(-1, -1, 0), (1, -1, 0), (1, 1, 0)], [(-1, -1, 0), (1, 1, 0), (-1, 1, 0)]]
    board = [[(-1, 0.2, 0.02), (0.2, 0.2, 0.02), (-1, 1, 0.02)]]
    block = np.add(box(0.5), [0.7, -0.7, 0.2])
    corners = np.concatenate([floor, board, block])
    solid = np.array([False] * 3 + [True] * 12)
    found = radiosity(corners, matter([0.5]), solid=solid, cells=0)
    overhead = Direct(None, np.array([0.0, 0.0, 1.0]), np.ones(COUNT, np.float32))
    light = run(found.lit_by([overhead]))
    np.testing.assert_allclose(light[:2], 1.0, rtol=1e-6)
    assert not found.counts[:2].all()
    # A board as high over a cell as the cell is wide casts a shadow.
    corners[2, :, 2] = 1.0
    found = radiosity(corners, matter([0.5]), solid=solid, cells=0)
    assert 0.3 < run(found.lit_by([overhead]))[1, 0] < 0.95
