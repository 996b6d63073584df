"""A meter's light against closed forms: those cases of CIE 171:2006 that are about daylight.

Light through an unglazed opening in a roof (5.9) and in a façade (5.11), and diffuse reflection
(5.6, 5.7), each within the 1 % that is asked for; and what holds in any furnace.
"""

import numpy as np
import pytest

from spectral_skylight.addon.progress import run
from spectral_skylight.addon.sky.cie_skies import cie_luminance
from spectral_skylight.addon.transfer import glass
from spectral_skylight.addon.transport import directions
from spectral_skylight.addon.transport.bands import COUNT
from spectral_skylight.addon.transport.cells import ANGLES, Cells, Surfaces
from spectral_skylight.addon.transport.hits import Space
from spectral_skylight.addon.transport.lamps import Direct
from spectral_skylight.addon.transport.meter import Field
from spectral_skylight.tests.transport.rooms import DARK, box, matter, radiosity

RAYS = 65536
UP = np.array([0.0, 0.0, 1.0])


def rectangle(low, high, axis, at):
    """Corners (4, 3) of a rectangle across an axis, from low to high (2,) along the others."""
    (u0, v0), (u1, v1) = low, high
    return np.insert([(u0, v0), (u1, v0), (u1, v1), (u0, v1)], axis, at, axis=1)


def triangles(*quads):
    return np.concatenate([[quad[[0, 1, 2]], quad[[0, 2, 3]]] for quad in quads])


def with_hole(low, high, hole_low, hole_high, axis, at):
    """The four rectangles that a wall leaves around an opening."""
    (u0, v0), (u1, v1), (a0, b0), (a1, b1) = low, high, hole_low, hole_high
    parts = [((u0, v0), (u1, b0)), ((u0, b1), (u1, v1)), ((u0, b0), (a0, b1)), ((a1, b0), (u1, b1))]
    return [rectangle(*part, axis, at) for part in parts]


def room(opening_axis, hole_low, hole_high):
    """A black room, 4 m by 4 m by 3 m, with an opening in its roof (2) or wall at y = 0 (1)."""
    floor, roof = (rectangle((0, 0), (4, 4), 2, z) for z in (0.0, 3.0))
    walls = [rectangle((0, 0), (4, 3), axis, at) for axis in (0, 1) for at in (0.0, 4.0)]
    if opening_axis == 2:
        return triangles(floor, *with_hole((0, 0), (4, 4), hole_low, hole_high, 2, 3.0), *walls)
    walls = [walls[0], walls[1], walls[3]]
    return triangles(floor, roof, *walls, *with_hole((0, 0), (4, 3), hole_low, hole_high, 1, 0.0))


def black(corners, channels):
    """The field of light in black surfaces under a sky of channels (SKY, k)."""
    count = len(corners)
    none = np.zeros(count, np.int32)
    surfaces = Surfaces(corners.astype(float), none, none.astype(bool), none)
    space = Space(Cells.of(surfaces, np.zeros(count, int)), matter([0.0]))
    tells = np.ones(space.rows, np.float32)
    tells[space.lost] = 0.0
    return Field(space, np.zeros((space.rows, COUNT), np.float32), tells, channels.astype("f"))


def sky(luminance):
    """Channels (SKY, 1) of a luminance by elevation [rad]; the ground's by a negative one."""
    ways, _ = directions.centres()
    return luminance(np.arcsin(ways[:, 2]))[:, None]


def overcast(elevation):
    """The CIE's overcast sky, 1 in the zenith."""
    return np.where(elevation > 0.0, (1.0 + 2.0 * np.sin(elevation)) / 3.0, 0.0)


def standard_overcast(elevation):
    """Standard sky 1 of ISO 15469:2004."""
    return cie_luminance(1, 30.0, elevation, np.zeros_like(elevation)) * (elevation > 0.0)


def uniform(elevation):
    return (elevation > 0.0).astype(float)


def through(opening, place, normal, luminance):
    """Irradiance / π at a place through a rectangle (4, 3): a sum over its area, finely."""
    steps = 300
    share = (np.arange(steps) + 0.5) / steps
    u, v = np.meshgrid(share, share, indexing="ij")
    along, across = opening[1] - opening[0], opening[3] - opening[0]
    way = opening[0] + u[..., None] * along + v[..., None] * across - place
    area = np.cross(along, across) / steps**2
    far = np.linalg.norm(way, axis=-1)
    cosines = np.maximum(way @ normal, 0.0) * np.abs(way @ area) / far**2
    return (luminance(np.arcsin(way[..., 2] / far)) * cosines / far**2).sum() / np.pi


def polygon(corners, place, normal):
    """Irradiance / π by a uniform polygon of radiance 1: Lambert's closed form (1760)."""
    way = corners - place
    way = way / np.linalg.norm(way, axis=1, keepdims=True)
    after = np.roll(way, -1, axis=0)
    edge = np.cross(way, after)
    angle = np.arccos(np.clip((way * after).sum(axis=1), -1.0, 1.0))
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    return abs((angle * (edge @ normal)).sum()) / (2.0 * np.pi)


