"""Small faces that shine, against Lambert's closed form, whole rooms, and rays that find them.

A polygon of radiance 1 sends irradiance / pi to a place that sees all of it by the sum over its
edges of the angle that each fills times the normal of the plane through it (J. Lambert 1760; P.
Baum et al. 1989, DOI 10.1145/74334.74367).
"""

import numpy as np
import pytest

from spectral_skylight.addon.transport import directions
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.cells import Cells, Surfaces, levels_for
from spectral_skylight.addon.transport.hits import Space, gather
from spectral_skylight.addon.transport.meter import Field
from spectral_skylight.addon.transport.next_event import rays_beside, seek
from spectral_skylight.addon.transport.probed import Places, Sent
from spectral_skylight.tests.transport.rooms import DARK, ball, box, matter, radiosity, solved

UP = np.array([0.0, 0.0, 1.0])


def sheet(middle, one, two):
    """Two triangles about a middle with half sides (3,): they look along one x two."""
    middle, one, two = (np.asarray(each, float) for each in (middle, one, two))
    a, b, c, d = (middle + i * one + j * two for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return np.array([(a, b, c), (a, c, d)])


def space(*things, of=None, solid=True, cells=0):
    """A space of things (n, 3, 3), kind by kind; the second shines by 1 unless ``of`` says more."""
    corners = np.concatenate(things)
    kinds = np.repeat(np.arange(len(things)), [len(each) for each in things]).astype(np.int32)
    if of is None:
        of = matter([0.0] * len(things))
        of.emission[1] = 1.0
    solid = np.broadcast_to(solid, len(corners))
    surfaces = Surfaces(corners, kinds, solid, np.zeros(len(corners), np.int32))
    return Space(Cells.of(surfaces, levels_for(surfaces, 0.01, cells)), of)


def emitted(of, radiance=1.0):
    """The table of a space whose second kind shines, and whose other faces are dark."""
    table = np.zeros((of.rows, COUNT), np.float32)
    shines = radiance * (of.cells.kind[of.cells.first] == 1)[:, None]
    table[: of.bare] = np.concatenate([shines, shines])
    return table


def light(of, places, normals, rays=256, sought=True, table=None):
    """Irradiance / pi (n,) on places by as many rays as points of a bake cast."""
    starts, normals = np.asarray(places, np.float32), np.asarray(normals, np.float32)
    normals = np.broadcast_to(normals, starts.shape)
    table = emitted(of) if table is None else table
    result = np.zeros((len(starts), COUNT))
    filters = np.array(of.filters) if of.filters else None
    for part, hits in of.look(starts, normals, directions.pattern(rays), sought):
        filters = np.array(of.filters) if of.filters else None
        result[part] = gather(hits, table, filters)
    if sought:
        result += seek(of, starts, normals, rays_beside(rays)).light(of, table, len(starts))
    return result[:, 0]


def lambert(polygon, places, normal):
    """Irradiance / pi (n,) of a polygon (k, 3) of radiance 1 on places (n, 3) over whose horizon it
    is."""
    to = polygon - np.asarray(places)[:, None]
    to = to / np.linalg.norm(to, axis=2, keepdims=True)
    following = np.roll(to, -1, axis=1)
    across = np.cross(to, following)
    length = np.linalg.norm(across, axis=2)
    angle = np.arctan2(length, np.einsum("nkx,nkx->nk", to, following))
    turned = across @ np.asarray(normal) / np.maximum(length, 1e-30)
    return np.abs((angle * turned).sum(axis=1)) / (2.0 * np.pi)


def outline(faces):
    """The corners of a `sheet`."""
    return np.array([faces[0, 0], faces[0, 1], faces[0, 2], faces[1, 2]])


def along(count=24, far=3.0):
    """Places on the floor on a line aslant from under the middle."""
    x = np.linspace(0.0, far, count)
    return np.stack([x, 0.3 * x, np.full(count, 1e-5)], axis=1)


FLOOR = sheet([0, 0, 0], [4, 0, 0], [0, 4, 0])
PANEL = sheet([0, 0, 2], [0.1, 0, 0], [0, -0.1, 0])
STRIP = sheet([0, 0, 2], [1.0, 0, 0], [0, -0.005, 0])
"""An LED strip of 2 m by 1 cm under a ceiling."""


@pytest.mark.parametrize("shining", [PANEL, STRIP], ids=["panel", "strip"])
def test_a_shining_rectangle_on_a_floor_and_a_wall(shining):
    found = space(FLOOR, shining)
    exact = lambert(outline(shining), along(), UP)
    # Nothing is between: what is left is how even the places on it are.
    np.testing.assert_allclose(light(found, along(), UP), exact, rtol=5e-3)
    wall = np.stack([np.full(24, 1.5), np.linspace(-2, 2, 24), np.linspace(0.1, 1.9, 24)], axis=1)
    exact = lambert(outline(shining), wall, [-1, 0, 0])
    np.testing.assert_allclose(light(found, wall, [-1.0, 0, 0]), exact, rtol=1e-2)
    # By chance most of these find nothing, or too much.
    lucky = light(found, along(), UP, sought=False)
    assert np.abs(lucky / lambert(outline(shining), along(), UP) - 1.0).mean() > 0.3


def test_places_near_a_strip_as_of_a_cove():
    """From 2 m to 5 mm before a strip, where rays all about meet it: no step where these begin."""
    found = space(sheet([0, 0, -4], [4, 0, 0], [0, 4, 0]), STRIP)
    height = 2.0 - np.geomspace(0.005, 2.0, 60)
    under = np.stack([np.full(60, 0.11), np.full(60, 0.0013), height], axis=1)
    exact = lambert(outline(STRIP), under, UP)
    # Where they take over 4,096 rays about a place meet it 170 times, in a pattern: 2 % by chance.
    np.testing.assert_allclose(light(found, under, UP, rays=4096), exact, rtol=0.04)


def test_a_shining_ball_and_the_shadow_of_a_box():
    """(r / d)² times the cosine; behind a box none; at the edge of its shadow what rays to a grid
    on the lamp find, by slabs."""
    radius, place = 0.05, np.array([0.0, 0.0, 2.0])
    bulb = radius * ball(20) + place
    found = space(FLOOR, bulb)
    far = np.linalg.norm(along() - place, axis=1)
    exact = radius**2 * place[2] / far**3
    # 40 corners about it: 0.6 % of its disc lies outside of them. 512 rays, of which some go to its
    # rim, and count more than others: 1 %.
    np.testing.assert_allclose(light(found, along(), UP, rays=4096), exact, rtol=2e-2)
    low, high = np.array([0.5, -0.4, 0.5]), np.array([0.7, 0.4, 1.0])
    block = box() / 2.0 * (high - low) + (low + high) / 2.0
    shadowed = space(FLOOR, PANEL, block)
    count = 60
    at = np.stack([np.linspace(0.3, 2.0, count), np.zeros(count), np.full(count, 1e-5)], axis=1)
    side = (np.arange(60) + 0.5) / 60 * 0.2 - 0.1
    x, y = (each.ravel() for each in np.meshgrid(side, side))
    ends = np.stack([x, y, np.full(x.size, 2.0)], axis=1)
    to = ends - at[:, None]
    with np.errstate(divide="ignore"):
        slabs = np.sort((np.stack([low, high]) - at[:, None, None]) / to[:, :, None], axis=2)
    free = slabs[:, :, 0].max(axis=2) > slabs[:, :, 1].min(axis=2)
    exact = (free * to[..., 2] ** 2 / (to**2).sum(axis=2) ** 2).sum(axis=1) * 0.04 / 3600 / np.pi
    assert (exact == 0.0).sum() > 5 and (free.any(axis=1) & ~free.all(axis=1)).sum() > 5
    seen = light(shadowed, at, UP, rays=4096)
    assert not seen[exact == 0.0].any()
    # At the edge 512 rays to even places tell how much of the lamp is seen, by luck to 2.2 %.
    whole = lambert(outline(PANEL), at, UP)
    np.testing.assert_allclose(seen / whole, exact / whole, atol=0.025)


@pytest.mark.parametrize("two_sided", [False, True], ids=["closed", "sheet"])
def test_a_room_takes_up_what_a_small_emitter_sends(two_sided):
    """Sum of (1 - rho) E pi A = pi L A of a front, twice as much of a sheet, which Blender's
    emission lights to either side."""
    corners = np.concatenate(
        [box(inwards=True), sheet([0.2, 0.1, 0.4], [0.05, 0, 0], [0, 0.02, 0.02])]
    )
    of = matter([0.8, 0.0])
    of.emission[1] = 100.0
    solid = np.repeat([True, not two_sided], [12, 2])
    room = radiosity(corners, of, np.repeat([0, 1], [12, 2]), solid, cells=2000, rays=64)
    solved(room)
    cells = room.space.cells
    areas = np.bincount(cells.patch, cells.areas)[room.patch]
    walls = cells.kind[cells.first[room.patch]] == 0
    taken = (0.2 * np.pi * room.E[:, 0] * areas)[walls].sum()
    shines = cells.areas[cells.kind == 1].sum()
    # Rays that meet the emitter, which is black, are as few as it is small: 1 % of light is lost.
    power = 100.0 * np.pi * shines * (2.0 if two_sided else 1.0)
    assert taken == pytest.approx(power, rel=0.015)
    # Twice as strong a lamp casts no ray, and is twice as bright.
    before, room.space.caster = room.E.copy(), None
    of.emission[1] *= 2.0
    room.take(of)
    solved(room)
    np.testing.assert_allclose(room.E, 2.0 * before, rtol=1e-4)


def test_light_through_panes_and_off_them():
    """A pane of 0.7 leaves 0.7, and what it mirrors is found by rays that it mirrors."""
    pane = sheet([0, 0, 1], [4, 0, 0], [0, 4, 0])
    of = matter([0.0, 0.0, 0.0])
    of.emission[1] = 1.0
    of.clear[2], of.transmittance[2] = True, 0.7
    found = space(FLOOR, PANEL, pane, of=of)
    exact = 0.7 * lambert(outline(PANEL), along(), UP)
    np.testing.assert_allclose(light(found, along(), UP), exact, rtol=5e-3)
    # Half of a room: all light that the pane mirrors comes back to the ceiling.
    of.transmittance[2], of.mirrored[2] = 0.5, 0.5
    over = sheet([0, 0, 2], [0.3, 0, 0], [0, -0.3, 0])
    found = space(FLOOR, over, pane, of=of)
    ceiling = np.stack([np.linspace(0.5, 2.0, 8), np.zeros(8), np.full(8, 2.0)], axis=1)
    image = outline(over) * [1, 1, 0]
    exact = 0.5 * lambert(image, ceiling, -UP)
    mirrored = light(found, ceiling, -UP, rays=2**16)
    # Of 65,000 rays 200 to 800 meet its image, half of them by chance: 5 %.
    np.testing.assert_allclose(mirrored, exact, rtol=0.1)


def test_what_fills_much_is_left_to_chance():
    """A luminous ceiling is found well by rays all about; no others are cast."""
    ceiling = sheet([0, 0, 2.5], [2, 0, 0], [0, -2, 0])
    found = space(sheet([0, 0, 0], [2, 0, 0], [0, 2, 0]), ceiling, cells=1000)
    assert not len(found.emitters) and found.sky == found.bare == 2 * found.cells.patches
    exact = lambert(outline(ceiling), along(8, 1.0), UP)
    np.testing.assert_allclose(light(found, along(8, 1.0), UP, rays=1024), exact, rtol=0.02)
    dark = space(FLOOR, PANEL, of=matter([0.5, 0.5]))
    assert not len(dark.emitters)


def test_ten_thousand_emitters_cost_as_many_rays_as_one(monkeypatch):
    """Of many some are chosen for each place, those that send it most first."""
    rng = np.random.default_rng(5)
    middles = rng.uniform((-20, -20, 2), (20, 20, 3), (10_000, 3))
    count = 500
    many = np.concatenate([sheet(each, [0.02, 0, 0], [0, -0.02, 0])[:1] for each in middles])
    found = space(sheet([0, 0, 0], [20, 0, 0], [0, 20, 0]), many)
    assert len(found.emitters) == 10_000
    places = np.append(rng.uniform(-18, 18, (count, 2)), np.full((count, 1), 1e-4), axis=1)
    cast, trace = [], Space.trace

    def counted(self, origins, *args, **more):
        cast.append(len(origins))
        return trace(self, origins, *args, **more)

    monkeypatch.setattr(Space, "trace", counted)
    starts, normals = places.astype(np.float32), np.tile(UP, (count, 1)).astype(np.float32)
    come = seek(found, starts, normals, 64)
    assert sum(cast) <= 64 * count
    to = many.mean(axis=1) - places[:, None]
    exact = (to[..., 2] ** 2 / (to**2).sum(axis=2) ** 2).sum(axis=1) * 0.0008 / np.pi
    off = come.light(found, emitted(found), count)[:, 0] / exact - 1.0
    # 64 rays of 256 lamps of 10,000. In the mean it is right.
    assert np.abs(off).mean() < 0.1
    assert abs(off.mean()) < 0.01
    again = seek(found, starts, normals, 64)
    np.testing.assert_array_equal(come.part, again.part)


def test_a_meter_and_places_of_a_picture_have_the_same_light():
    found = space(FLOOR, PANEL)
    table, tells = emitted(found), np.ones(found.rows, np.float32)
    tells[found.lost] = 0.0
    places = along()
    exact = lambert(outline(PANEL), places, UP)
    field = Field(found, table, tells, DARK[:, :1])
    up = np.tile(UP, (len(places), 1))
    (metered,) = field.on_faces(places, up, 2048)
    np.testing.assert_allclose(metered.bands[:, 0], exact, rtol=5e-3)
    # Who looks at it along the axis of a luminance meter sees it.
    (spot,) = field.in_spots(np.array([[0.0, 0.0, 0.1]]), UP[None])
    assert spot.bands[0, 0] == pytest.approx(1.0)
    seen = Places(places.astype(np.float32), up.astype(np.float32), np.zeros(len(places), int))
    sent = Sent(found, table, tells)
    work = sent.light(seen, 256, np.zeros((len(places), COUNT)))
    try:
        while True:
            next(work)
    except StopIteration as end:
        for light_there in end.value[:2]:  # all of it, and what has not bounced
            np.testing.assert_allclose(light_there[:, 0], exact, rtol=5e-3)