def read(field, places, normals):
    found = list(field.on_faces(np.asarray(places, float), np.asarray(normals, float), RAYS))
    return (
        np.concatenate([each.bands[:, 0] for each in found]),
        np.concatenate([each.channels for each in found]),
    )


SKIES = {"uniform": uniform, "overcast": overcast, "standard sky 1": standard_overcast}


@pytest.mark.parametrize("hole", [(1.5, 2.5), (0.5, 3.5)])
def test_sky_through_an_opening_in_the_roof(hole):
    """CIE 171, 5.9: points across the floor under a roof's opening, by the skies."""
    low, high = (hole[0], hole[0]), (hole[1], hole[1])
    channels = np.concatenate([sky(each) for each in SKIES.values()], axis=1)
    places = [(x, 2.0, 0.0) for x in (0.25, 0.75, 1.25, 1.75, 2.5, 3.75)]
    _, seen = read(black(room(2, low, high), channels), places, [UP] * len(places))
    opening = rectangle(low, high, 2, 3.0)
    for k, luminance in enumerate(SKIES.values()):
        expected = [through(opening, np.array(place), UP, luminance) for place in places]
        np.testing.assert_allclose(seen[:, k], expected, rtol=0.01)
    closed = [polygon(opening, np.array(place), UP) for place in places]
    np.testing.assert_allclose(seen[:, 0], closed, rtol=0.01)


@pytest.mark.parametrize(("low", "high"), [((1.0, 1.0), (3.0, 2.0)), ((0.5, 0.5), (3.5, 2.5))])
def test_sky_and_ground_through_an_opening_in_the_facade(low, high):
    """CIE 171, 5.11: the floor sees the sky alone, walls and the ceiling the ground that reflects
    30 % too."""
    grounds = [np.pi * 1.0, np.pi * 7.0 / 9.0]  # of a uniform and an overcast sky, the zenith 1

    def lit(luminance, lux):
        return lambda e: np.where(e > 0.0, luminance(e), 0.3 * lux / np.pi)

    outside = [lit(*pair) for pair in zip((uniform, overcast), grounds, strict=True)]
    channels = np.concatenate([sky(each) for each in outside], axis=1)
    field = black(room(1, low, high), channels)
    floor = [(2.0, y, 0.0) for y in (0.5, 1.0, 2.0, 3.5)]
    wall = [(2.0, 4.0, z) for z in (0.5, 1.5, 2.5)]
    ceiling = [(2.0, y, 3.0) for y in (1.0, 3.0)]
    places = floor + wall + ceiling
    normals = [UP] * len(floor) + [(0, -1, 0)] * len(wall) + [-UP] * len(ceiling)
    _, seen = read(field, places, normals)
    opening = rectangle(low, high, 1, 0.0)
    for k, luminance in enumerate(outside):
        expected = [
            through(opening, np.array(place), np.array(normal), luminance)
            for place, normal in zip(places, normals, strict=True)
        ]
        np.testing.assert_allclose(seen[:, k], expected, rtol=0.01)


def test_diffuse_reflection_onto_a_wall():
    """CIE 171, 5.6: ground that the sun lights evenly, seen from points on a black wall."""
    lit = rectangle((0.0, -2.0), (4.0, 2.0), 2, 0.0)
    wall = rectangle((-2.0, 0.0), (2.0, 3.0), 0, -1e-3)
    of = matter([0.3, 0.0])
    made = radiosity(triangles(lit, wall), of, np.array([0, 0, 1, 1]), cells=600, rays=16)
    sun = Direct(None, np.array([0.6, 0.0, 0.8]), np.ones(COUNT, np.float32))
    table, tells, _ = made.solve(DARK, run(made.lit_by([sun])))
    field = Field(made.space, table, tells, np.zeros((directions.SKY, 1), np.float32))
    places = np.array([(0.0, y, z) for y in (0.0, 1.0) for z in (0.25, 1.0, 2.5)])
    seen, _ = read(field, places, [(1.0, 0.0, 0.0)] * len(places))
    radiance = 0.3 * 0.8
    expected = [radiance * polygon(lit, place, np.array([1.0, 0.0, 0.0])) for place in places]
    np.testing.assert_allclose(seen, expected, rtol=0.01)


def test_a_screen_hides_what_is_reflected():
    """CIE 171, 5.7: half of the same ground lies behind a screen that stands before the wall."""
    lit = rectangle((0.0, -2.0), (4.0, 2.0), 2, 0.0)
    screen = rectangle((-2.0, 0.0), (2.0, 2.0), 0, 1.0)  # across x at 1, up to 2
    of = matter([0.3, 0.0])
    made = radiosity(triangles(lit, screen), of, np.array([0, 0, 1, 1]), False, 6000, 16)
    sun = Direct(None, UP, np.ones(COUNT, np.float32))
    table, tells, _ = made.solve(DARK, run(made.lit_by([sun])))
    field = Field(made.space, table, tells, np.zeros((directions.SKY, 1), np.float32))
    # From 1.5 high all behind x = 1 is hidden: it would have to be seen over the screen's edge.
    place = np.array([0.0, 0.0, 1.5])
    seen, _ = read(field, [place], [(1.0, 0.0, 0.0)])
    before = polygon(rectangle((0.0, -2.0), (1.0, 2.0), 2, 0.0), place, np.array([1.0, 0.0, 0.0]))
    around = read_around(place)
    np.testing.assert_allclose(seen, 0.3 * (before + around), rtol=0.01)


def read_around(place):
    """What of the ground behind the screen is seen past its sides: a sum over the ground."""
    x, y = np.meshgrid(np.arange(1.005, 4.0, 0.01), np.arange(-1.995, 2.0, 0.01), indexing="ij")
    ways = np.stack([x, y, np.zeros_like(x)], axis=-1) - place
    # Where the way crosses x = 1: beside the screen's width of 2 either way, or under its foot.
    past = np.abs(place[1] + ways[..., 1] / ways[..., 0]) > 2.0
    far = np.linalg.norm(ways, axis=-1)
    return (past * ways[..., 0] * -ways[..., 2] / far**4).sum() * 1e-4 / np.pi


def test_in_a_furnace_every_meter_reads_the_same():
    """CIE 171, 5.8's formula, exact in any closed room of one reflectance that shines evenly."""
    made = radiosity(box(2.0, inwards=True), matter([0.6], emission=2.0), cells=600, rays=64)
    table, tells, _ = made.solve(DARK, np.zeros_like(made.E))
    lamp = np.zeros((directions.SKY, 1), np.float32)
    places = [(0, 0, 0), (0.9, 0.9, 0.9), (0.0, -0.99, 0.5)]
    normals = np.array([(0, 0, 1), (1, 1, 1) / np.sqrt(3.0), (0, 1, 0)])
    field = Field(made.space, table, tells, lamp)
    seen, _ = read(field, places, normals)
    np.testing.assert_allclose(seen, 2.0 / (1.0 - 0.6), rtol=2e-3)  # sweeps end at 2e-4
    spots = np.concatenate([each.bands[:, 0] for each in field.in_spots(np.array(places), normals)])
    np.testing.assert_allclose(spots, 5.0, rtol=2e-3)


def test_a_lamp_by_the_inverse_square():
    lamp = Direct(np.array([0.0, 0.0, 2.0]), -UP, np.ones(COUNT, np.float32))
    area = np.array([(0.05, 0.0, 0.0), (0.0, 0.05, 0.0)])
    flat = Direct(np.array([0.0, 0.0, 2.0]), -UP, np.ones(COUNT, np.float32), area=area)
    field = black(triangles(rectangle((5.0, 5.0), (6.0, 6.0), 2, 0.0)), DARK[:, :1])
    places = np.array([(0.0, 0.0, 0.0), (2.0, 0.0, 0.0)])
    for each, rel in ((lamp, 1e-5), (flat, 2e-3)):  # that of a square of 0.1 in the mean
        one = Field(field.space, field.table, field.tells, field.channels, [each])
        seen, _ = read(one, places, [UP, UP])
        cosine = 2.0 / np.sqrt(8.0)
        expected = np.array([1.0 / 4.0, cosine / 8.0])
        expected[1] *= 1.0 if each is lamp else cosine
        np.testing.assert_allclose(seen, expected, rtol=rel)


def test_sky_through_a_glazed_opening_in_the_roof():
    """CIE 171, 5.10: the pane's transmittance falls with the angle, by Fresnel's equations."""
    low, high = (1.0, 1.0), (3.0, 3.0)
    opening = rectangle(low, high, 2, 3.0)
    corners = np.concatenate([room(2, low, high), triangles(opening)])
    tau = np.full(1, 0.88)
    cosines = (np.arange(ANGLES) + 0.5) / ANGLES
    of = matter([0.0, 0.0])
    of.clear[1] = True
    of.transmittance[1] = glass.uncoated(tau, cosines).transmittance[:, :1]
    kinds = np.zeros(len(corners), np.int32)
    kinds[-2:] = 1
    none = np.zeros(len(corners), np.int32)
    surfaces = Surfaces(corners.astype(float), kinds, none.astype(bool), none)
    space = Space(Cells.of(surfaces, none), of)
    table = np.zeros((space.rows, COUNT), np.float32)
    table[space.sky : space.lost] = sky(overcast)
    tells = np.ones(space.rows, np.float32)
    tells[space.lost] = 0.0
    field = Field(space, table, tells, DARK[:, :1])
    places = [(x, 2.0, 0.0) for x in (0.5, 1.5, 2.0)]
    seen, _ = read(field, places, [UP] * len(places))

    def behind(elevation):
        passed = glass.uncoated(tau, np.sin(elevation)).transmittance[..., 0]
        return overcast(elevation) * passed

    expected = [through(opening, np.array(place), UP, behind) for place in places]
    np.testing.assert_allclose(seen, expected, rtol=0.01)
